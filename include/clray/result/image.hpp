// SPDX-License-Identifier: Apache-2.0
// What the detectors rgb and hyperspectral find: radiance over irradiance of every pixel.
#pragma once

#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

namespace CLRAY_API clray {

/// A picture or cube: radiance over irradiance (1/sr) per pixel and band.
struct ImageResult {
  ResultKey key;
  int width = 0, height = 0;
  double pixel_m = 0.0;                               ///< edge of a pixel at the body
  Vec3 right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};  ///< image axes in the body frame
  double centre_right_m = 0.0, centre_up_m = 0.0;     ///< the picture's centre from the reference point, on those axes
  /// Power over irradiance that leaves the body from mirrors toward no cone and is in no picture, after meeting a
  /// mirror first: by mirrors alone, and with other surfaces between. The largest over the bands.
  double unseen_mirrors_m2 = 0.0, unseen_caustics_m2 = 0.0;
  std::vector<Band> bands;
  std::vector<double> band_source_W_m2;
  std::vector<float> coverage;                ///< [y][x] share of the pixel covered by the body; row 0 on top
  std::vector<double> radiance_per_sr;        ///< [band][y][x] radiance per unit irradiance
  std::vector<double> standard_error_per_sr;  ///< same shape
};

}  // namespace clray
