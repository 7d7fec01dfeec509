// SPDX-License-Identifier: Apache-2.0
// What a run says of itself: energy books, counts of paths and failures, errors against time, seconds.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

namespace CLRAY_API clray {

/// Energy books of one variant and band where paths scatter, as power over irradiance, the mean over the orientations
/// (docs/physics.md, section 4). Of a grid of Sun directions, the mean over the grid; `key.detector` then names its
/// detector, else it is empty.
struct EnergyBooks {
  ResultKey key;
  Estimate incident_m2, reflected_m2, absorbed_m2, roulette_m2, truncated_m2, unconnected_specular_m2;
};

/// Paths of all passes, exact: started is the sum of the others.
struct PathCounts {
  std::uint64_t started = 0, escaped = 0, killed = 0, capped = 0;
};

/// One point of error against run time.
struct ErrorPoint {
  std::string phase;                     ///< "search", "confirm" or "trace"
  std::uint64_t rays = 0;                ///< per orientation
  double seconds = 0.0;                  ///< of tracing, from the phase's start
  double relative_standard_error = 0.0;  ///< the largest over all targets; NaN if all totals are zero
  double first_total =
      std::numeric_limits<double>::quiet_NaN();  ///< of the result, in its unit (of a vector its length); NaN: not kept
  double first_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< of first_total; of a vector, along it
};

/// Failures are counted, never hidden. All are zero in a sound run.
struct Diagnostics {
  std::uint64_t non_finite = 0, stack_overflow = 0, lost_rays = 0, accumulator_overflow = 0;
  double below_window_fraction = 0.0, above_window_fraction = 0.0, truncated_energy_fraction = 0.0;
};

struct Seconds {
  double load = 0.0, bvh = 0.0, compile = 0.0, trace = 0.0, total = 0.0;
};

}  // namespace clray
