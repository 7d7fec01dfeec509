// SPDX-License-Identifier: Apache-2.0
// Where a body is when: positions by time from a prediction, an orbit file or a table, in one form. Segments do not
// join: each is interpolated by itself.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ephemeris/epoch.hpp"
#include "ephemeris/interpolation.hpp"

namespace clray::ephemeris {

struct Prediction;

/// Positions in m and times in s from Trajectory::zero.
struct Segment {
  double start_s = 0.0, stop_s = 0.0;  ///< where it may be used
  Interpolation positions;
};

struct Trajectory {
  std::string path, object;
  Frame frame = Frame::gcrf;
  Epoch zero;  ///< of UTC; times count SI seconds from it
  std::vector<Segment> segments;
  std::string method;                            ///< how it is interpolated, for a person
  std::shared_ptr<const Prediction> prediction;  ///< header of a CPF, or null

  /// Seconds from `zero`.
  double since(const Epoch& epoch) const { return seconds_between(zero, epoch); }
  /// The segment to use at a time, or null: of two that meet, the later.
  const Segment* segment_at(double time_s) const;
  /// Position and velocity, m and m/s. Throws Error(input) where no segment covers the time; one that ends less than
  /// `slack_s` before it does (light on its way back needs a little more).
  Motion3 at(double time_s, double slack_s = 0.0) const;
  double first_s() const { return segments.front().start_s; }
  double last_s() const { return segments.back().stop_s; }
  /// "2026-11-25 18:00:00 UTC to 2026-11-25 19:00:00 UTC, in 2 segments".
  std::string span_text() const;
};

}  // namespace clray::ephemeris
