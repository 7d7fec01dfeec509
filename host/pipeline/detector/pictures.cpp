// SPDX-License-Identifier: Apache-2.0
// Pictures and cubes on the host: radiance over irradiance of every pixel and band, from the sums of the inner detector
// `pixels`, and what light that meets a mirror first adds to them, from those of `caustics`. The two replicates are
// halves: their difference is the error.
#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

enum { kRadiance, kCovered, kUnseen = kCovered };  // blocks of `pixels` and of `caustics`

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
  const double samples = static_cast<double>(x.read.points(v)) * x.plan.request.replicates;
  const std::uint64_t pixels = static_cast<std::uint64_t>(size.width) * size.height;
  const std::uint64_t bands = bands_of(x.scene, table_row("detector", x.spec().kind)).size();
  image.radiance_per_sr.reserve(pixels * bands);  // rows that grow are there twice
  image.standard_error_per_sr.reserve(pixels * bands);
  for (std::uint64_t p = 0; p < pixels; ++p)
    image.coverage.push_back(static_cast<float>(static_cast<double>(x.read.count(block, v, 0, 0, 0, p)) / samples));
  return image;
}

void add_band(const RoomResults& x, std::size_t v, std::size_t l, ImageResult* image) {
  const std::uint32_t block = find_detector(x.plan, "pixels")->first_block + kRadiance;
  const double points = static_cast<double>(x.read.points(v));
  image->bands.push_back(x.plan.request.lanes[l].band);
  image->band_source_W_m2.push_back(source_band_W_m2(x.scene.source, x.plan.request.lanes[l].band) *
                                    x.plan.request.orientations[v].light);
  for (std::uint64_t p = 0; p < image->coverage.size(); ++p) {
    const double a = x.read.weight(block, v, l, 0, p) / points, b = x.read.weight(block, v, l, 1, p) / points;
    image->radiance_per_sr.push_back(0.5 * (a + b));
    image->standard_error_per_sr.push_back(0.5 * std::fabs(a - b));
  }
  x.forget(block, v, l);
}

bool any_light(const ImageResult& image) {
  return std::any_of(image.radiance_per_sr.begin(), image.radiance_per_sr.end(), [](double r) { return r != 0.0; });
}

/// The picture of a view and lane so far; it holds all bands.
std::vector<ImageResult>::iterator picture_of(const RoomResults& x, const ResultKey& key) {
  return std::find_if(x.out.image.begin(), x.out.image.end(),
                      [&](const ImageResult& known) { return same_record(known.key, key); });
}

void picture_results(const RoomResults& x) {
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) {
    for (std::size_t l = 0; l < x.plan.layout.shape.lanes; ++l) {
      ResultKey k = x.key(v, l, 0);
      k.band.clear();
      auto found = picture_of(x, k);
      if (found == x.out.image.end()) found = x.out.image.insert(found, new_image(x, k, v));
      add_band(x, v, l, &*found);
      x.note(k, any_light(*found));
    }
  }
}

/// Of each view: the axes, where the picture's left and top edges are on them, pixels per m.
std::vector<double> caustics_settings(const RoomContext& x) {
  const PictureFrame& frame = x.plan.beams.frame;
  const PictureSize& size = x.plan.request.picture;
  std::vector<double> settings;
  for (std::size_t v = 0; v < frame.right.size(); ++v) {
    for (const Vec3& axis : {frame.right[v], frame.up[v]}) settings.insert(settings.end(), {axis.x, axis.y, axis.z});
    settings.push_back(frame.middle_right_m[v] - 0.5 * size.width * frame.pixel_m);
    settings.push_back(frame.middle_up_m[v] + 0.5 * size.height * frame.pixel_m);
    settings.push_back(1.0 / frame.pixel_m);
  }
  return settings;
}

/// Adds what a pass of mirrors found to a band of a picture: A of the light in a pixel over the pixel's area.
void add_caustics(const RoomResults& x, std::size_t v, std::size_t l, ImageResult* image) {
  const std::string& name = x.plan.request.lanes[l].band.name;
  const auto band =
      std::find_if(image->bands.begin(), image->bands.end(), [&](const Band& b) { return b.name == name; });
  if (band == image->bands.end()) return;
  const std::uint64_t pixels = image->coverage.size();
  const std::uint64_t first = static_cast<std::uint64_t>(band - image->bands.begin()) * pixels;
  const std::uint32_t block = x.detector.first_block;
  const double area = image->pixel_m * image->pixel_m;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const double a = x.read.value(block + kRadiance, v, l, 0, 0, p) / area;
    const double b = x.read.value(block + kRadiance, v, l, 0, 1, p) / area;
    double& error = image->standard_error_per_sr[first + p];
    image->radiance_per_sr[first + p] += 0.5 * (a + b);
    error = std::hypot(error, 0.5 * (a - b));
  }
  double* const unseen[] = {&image->unseen_mirrors_m2, &image->unseen_caustics_m2};
  for (std::uint64_t k = 0; k < 2; ++k) {
    const double power =
        0.5 * (x.read.value(block + kUnseen, v, l, 0, 0, k) + x.read.value(block + kUnseen, v, l, 0, 1, k));
    *unseen[k] = std::max(*unseen[k], power);
  }
}

void caustics_results(const RoomResults& x) {
  const DetectorSpec& spec = x.scene.detectors[static_cast<std::size_t>(x.plan.request.detectors.front())];
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) {
    for (std::size_t l = 0; l < x.plan.layout.shape.lanes; ++l) {
      ResultKey k = x.key(v, l, 0);
      k.detector = shown_name(spec);
      k.band.clear();
      const auto found = picture_of(x, k);
      if (found == x.out.image.end()) continue;
      add_caustics(x, v, l, &*found);
      x.lit.note(table_row("detector", spec.kind), k, any_light(*found));
    }
  }
}

/// The root mean square of the standard errors of pixels, over their mean radiance, of the pixels for which
/// `counts(pixel, sum)` holds.
template <class Counts>
double rms_error(const TargetContext& x, Counts&& counts) {
  const PictureSize& size = x.plan.request.picture;
  const std::uint64_t pixels = static_cast<std::uint64_t>(size.width) * size.height;
  double squares = 0.0, mean = 0.0, count = 0.0;
  for (std::size_t l = 0; l < x.plan.request.lanes.size(); ++l) {
    for (std::uint64_t p = 0; p < pixels; ++p) {
      const double a = x.read.weight(x.detector.first_block + kRadiance, x.view, l, 0, p);
      const double b = x.read.weight(x.detector.first_block + kRadiance, x.view, l, 1, p);
      if (!counts(p, a + b)) continue;
      mean += 0.5 * (a + b);
      squares += 0.25 * (a - b) * (a - b);
      count += 1.0;
    }
  }
  return mean > 0.0 ? std::sqrt(squares / count) / (mean / count) : std::numeric_limits<double>::quiet_NaN();
}

/// Over all covered pixels.
double pixels_error(const TargetContext& x) {
  const std::uint32_t covered = x.detector.first_block + kCovered;
  return rms_error(x, [&](std::uint64_t p, double) { return x.read.count(covered, x.view, 0, 0, 0, p) != 0; });
}

/// Over those that light reaches.
double caustics_error(const TargetContext& x) {
  return rms_error(x, [](std::uint64_t, double sum) { return sum != 0.0; });
}

// A picture has no totals.
void no_targets(const TargetContext&, std::vector<Target>*) {}

}  // namespace

const DetectorRoom kRgbRoom{"rgb", nullptr, nullptr, nullptr, picture_results};
const DetectorRoom kPixelsRoom{"pixels", nullptr, nullptr, no_targets, nullptr, pixels_error};
const DetectorRoom kCausticsRoom{"caustics", caustics_settings, nullptr, no_targets, caustics_results, caustics_error};
const DetectorRoom kHyperspectralRoom{"hyperspectral", nullptr, nullptr, nullptr, picture_results};

}  // namespace clray
