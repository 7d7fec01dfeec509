// SPDX-License-Identifier: Apache-2.0
// What the delay camera finds: the pulse, A(t), in SI units.
#pragma once

#include <cstdint>
#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// The delay camera: A(t), see docs/physics.md, section 1.
struct DelayResult {
  ResultKey key;                           ///< which member of the run it is
  Estimate intensity_m2_per_sr;            ///< A, everything including below and above the window
  Estimate mean_delay_s;                   ///< of the light, against a path by way of the reference point
  Estimate rms_width_s;                    ///< of the pulse about its mean
  double first_bin_start_s = 0.0;          ///< delay at which the window begins
  double bin_width_s = 0.0;                ///< > 0
  std::vector<double> bin_m2_per_sr;       ///< A per bin (not per second)
  std::vector<double> bin_standard_error;  ///< same unit
  std::vector<double> bin_upper_bound;     ///< for unresolved bins; same unit
  std::vector<std::uint64_t> hits;         ///< light paths that ended in the bin, all replicates together
  std::vector<std::uint8_t> resolved;      ///< 1: hit often enough that its standard error means something
  double below_m2_per_sr = 0.0;            ///< A before the window
  double above_m2_per_sr = 0.0;            ///< A behind it
  std::vector<double> photons_per_ns;      ///< expected rate per bin at the station; empty without one
};

}  // namespace clray
CLRAY_API_END
