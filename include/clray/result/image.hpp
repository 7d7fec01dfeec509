// SPDX-License-Identifier: Apache-2.0
// What the detectors rgb and hyperspectral find: radiance over irradiance of every pixel.
#pragma once

#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// A picture or cube: radiance over irradiance (1/sr) per pixel and band.
struct ImageResult {
  ResultKey key;                ///< which member of the run it is; its band is empty
  int width = 0;                ///< pixels
  int height = 0;               ///< pixels
  double pixel_m = 0.0;         ///< edge of a pixel at the body
  Vec3 right{1, 0, 0};          ///< image axis in the body frame, unit vector
  Vec3 up{0, 1, 0};             ///< the same
  Vec3 toward{0, 0, 1};         ///< the same: toward the observer
  double centre_right_m = 0.0;  ///< the picture's centre from the reference point, on that axis
  double centre_up_m = 0.0;     ///< the same
  /// Power over irradiance that leaves the body from mirrors toward no cone and is in no picture, after meeting a
  /// mirror first, by mirrors alone. The largest over the bands.
  double unseen_mirrors_m2 = 0.0;
  double unseen_caustics_m2 = 0.0;            ///< the same with other surfaces between
  std::vector<Band> bands;                    ///< of the cube, in the order of its planes
  std::vector<double> band_source_W_m2;       ///< of the source inside each band
  std::vector<float> coverage;                ///< [y][x] share of the pixel covered by the body; row 0 on top
  std::vector<double> radiance_per_sr;        ///< [band][y][x] radiance per unit irradiance
  std::vector<double> standard_error_per_sr;  ///< same shape
};

}  // namespace clray
CLRAY_API_END
