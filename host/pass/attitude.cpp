// SPDX-License-Identifier: Apache-2.0
// Attitude laws; see attitude.hpp. Spin and offset are right-handed; whole turns leave before any trigonometry.
#include "pass/attitude.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "ephemeris/aem.hpp"

namespace clray::pass {

namespace {

using ephemeris::Motion3;
using Law = PassAttitude::Law;

/// Axes of which z is along `z` and x as near to `near` as that allows; `other` stands in where the two are parallel.
Matrix axes_of(const Vec3& z_along, const Vec3& near, const Vec3& other) {
  const Vec3 z = glm::normalize(z_along);
  Vec3 y = glm::cross(z, near);
  if (glm::length(y) < 1e-9 * glm::length(near)) y = glm::cross(z, other);
  y = glm::normalize(y);
  return {glm::cross(y, z), y, z};
}

}  // namespace

Matrix orbit_axes(const Motion3& motion) {
  return axes_of(-motion.value, motion.rate, Vec3(0, 0, 1));
}

AttitudeModel::AttitudeModel(const Pass& pass) : pass_(pass) {
  if (pass.attitude.file.empty()) return;
  file_ = ephemeris::read_aem(pass.attitude.file);
  file_offset_s_ = file_->since(pass.start);
}

bool AttitudeModel::covers(double time_s) const {
  if (file_) return file_->covers(file_offset_s_ + time_s);
  const std::vector<Attitude>& rows = pass_.attitude.attitudes;
  return rows.empty() || (time_s >= rows.front().time_s && time_s <= rows.back().time_s);
}

double AttitudeModel::short_time_s() const {
  const PassAttitude& a = pass_.attitude;
  if (file_) {
    double shortest = 0.0;
    for (const ephemeris::AttitudeSegment& s : file_->segments) {
      for (std::size_t i = 1; i < s.time_s.size(); ++i) {
        double step = s.time_s[i] - s.time_s[i - 1];
        if (!s.spin.empty()) step *= std::min(1.0, 0.7 / std::max(1e-9, std::fabs(s.spin[i].z - s.spin[i - 1].z)));
        if (shortest == 0.0 || step < shortest) shortest = step;
      }
    }
    return shortest;
  }
  if (a.attitudes.size() > 1) {
    double shortest = a.attitudes[1].time_s - a.attitudes[0].time_s;
    for (std::size_t i = 2; i < a.attitudes.size(); ++i)
      shortest = std::min(shortest, a.attitudes[i].time_s - a.attitudes[i - 1].time_s);
    return shortest;
  }
  return a.attitudes.empty() && a.law == Law::spin ? a.spin_period_s / 8.0 : 0.0;
}

Quaternion AttitudeModel::table(double time_s) const {
  const std::vector<Attitude>& rows = pass_.attitude.attitudes;
  const auto next =
      std::upper_bound(rows.begin(), rows.end(), time_s, [](double t, const Attitude& a) { return t < a.time_s; });
  if (next == rows.begin() || (next == rows.end() && time_s > rows.back().time_s))
    throw Error(ErrorCode::input, "a time outside the table of attitudes", "pass.attitude.attitudes");
  const Attitude& low = *(next - 1);
  const Attitude& high = next == rows.end() ? low : *next;
  const double share = high.time_s > low.time_s ? (time_s - low.time_s) / (high.time_s - low.time_s) : 0.0;
  return glm::normalize(glm::slerp(low.body_to_space, high.body_to_space, share));
}

Quaternion AttitudeModel::law(double time_s, const Motion3& motion, const Vec3& sun) const {
  const PassAttitude& a = pass_.attitude;
  switch (a.law) {
    case Law::nadir:
      return glm::quat_cast(orbit_axes(motion));
    case Law::nadir_yaw_steering:
      return glm::quat_cast(axes_of(-motion.value, sun, motion.rate));
    case Law::sun_pointing:
      return glm::quat_cast(axes_of(sun, Vec3(0, 0, 1), Vec3(1, 0, 0)));
    case Law::spin: {
      constexpr double kTurn = 2.0 * constants::kPi;
      const double turns = std::fmod(time_s, a.spin_period_s) / a.spin_period_s;
      const Quaternion spin = ephemeris::turn_about(a.spin_axis, std::fmod(a.spin_phase_rad, kTurn) + kTurn * turns);
      return a.spin_in_orbit_frame ? glm::quat_cast(orbit_axes(motion)) * spin : spin;
    }
    case Law::inertial:
      break;
  }
  return {1.0, 0.0, 0.0, 0.0};
}

Quaternion AttitudeModel::at(double time_s, const Motion3& motion, const Vec3& sun, const EarthFrames& frames) const {
  const PassAttitude& a = pass_.attitude;
  Quaternion q;
  if (file_) {
    const Matrix frame =
        file_->orbital ? orbit_axes(motion) : frames.gcrf_of(file_->frame, ephemeris::later(pass_.start, time_s));
    q = glm::quat_cast(frame) * file_->at(file_offset_s_ + time_s);
  } else {
    q = a.attitudes.empty() ? law(time_s, motion, sun) : table(time_s);
  }
  return glm::normalize(q * ephemeris::turn_about(a.offset_axis, a.offset_rad));
}

}  // namespace clray::pass
