// SPDX-License-Identifier: Apache-2.0
// Interpolation of attitudes; see attitude_table.hpp.
#include "ephemeris/attitude_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "clray/constants.hpp"
#include "clray/error.hpp"

namespace clray::ephemeris {

namespace {

/// Through the nearest quaternions, brought to one sign.
Quaternion polynomial(const AttitudeSegment& s, std::size_t after, double time_s) {
  const std::size_t points = std::min(s.points, s.time_s.size()), half = points / 2;
  const std::size_t first = std::min(after > half ? after - half : 0, s.time_s.size() - points);
  Quaternion sum(0.0, 0.0, 0.0, 0.0);
  for (std::size_t i = first; i < first + points; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + points; ++j) {
      if (j != i) weight *= (time_s - s.time_s[j]) / (s.time_s[i] - s.time_s[j]);
    }
    const Quaternion& q = s.attitude[i];
    if (glm::dot(q, s.attitude[first]) < 0.0) weight = -weight;
    sum = sum + weight * q;
  }
  return glm::normalize(sum);
}

}  // namespace

const AttitudeSegment* AttitudeTable::segment_at(double time_s) const {
  for (auto s = segments.rbegin(); s != segments.rend(); ++s) {
    if (time_s >= s->start_s && time_s <= s->stop_s) return &*s;
  }
  return nullptr;
}

Quaternion AttitudeTable::at(double time_s) const {
  const AttitudeSegment* s = segment_at(time_s);
  if (s == nullptr) {
    throw Error(ErrorCode::input,
                fmt::format("the epoch {} is outside the attitudes ({})", iso_text(later(zero, time_s)), span_text()),
                path);
  }
  const auto after =
      static_cast<std::size_t>(std::upper_bound(s->time_s.begin(), s->time_s.end(), time_s) - s->time_s.begin());
  const std::size_t low = std::min(std::max<std::size_t>(after, 1) - 1, s->time_s.size() - 1);
  const std::size_t high = std::min(low + 1, s->time_s.size() - 1);
  const double share = high == low ? 0.0 : (time_s - s->time_s[low]) / (s->time_s[high] - s->time_s[low]);
  if (!s->spin.empty()) return spin_attitude(s->spin[low] + share * (s->spin[high] - s->spin[low]));
  if (s->points > 2 && s->time_s.size() > 2) return polynomial(*s, after, time_s);
  return glm::normalize(glm::slerp(s->attitude[low], s->attitude[high], share));
}

std::string AttitudeTable::span_text() const {
  return date_text(later(zero, first_s())) + " to " + date_text(later(zero, last_s()));
}

Quaternion turn_about(const Vec3& axis, double angle_rad) {
  return Quaternion(std::cos(0.5 * angle_rad), std::sin(0.5 * angle_rad) * axis);
}

Quaternion spin_attitude(const Vec3& spin) {
  return turn_about({0, 0, 1}, spin.x) * turn_about({0, 1, 0}, 0.5 * constants::kPi - spin.y) *
         turn_about({0, 0, 1}, spin.z);
}

}  // namespace clray::ephemeris
