// SPDX-License-Identifier: Apache-2.0
// How the body stands at an instant: by a law, a table or a CCSDS AEM (docs/physics.md, section 10). Body to gcrf.
#pragma once

#include <optional>

#include "ephemeris/attitude_table.hpp"
#include "ephemeris/interpolation.hpp"
#include "pass/frames.hpp"

namespace clray::pass {

/// Axes of the orbit (LVLH): z to the Earth's centre, y against the orbit's normal, x ahead; columns in gcrf.
Matrix orbit_axes(const ephemeris::Motion3& motion);

class AttitudeModel {
 public:
  /// Reads the AEM if there is one. Throws Error(input).
  explicit AttitudeModel(const Pass& pass);

  /// Whether table or AEM reach a time (s from the pass's start).
  bool covers(double time_s) const;
  /// `motion` of the body in gcrf, `sun` from the body to the Sun.
  Quaternion at(double time_s, const ephemeris::Motion3& motion, const Vec3& sun, const EarthFrames& frames) const;
  /// A time in which the attitude cannot have turned by more than an eighth, if one is known; else 0.
  double short_time_s() const;

 private:
  Quaternion law(double time_s, const ephemeris::Motion3& motion, const Vec3& sun) const;
  Quaternion table(double time_s) const;

  const Pass& pass_;
  std::optional<ephemeris::AttitudeTable> file_;
  double file_offset_s_ = 0.0;
};

}  // namespace clray::pass
