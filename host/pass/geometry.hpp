// SPDX-License-Identifier: Apache-2.0
// A pass at one time: where the body is, how it stands, where light comes from, who sees it and how high, and why it is
// not traced (docs/physics.md, section 10). The time is that at which light meets the body; light times are solved for.
#pragma once

#include "clray/result.hpp"
#include "pass/attitude.hpp"
#include "pass/orbit.hpp"
#include "pass/sun.hpp"

namespace clray::pass {

class Geometry {
 public:
  /// Reads the files of the scene's pass. Throws Error(input).
  explicit Geometry(const Scene& scene);

  /// At seconds from the pass's start; `orientation` and `until_s` are left to the caller.
  PassInstant at(double time_s) const;

  const Orbit& orbit() const { return orbit_; }
  const AttitudeModel& attitude() const { return attitude_; }

 private:
  struct Moment;
  void place_source(const Moment& m, PassInstant* instant) const;
  void place_observers(const Moment& m, PassInstant* instant) const;
  SiteSight station_sight(const Moment& m) const;
  SiteSight sight_from(const Moment& m, const Vec3& site_m, Vec3* toward) const;
  void see_sun(const Moment& m, const Vec3& site_m, SiteSight* sight) const;
  Vec3 along_table(const Moment& m, const Directions& table, PassInstant* instant, double* range_m) const;
  std::string reason(const PassInstant& instant) const;

  const Scene& scene_;
  const Pass& pass_;
  Orbit orbit_;
  AttitudeModel attitude_;
};

/// A direction rounded to 1.5e-11 rad and brought to length 1, so that last digits in which libraries of mathematics
/// differ do not reach a device.
Vec3 snapped(const Vec3& direction);

}  // namespace clray::pass
