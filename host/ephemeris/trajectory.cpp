// SPDX-License-Identifier: Apache-2.0
// Segments of a trajectory; see trajectory.hpp.
#include "ephemeris/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clray/error.hpp"

namespace clray::ephemeris {

const Segment* Trajectory::segment_at(double time_s) const {
  auto at = std::upper_bound(segments.begin(), segments.end(), time_s,
                             [](double t, const Segment& s) { return t < s.start_s; });
  while (at != segments.begin()) {
    --at;
    if (time_s <= at->stop_s) return &*at;
  }
  return nullptr;
}

Motion3 Trajectory::at(double time_s, double slack_s) const {
  const Segment* segment = segment_at(time_s);
  if (segment == nullptr && slack_s > 0.0) segment = segment_at(time_s - slack_s);
  if (segment == nullptr) {
    throw Error(ErrorCode::input,
                fmt::format("the epoch {} is outside the ephemeris ({})", iso_text(later(zero, time_s)), span_text()),
                path);
  }
  return segment->positions.at(time_s);
}

std::string Trajectory::span_text() const {
  std::string text = date_text(later(zero, first_s())) + " to " + date_text(later(zero, last_s()));
  if (segments.size() > 1) text += fmt::format(", in {} segments", segments.size());
  return text;
}

}  // namespace clray::ephemeris
