// SPDX-License-Identifier: Apache-2.0
// How a body stands by time: attitudes from a file in one form, interpolated. Segments do not join.
#pragma once

#include <string>
#include <vector>

#include "ephemeris/epoch.hpp"
#include "ephemeris/interpolation.hpp"

namespace clray::ephemeris {

/// Attitudes in order of time, body to the table's frame.
struct AttitudeSegment {
  double start_s = 0.0, stop_s = 0.0;  ///< where it may be used, s from AttitudeTable::zero
  std::vector<double> time_s;
  std::vector<Quaternion> attitude;
  std::size_t points = 2;  ///< of the polynomial through the quaternions; 2: along the great circle (slerp)
  /// Of a spinning body instead: right ascension and declination of the axis and the angle about it, rad, as x, y, z.
  /// The angle goes on over whole turns.
  std::vector<Vec3> spin;
};

struct AttitudeTable {
  std::string path, object;
  bool orbital = false;  ///< the frame is that of the orbit (LVLH), else `frame`
  Frame frame = Frame::gcrf;
  Epoch zero;
  std::vector<AttitudeSegment> segments;

  double since(const Epoch& epoch) const { return seconds_between(zero, epoch); }
  bool covers(double time_s) const { return segment_at(time_s) != nullptr; }
  /// Body to the frame, of length 1. Throws Error(input) where no segment covers the time.
  Quaternion at(double time_s) const;
  double first_s() const { return segments.front().start_s; }
  double last_s() const { return segments.back().stop_s; }
  std::string span_text() const;

 private:
  const AttitudeSegment* segment_at(double time_s) const;
};

/// Rotation about an axis, right-handed.
Quaternion turn_about(const Vec3& axis, double angle_rad);

/// The attitude of a spinning body whose +z is its spin axis.
Quaternion spin_attitude(const Vec3& spin);

}  // namespace clray::ephemeris
