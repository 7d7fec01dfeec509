// SPDX-License-Identifier: Apache-2.0
// Normal points of a session by the algorithm of the International Laser Ranging Service (Sinclair 1997, "Data
// screening and normal point formation"): a trend is taken from the residuals to the prediction, outliers are rejected
// until nothing changes, and each bin of the UTC day gives one range. docs/laser-ranging.md, "Normal points", has the
// steps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ephemeris/epoch.hpp"

namespace clray::slr {

using namespace ephemeris;

/// One detected shot.
struct Observation {
  std::uint64_t shot = 0;      ///< its number
  Epoch epoch;                 ///< of fire
  std::int64_t flight_ps = 0;  ///< two-way
  double residual_ns = 0.0;    ///< flight time minus that of the prediction
};

/// Of the accepted residuals to the trend. Skewness and kurtosis are NaN where they are not defined; a normal
/// distribution has kurtosis 0.
struct ResidualStatistics {
  std::uint64_t count = 0;
  double rms_ps = 0.0, skewness = 0.0, kurtosis = 0.0;
};

struct NormalPoint {
  std::uint64_t shot = 0;      ///< that of the observation nearest to the mean epoch of the bin
  Epoch epoch;                 ///< its time
  std::int64_t flight_ps = 0;  ///< two-way
  ResidualStatistics bin;
};

struct NormalPoints {
  std::vector<NormalPoint> points;
  ResidualStatistics session;
};

/// Of observations in the order of their epochs; `window_s`: length of the bins, which begin with the day.
NormalPoints normal_points(const std::vector<Observation>& observations, double window_s);

}  // namespace clray::slr
