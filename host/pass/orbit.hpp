// SPDX-License-Identifier: Apache-2.0
// The orbit of a pass: its file, whatever its format, brought to gcrf and to the Earth-fixed frame.
#pragma once

#include "ephemeris/range.hpp"
#include "ephemeris/trajectory.hpp"
#include "pass/frames.hpp"

namespace clray::pass {

/// Reads pass.ephemeris: CPF and OEM are known by how they begin, anything else is a table of states: CSV of time
/// (time_utc, mjd, or time_s from the pass's start), x_m, y_m, z_m and perhaps vx_m_s, vy_m_s, vz_m_s. Throws
/// Error(input).
ephemeris::Trajectory read_orbit(const Pass& pass);

/// An orbit and the Earth's attitude around a pass.
class Orbit {
 public:
  explicit Orbit(const Pass& pass);

  /// Position and velocity in gcrf at seconds from the pass's start. Throws Error(input) where the file does not reach.
  ephemeris::Motion3 at(double time_s) const;
  /// Until when the file reaches from a time that it covers.
  double covered_until(double time_s) const { return trajectory_.segment_at(in_file_s(time_s))->stop_s - offset_s_; }
  double last_s() const { return trajectory_.last_s() - offset_s_; }
  bool covers(double time_s) const { return trajectory_.segment_at(in_file_s(time_s)) != nullptr; }
  /// Earth-fixed position; known for 3 s behind the file's end, too, in which light comes back.
  Vec3 earth_fixed(double time_s) const;
  Epoch epoch(double time_s) const { return ephemeris::later(start_, time_s); }

  const ephemeris::Trajectory& trajectory() const { return trajectory_; }
  const EarthFrames& frames() const { return frames_; }

 private:
  double in_file_s(double time_s) const { return offset_s_ + time_s; }

  Epoch start_;
  ephemeris::Trajectory trajectory_;
  double offset_s_ = 0.0;  ///< the pass's start, s from the trajectory's zero
  EarthFrames frames_;
};

}  // namespace clray::pass
