// SPDX-License-Identifier: Apache-2.0
// From band radiances to colour; see colour.hpp. No white balance: a grey plate takes the tint of its light.
#include "io/colour.hpp"

#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "scene/spectrum.hpp"

namespace clray::io {

namespace {

double lobe(double x, double centre, double left, double right) {
  const double t = (x - centre) / (x < centre ? left : right);
  return std::exp(-0.5 * t * t);
}

/// A column of the RGB-to-XYZ matrix, but for its scale: the XYZ of a primary with Y = 1.
Vec3 xyz_of(double x, double y) {
  return {x / y, 1.0, (1.0 - x - y) / y};
}

double det(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.x * (b.y * c.z - b.z * c.y) - b.x * (a.y * c.z - a.z * c.y) + c.x * (a.y * b.z - a.z * b.y);
}

}  // namespace

Vec3 colour_matching(double w) {
  const double x =
      1.056 * lobe(w, 599.8, 37.9, 31.0) + 0.362 * lobe(w, 442.0, 16.0, 26.7) - 0.065 * lobe(w, 501.1, 20.4, 26.2);
  const double y = 0.821 * lobe(w, 568.8, 46.9, 40.5) + 0.286 * lobe(w, 530.9, 16.3, 31.1);
  const double z = 1.217 * lobe(w, 437.0, 11.8, 36.0) + 0.681 * lobe(w, 459.0, 26.0, 13.8);
  return {x, y, z};
}

Vec3 band_colour(const Band& band, const Source& source) {
  // The fit's lobes are below 1e-9 of their peaks beyond these ends, and at least 12 nm wide.
  constexpr double kLow_nm = 330.0, kHigh_nm = 880.0, kStep_nm = 5.0;
  Band visible = band;
  visible.low_nm = std::max(band.low_nm, kLow_nm);
  visible.high_nm = std::min(band.high_nm, kHigh_nm);
  const double light = source_band_W_m2(source, band);
  if (!(visible.low_nm <= visible.high_nm) || !(light > 0.0)) return Vec3{0.0};
  Vec3 mean;
  for (int c = 0; c < 3; ++c)
    mean[c] = band_mean([&](double w) { return colour_matching(w)[c]; }, kStep_nm, visible, source);
  return source_band_W_m2(source, visible) / light * mean;
}

Vec3 xyz_to_linear_srgb(const Vec3& xyz) {
  static const Vec3 red = xyz_of(0.64, 0.33), green = xyz_of(0.30, 0.60), blue = xyz_of(0.15, 0.06);
  static const Vec3 white = xyz_of(0.3127, 0.3290);
  static const double whole = det(red, green, blue);
  static const Vec3 scale{det(white, green, blue) / whole, det(red, white, blue) / whole,
                          det(red, green, white) / whole};
  return {det(xyz, green, blue) / whole / scale.x, det(red, xyz, blue) / whole / scale.y,
          det(red, green, xyz) / whole / scale.z};
}

double srgb_encode(double linear) {
  if (!(linear > 0.0)) return 0.0;
  if (linear >= 1.0) return 1.0;
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::vector<Vec3> rgb_weights(const ImageResult& image, const Source& source) {
  std::vector<Vec3> weights;
  double white = 0.0;
  for (std::size_t b = 0; b < image.bands.size(); ++b) {
    const double power = b < image.band_source_W_m2.size() ? image.band_source_W_m2[b] : 0.0;
    weights.push_back(power * band_colour(image.bands[b], source));
    white += weights.back().y / constants::kPi;
  }
  // Below a millionth of the eye's peak there is only the tail of the fit, which is not visible light.
  double power = 0.0;
  for (const double p : image.band_source_W_m2) power += p;
  const bool visible = white * constants::kPi > 1e-6 * power && white > 0.0;
  for (auto& weight : weights) weight = visible ? xyz_to_linear_srgb(weight / white) : Vec3{0.0};
  return weights;
}

}  // namespace clray::io
