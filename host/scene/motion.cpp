// SPDX-License-Identifier: Apache-2.0
// Motion of the body: spin about a fixed axis or a table of attitudes, turned into the directions of source and
// observers in the body frame (the beam turns, not the mesh). Angles are carried in turns, so that whole turns and
// quarter turns are exact; quaternions are Hamilton's, body to space. Sine and cosine are clray's own.
// Slerp: Shoemake (1985), with the angle from atan2 of half sums, which stays accurate for near quaternions.
#include "scene/motion.hpp"

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr double kTwoPi = 2.0 * CLRAY_PI;
/// A number of steps counts as whole within this relative tolerance, as degrees to radians and back cost a few ulp.
constexpr double kWhole = 0x1p-40;

double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Reduces `turns` to [-1/2, 1/2], exactly.
double reduce(double turns) {
  const double part = std::fmod(turns, 1.0);
  return part > 0.5 ? part - 1.0 : part < -0.5 ? part + 1.0 : part;
}

/// Sine and cosine of an angle in turns, exact at quarter turns.
void sincos_turns(double turns, double* s, double* c) {
  const double quarter = std::floor(4.0 * turns + 0.5);
  double sine = 0.0, cosine = 1.0;
  el_sincos(kTwoPi * (turns - 0.25 * quarter), &sine, &cosine);
  switch (static_cast<int>(std::fmod(quarter, 4.0) + 4.0) % 4) {
    case 0:
      *s = sine;
      *c = cosine;
      break;
    case 1:
      *s = cosine;
      *c = -sine;
      break;
    case 2:
      *s = -sine;
      *c = -cosine;
      break;
    default:
      *s = -cosine;
      *c = sine;
      break;
  }
}

/// `v` turned about the unit vector `axis` (Rodrigues' formula).
Vec3 turned(const Vec3& v, const Vec3& axis, double turns) {
  if (turns == 0.0) return v;
  double s = 0.0, c = 0.0;
  sincos_turns(turns, &s, &c);
  return c * v + s * cross(axis, v) + ((1.0 - c) * dot(axis, v)) * axis;
}

Quaternion spin_quaternion(const Vec3& axis, double turns) {
  double s = 0.0, c = 0.0;
  sincos_turns(0.5 * turns, &s, &c);
  return Quaternion(c, s * axis.x, s * axis.y, s * axis.z);
}

/// `v` of the space frame in the body frame: turned by the conjugate of a body-to-space quaternion.
Vec3 to_body(const Vec3& v, const Quaternion& q) {
  const Vec3 u(-q.x, -q.y, -q.z);
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

Quaternion unit(const Quaternion& q) {
  const double l = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return Quaternion(q.w / l, q.x / l, q.y / l, q.z / l);
}

double length(const Quaternion& q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

Quaternion slerp(const Quaternion& a, Quaternion b, double t) {
  if (a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0.0) b = Quaternion(-b.w, -b.x, -b.y, -b.z);
  const Quaternion sum(a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z);
  const Quaternion difference(b.w - a.w, b.x - a.x, b.y - a.y, b.z - a.z);
  const double angle = 2.0 * el_atan2(length(difference), length(sum));
  double u = 1.0 - t, v = t;
  if (angle > 1e-8) {  // below, sin(tθ)/sin θ equals t to rounding
    double s = 0.0, s0 = 0.0, s1 = 0.0, c = 0.0;
    el_sincos(angle, &s, &c);
    el_sincos(u * angle, &s0, &c);
    el_sincos(v * angle, &s1, &c);
    u = s0 / s;
    v = s1 / s;
  }
  return unit(Quaternion(u * a.w + v * b.w, u * a.x + v * b.x, u * a.y + v * b.y, u * a.z + v * b.z));
}

double turns_at(const Motion& motion, double time_s) {
  return reduce(reduce(motion.phase_rad / kTwoPi) + std::fmod(time_s, motion.period_s) / motion.period_s);
}

Quaternion table_attitude(const std::vector<Attitude>& table, double time_s) {
  if (table.empty() || !(time_s >= table.front().time_s) || !(time_s <= table.back().time_s)) {
    throw Error(ErrorCode::input, "time " + std::to_string(time_s) + " s is outside the table of attitudes", "motion");
  }
  const auto next =
      std::upper_bound(table.begin(), table.end(), time_s, [](double t, const Attitude& a) { return t < a.time_s; });
  const Attitude& before = *(next - 1);
  if (before.time_s == time_s || next == table.end()) return unit(before.body_to_space);
  const double t = (time_s - before.time_s) / (next->time_s - before.time_s);
  return slerp(unit(before.body_to_space), unit(next->body_to_space), t);
}

/// Fills in the observers of an orientation, `body` taking a space vector into the body frame.
template <typename ToBody>
void place(const Scene& scene, const ToBody& body, Orientation* orientation) {
  orientation->source = body(scene.source.direction);
  for (const Observer& observer : scene.observers) {
    orientation->observers.push_back(at_source(observer, scene.source) ? orientation->source
                                                                       : body(observer.direction));
  }
}

std::vector<Orientation> spin_orientations(const Scene& scene) {
  const Motion& motion = *scene.motion;
  const double step_turns = motion.step_rad / kTwoPi;
  const double steps_per_turn = std::floor(1.0 / step_turns + 0.5);
  const bool whole = std::fabs(steps_per_turn * step_turns - 1.0) <= kWhole;
  // Whole turns are taken off exactly: those of the start, and those of the steps where a turn has a whole number of
  // them.
  const double first = turns_at(motion, motion.start_s);
  std::vector<Orientation> all;
  const std::size_t count = orientation_count(motion);
  all.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double index = static_cast<double>(k);
    const double product = index * step_turns;
    const double swept = whole ? std::fmod(index, steps_per_turn) / steps_per_turn
                               : reduce(product) + std::fma(index, step_turns, -product);
    const double turns = reduce(first + swept);
    Orientation o;
    const double since = whole ? index * motion.period_s / steps_per_turn : product * motion.period_s;
    o.time_s = motion.start_s + since;
    o.body_to_space = spin_quaternion(motion.axis, turns);
    place(
        scene, [&](const Vec3& v) { return turned(v, motion.axis, -turns); }, &o);
    all.push_back(std::move(o));
  }
  return all;
}

std::vector<Orientation> table_orientations(const Scene& scene) {
  const Motion& motion = *scene.motion;
  const auto [start, stop] = motion_span(motion);
  std::vector<double> times{start};
  for (const Attitude& a : motion.attitudes) {
    if (a.time_s > start && a.time_s <= stop) times.push_back(a.time_s);
  }
  std::vector<Orientation> all;
  for (const double time : times) {
    Orientation o;
    o.time_s = time;
    o.body_to_space = table_attitude(motion.attitudes, time);
    place(
        scene, [&](const Vec3& v) { return to_body(v, o.body_to_space); }, &o);
    all.push_back(std::move(o));
  }
  return all;
}

std::vector<Orientation> given_orientations(const Scene& scene) {
  std::vector<Orientation> all = scene.views;
  for (Orientation& o : all) {
    if (!o.observers.empty()) continue;
    for (const Observer& observer : scene.observers)
      o.observers.push_back(at_source(observer, scene.source) ? o.source : observer.direction);
  }
  return all;
}

}  // namespace

std::pair<double, double> motion_span(const Motion& motion) {
  const bool everything = !motion.attitudes.empty() && motion.start_s == 0.0 && motion.stop_s == 0.0;
  if (!everything) return {motion.start_s, motion.stop_s};
  return {motion.attitudes.front().time_s, motion.attitudes.back().time_s};
}

std::size_t orientation_count(const Motion& motion) {
  if (!motion.attitudes.empty()) {
    const auto [start, stop] = motion_span(motion);
    std::size_t count = 1;
    for (const Attitude& a : motion.attitudes) count += a.time_s > start && a.time_s <= stop;
    return count;
  }
  const double steps = (motion.stop_s - motion.start_s) / motion.period_s / (motion.step_rad / kTwoPi);
  const double nearest = std::floor(steps + 0.5);
  const bool whole = std::fabs(steps - nearest) <= kWhole * std::max(1.0, nearest);
  const double count = (whole ? nearest : std::floor(steps)) + 1.0;
  if (!(count >= 1.0 && count <= kMaxOrientations)) {
    throw Error(ErrorCode::input,
                "the motion needs between 1 and " + std::to_string(static_cast<long>(kMaxOrientations)) + " steps",
                "motion");
  }
  return static_cast<std::size_t>(count);
}

std::vector<Orientation> orientations(const Scene& scene) {
  if (!scene.views.empty()) return given_orientations(scene);
  if (scene.motion && !scene.motion->attitudes.empty()) return table_orientations(scene);
  if (scene.motion) return spin_orientations(scene);
  Orientation only;
  place(
      scene, [](const Vec3& v) { return v; }, &only);
  return {only};
}

Quaternion attitude_at(const Motion& motion, double time_s) {
  if (!motion.attitudes.empty()) return table_attitude(motion.attitudes, time_s);
  const double slack = kWhole * motion.period_s;
  if (!(time_s >= motion.start_s - slack) || !(time_s <= motion.stop_s + slack)) {
    throw Error(ErrorCode::input, "time " + std::to_string(time_s) + " s is outside the motion", "motion");
  }
  return spin_quaternion(motion.axis, turns_at(motion, time_s));
}

double hinge_angle(const Hinge& hinge, const Transform& transform, const Vec3& source, const Vec3& observer) {
  if (hinge.follow == Hinge::Follow::none) return hinge.angle_rad;
  const Vec3& target = hinge.follow == Hinge::Follow::source ? source : observer;
  const Vec3 normal = turned(Vec3(0.0, 0.0, 1.0), transform.axis, reduce(transform.angle_rad / kTwoPi));
  const Vec3 across = normal - dot(normal, hinge.axis) * hinge.axis;
  const double sine = dot(target, cross(hinge.axis, normal));
  const double cosine = dot(target, across);
  // If the target or the normal lies along the axis, all angles are equally good, and the fixed one is kept.
  if (sine * sine + cosine * cosine < 1e-24) return hinge.angle_rad;
  return el_atan2(sine, cosine);
}

}  // namespace clray
