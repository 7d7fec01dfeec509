// SPDX-License-Identifier: Apache-2.0
// Pictures and cubes on the host: radiance over irradiance of every pixel and band, from the sums of the inner detector
// `pixels`. The two replicates are halves: their difference is the error.
#include <algorithm>
#include <cmath>

#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

enum { kRadiance, kCovered };  // blocks of `pixels`

ImageResult new_image(const RoomResults& x, const ResultKey& key, std::size_t v) {
  const PictureFrame& frame = x.plan.beams.frame;
  const PictureSize& size = x.plan.request.picture;
  const double* o = x.plan.beams.views[v].toward;
  ImageResult image;
  image.key = key;
  image.width = static_cast<int>(size.width);
  image.height = static_cast<int>(size.height);
  image.pixel_m = frame.pixel_m;
  image.right = frame.right[v];
  image.up = frame.up[v];
  image.toward = Vec3(o[0], o[1], o[2]);
  image.centre_right_m = frame.centre_right_m[v];
  image.centre_up_m = frame.centre_up_m[v];
  const std::uint32_t block = find_detector(x.plan, "pixels")->first_block + kCovered;
  const double samples = static_cast<double>(x.read.points()) * x.plan.request.replicates;
  const std::uint64_t pixels = static_cast<std::uint64_t>(size.width) * size.height;
  for (std::uint64_t p = 0; p < pixels; ++p)
    image.coverage.push_back(static_cast<float>(static_cast<double>(x.read.count(block, v, 0, 0, 0, p)) / samples));
  return image;
}

void add_band(const RoomResults& x, std::size_t v, std::size_t l, ImageResult* image) {
  const std::uint32_t block = find_detector(x.plan, "pixels")->first_block + kRadiance;
  const double points = static_cast<double>(x.read.points());
  image->bands.push_back(x.plan.request.lanes[l].band);
  image->band_source_W_m2.push_back(source_band_W_m2(x.scene.source, x.plan.request.lanes[l].band));
  for (std::uint64_t p = 0; p < image->coverage.size(); ++p) {
    const double a = x.read.weight(block, v, l, 0, p) / points, b = x.read.weight(block, v, l, 1, p) / points;
    image->radiance_per_sr.push_back(0.5 * (a + b));
    image->standard_error_per_sr.push_back(0.5 * std::fabs(a - b));
  }
}

void picture_results(const RoomResults& x) {
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) {
    for (std::size_t l = 0; l < x.plan.layout.shape.lanes; ++l) {
      ResultKey k = x.key(v, l, 0);
      k.band.clear();  // a picture holds all of them
      auto found = std::find_if(x.out.image.begin(), x.out.image.end(), [&](const ImageResult& known) {
        return known.key.detector == k.detector && known.key.observer == k.observer && known.key.variant == k.variant &&
               known.key.orientation == k.orientation;
      });
      if (found == x.out.image.end()) found = x.out.image.insert(found, new_image(x, k, v));
      add_band(x, v, l, &*found);
    }
  }
}

}  // namespace

const DetectorRoom kRgbRoom{"rgb", nullptr, nullptr, nullptr, picture_results};
const DetectorRoom kHyperspectralRoom{"hyperspectral", nullptr, nullptr, nullptr, picture_results};

}  // namespace clray
