// SPDX-License-Identifier: Apache-2.0
// What a run says of itself: energy books, counts of paths and failures, errors against time, seconds.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Energy books of one variant and band where paths scatter, as power over irradiance, the mean over the orientations
/// (docs/physics.md, section 4). Of a grid of Sun directions, the mean over the grid; `key.detector` then names its
/// detector, else it is empty.
struct EnergyBooks {
  ResultKey key;                     ///< its variant and band
  Estimate incident_m2;              ///< met the body
  Estimate reflected_m2;             ///< left it
  Estimate absorbed_m2;              ///< stayed
  Estimate roulette_m2;              ///< added by Russian roulette less what it took
  Estimate truncated_m2;             ///< cut off with the last bounce
  Estimate unconnected_specular_m2;  ///< left mirrors toward no observer
};

/// Paths of all passes, exact: started is the sum of the others.
struct PathCounts {
  std::uint64_t started = 0;  ///< that met the body
  std::uint64_t escaped = 0;  ///< that left it
  std::uint64_t killed = 0;   ///< ended by Russian roulette
  std::uint64_t capped = 0;   ///< cut off with the last bounce
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
  std::uint64_t non_finite = 0;            ///< weights that are no numbers
  std::uint64_t stack_overflow = 0;        ///< of the walk through the tree
  std::uint64_t lost_rays = 0;             ///< hits on surfaces that do not face the ray
  std::uint64_t accumulator_overflow = 0;  ///< of the integer sums
  double below_window_fraction = 0.0;      ///< of A, the largest over the delay records
  double above_window_fraction = 0.0;      ///< the same
  double truncated_energy_fraction = 0.0;  ///< of the incident power
};

/// Where the time of a run went.
struct Seconds {
  double load = 0.0;     ///< reading the scene; filled in by who reads it
  double bvh = 0.0;      ///< body, trees and plans
  double compile = 0.0;  ///< programs
  double trace = 0.0;    ///< tracing or solving
  double total = 0.0;    ///< of the call
};

}  // namespace clray
CLRAY_API_END
