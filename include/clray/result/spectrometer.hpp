// SPDX-License-Identifier: Apache-2.0
// What the one-pixel spectrometer finds: intensity, received power and magnitudes in one band, in SI units.
#pragma once

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// The one-pixel spectrometer: A in one band.
struct SpectrometerResult {
  ResultKey key;                              ///< which member of the run it is
  Band band;                                  ///< with its filter
  Estimate intensity_m2_per_sr;               ///< A: intensity toward the observer over irradiance at the body
  double source_W_m2 = 0.0;                   ///< of the source inside the band
  double received_W_m2 = 0.0;                 ///< at the observer's range; 0 without one
  double received_W_m2_standard_error = 0.0;  ///< same unit
  double magnitude_AB = 0.0;                  ///< NaN without a range
  double magnitude_standard_error = 0.0;      ///< of either magnitude; NaN without a range
  double magnitude_Vega = 0.0;                ///< NaN also where Vega's table has no light
  double phase_angle_rad = 0.0;               ///< between source and observer, seen from the body
  double air_mass = 0.0;                      ///< on the way to the observer's site; NaN where none is known
  double extinction_mag = 0.0;  ///< within received power and magnitudes: the observer's, times the air mass
};

}  // namespace clray
CLRAY_API_END
