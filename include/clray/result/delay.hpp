// SPDX-License-Identifier: Apache-2.0
// What the delay camera finds: the pulse, A(t), in SI units.
#pragma once

#include <cstdint>
#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

namespace CLRAY_API clray {

/// The delay camera: A(t), see docs/physics.md, section 1.
struct DelayResult {
  ResultKey key;
  Estimate intensity_m2_per_sr;  ///< A, everything including below and above the window
  Estimate mean_delay_s, rms_width_s;
  double first_bin_start_s = 0.0, bin_width_s = 0.0;
  std::vector<double> bin_m2_per_sr;       ///< A per bin (not per second)
  std::vector<double> bin_standard_error;  ///< same unit
  std::vector<double> bin_upper_bound;     ///< for unresolved bins; same unit
  std::vector<std::uint64_t> hits;
  std::vector<std::uint8_t> resolved;
  double below_m2_per_sr = 0.0, above_m2_per_sr = 0.0;
  std::vector<double> photons_per_ns;  ///< expected rate per bin at the station; empty without one
};

}  // namespace clray
