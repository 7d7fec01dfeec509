// SPDX-License-Identifier: Apache-2.0
// Motion against closed forms: spin at quarter turns and after 10^9 turns, its steps, slerp, hinges.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/error.hpp"
#include "scene/motion.hpp"

using namespace clray;

namespace {

constexpr double kPi = 3.14159265358979323846;
/// Some ten roundings of numbers of size one.
constexpr double kTolerance = 4e-15;

Scene spinning(double start, double stop, double step_deg, double period = 40.0, Vec3 axis = {0, 1, 0}) {
  Scene scene;
  scene.observers.push_back({});
  Motion m;
  m.axis = axis;
  m.period_s = period;
  m.start_s = start;
  m.stop_s = stop;
  m.step_rad = step_deg / 180.0 * kPi;
  scene.motion = m;
  return scene;
}

void check_near(const Vec3& a, const Vec3& b, double tolerance = kTolerance) {
  CHECK(std::fabs(a.x - b.x) <= tolerance);
  CHECK(std::fabs(a.y - b.y) <= tolerance);
  CHECK(std::fabs(a.z - b.z) <= tolerance);
}

/// The rotation of a Hamilton quaternion as q v q*, in plain products.
Vec3 rotated(const Quaternion& q, const Vec3& v) {
  const double w = q.w, x = q.x, y = q.y, z = q.z;
  return {(w * w + x * x - y * y - z * z) * v.x + 2 * (x * y - w * z) * v.y + 2 * (x * z + w * y) * v.z,
          2 * (x * y + w * z) * v.x + (w * w - x * x + y * y - z * z) * v.y + 2 * (y * z - w * x) * v.z,
          2 * (x * z - w * y) * v.x + 2 * (y * z + w * x) * v.y + (w * w - x * x - y * y + z * z) * v.z};
}

}  // namespace

TEST_CASE("motion: none is one orientation, the identity, in the scene's own bits") {
  Scene scene;
  scene.source.direction = {0.6, 0.0, 0.8};
  scene.observers.resize(2);
  scene.observers[1].monostatic = false;
  scene.observers[1].direction = {0.0, 1.0, 0.0};
  const std::vector<Orientation> all = orientations(scene);
  REQUIRE(all.size() == 1);
  CHECK(all[0].source == scene.source.direction);
  CHECK(all[0].observers[0] == scene.source.direction);
  CHECK(all[0].observers[1] == scene.observers[1].direction);
  CHECK(all[0].body_to_space == Quaternion(1, 0, 0, 0));
}

TEST_CASE("motion: steps are counted through the end") {
  CHECK(orientations(spinning(0, 20, 2)).size() == 91);
  CHECK(orientations(spinning(0, 40, 2)).size() == 181);
  CHECK(orientations(spinning(0, 20.05, 2)).size() == 91);
  CHECK(orientations(spinning(0, 19.99, 2)).size() == 90);
  CHECK(orientations(spinning(5, 5, 2)).size() == 1);
  CHECK(orientations(spinning(0, 40, 7)).size() == 52);  // 360/7 = 51.4…
  const std::vector<Orientation> all = orientations(spinning(3, 23, 2));
  CHECK(all.back().time_s == 23.0);
  CHECK(all[45].time_s == 13.0);
  CHECK_THROWS_AS(orientation_count(*spinning(0, 1e9, 0.01, 1).motion), Error);
}

TEST_CASE("motion: the light turns against the body, exactly at quarter turns") {
  const Scene scene = spinning(0, 40, 2);
  const std::vector<Orientation> all = orientations(scene);
  // Body turned by +90° about y: its z axis lies along +x of space, so light from +z comes from its -x.
  CHECK(all[45].source == Vec3(-1, 0, 0));
  CHECK(all[90].source == Vec3(0, 0, -1));
  CHECK(all[135].source == Vec3(1, 0, 0));
  CHECK(all[180].source == all[0].source);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double angle = static_cast<double>(k) * kPi / 90.0;
    check_near(all[k].source, Vec3(-std::sin(angle), 0, std::cos(angle)));
    check_near(rotated(all[k].body_to_space, all[k].source), scene.source.direction);
    CHECK(all[k].observers[0] == all[k].source);
  }
}

TEST_CASE("motion: a skew axis leaves its own direction alone and agrees with the quaternion") {
  const double third = 1.0 / std::sqrt(3.0);
  Scene scene = spinning(0, 40, 7.3, 40, {third, third, third});
  scene.observers.push_back({"axis", {third, third, third}, false, 0.0});
  for (const Orientation& o : orientations(scene)) {
    check_near(o.observers[1], {third, third, third});
    check_near(rotated(o.body_to_space, o.source), scene.source.direction);
  }
}

TEST_CASE("motion: 10^9 whole turns change no bit") {
  for (const double period : {40.0, 20.0, 0.75}) {
    for (const double step : {2.0, 7.0, 0.1}) {
      const double long_ago = 1e9 * period;  // exact for these periods
      const std::vector<Orientation> now = orientations(spinning(0, period / 2, step, period));
      const std::vector<Orientation> later = orientations(spinning(long_ago, long_ago + period / 2, step, period));
      REQUIRE(now.size() == later.size());
      for (std::size_t k = 0; k < now.size(); ++k) {
        CHECK(now[k].source == later[k].source);
        CHECK(now[k].body_to_space == later[k].body_to_space);
      }
    }
  }
  const Scene scene = spinning(0, 4e10 + 10, 2);
  CHECK(attitude_at(*scene.motion, 4e10 + 10) == attitude_at(*scene.motion, 10));
}

TEST_CASE("motion: a phase leads, and time within the motion interpolates the spin") {
  Scene scene = spinning(0, 40, 2);
  scene.motion->phase_rad = kPi / 2;
  CHECK(orientations(scene)[0].source == Vec3(-1, 0, 0));
  const Quaternion q = attitude_at(*scene.motion, 5.0);  // an eighth of a turn beyond the phase: 135°
  CHECK(q.w == doctest::Approx(std::cos(67.5 / 180 * kPi)).epsilon(1e-15));
  CHECK(q.y == doctest::Approx(std::sin(67.5 / 180 * kPi)).epsilon(1e-15));
  CHECK_THROWS_AS(attitude_at(*scene.motion, 40.1), Error);
}

TEST_CASE("motion: slerp turns at an even rate, the short way") {
  Motion m;
  const double half = kPi / 6;  // 60° about x between the two
  m.attitudes = {{10.0, Quaternion(1, 0, 0, 0)}, {20.0, Quaternion(-std::cos(half), -std::sin(half), 0, 0)}};
  for (double t = 10.0; t <= 20.0; t += 0.625) {
    const double angle = half * (t - 10.0) / 10.0;
    const Quaternion q = attitude_at(m, t);
    const double sign = q.w < 0.0 ? -1.0 : 1.0;
    CHECK(std::fabs(sign * q.w - std::cos(angle)) <= kTolerance);
    CHECK(std::fabs(sign * q.x - std::sin(angle)) <= kTolerance);
  }
  CHECK_THROWS_AS(attitude_at(m, 9.99), Error);
  CHECK_THROWS_AS(attitude_at(m, 20.01), Error);
}

TEST_CASE("motion: slerp of nearly equal attitudes keeps its relative accuracy") {
  Motion m;
  for (const double tiny : {1e-3, 1e-7, 1e-9, 1e-12}) {
    m.attitudes = {{0.0, Quaternion(1, 0, 0, 0)}, {1.0, Quaternion(std::cos(tiny), 0, std::sin(tiny), 0)}};
    const Quaternion q = attitude_at(m, 0.25);
    CHECK(std::fabs(q.y / std::sin(0.25 * tiny) - 1.0) <= 1e-14);
  }
}

TEST_CASE("motion: a table gives an orientation per entry within the window") {
  Scene scene = spinning(0, 0, 2);
  const double h = std::sqrt(0.5);
  scene.motion->attitudes = {{0.0, {1, 0, 0, 0}}, {1.0, {h, 0, h, 0}}, {3.0, {0, 0, 1, 0}}};
  std::vector<Orientation> all = orientations(scene);
  REQUIRE(all.size() == 3);
  check_near(all[1].source, {-1, 0, 0});
  check_near(all[2].source, {0, 0, -1});
  scene.motion->start_s = 0.5;
  scene.motion->stop_s = 2.0;
  all = orientations(scene);
  REQUIRE(all.size() == 2);
  CHECK(all[0].time_s == 0.5);
  check_near(all[0].source, {-h, 0, h});
  CHECK(all[1].time_s == 1.0);
}

TEST_CASE("motion: a hinge turns +z nearest to what it follows") {
  Hinge hinge;
  hinge.axis = {0, 1, 0};
  hinge.follow = Hinge::Follow::source;
  Transform transform;
  CHECK(hinge_angle(hinge, transform, {1, 0, 0}, {0, 0, 1}) == doctest::Approx(kPi / 2).epsilon(1e-15));
  CHECK(hinge_angle(hinge, transform, {0.6, 0.2, 0.8}, {0, 0, 1}) ==
        doctest::Approx(std::atan2(0.6, 0.8)).epsilon(1e-15));
  hinge.follow = Hinge::Follow::observer;
  CHECK(hinge_angle(hinge, transform, {1, 0, 0}, {-1, 0, 0}) == doctest::Approx(-kPi / 2).epsilon(1e-15));
  transform.axis = {0, 1, 0};
  transform.angle_rad = kPi / 3;  // already a part of the way
  CHECK(hinge_angle(hinge, transform, {0, 0, 1}, {1, 0, 0}) == doctest::Approx(kPi / 6).epsilon(1e-14));
  hinge.angle_rad = 0.25;
  CHECK(hinge_angle(hinge, transform, {0, 0, 1}, {0, 1, 0}) == 0.25);  // along the axis: nothing to choose
  hinge.follow = Hinge::Follow::none;
  CHECK(hinge_angle(hinge, transform, {1, 0, 0}, {1, 0, 0}) == 0.25);
}

TEST_CASE("motion: the hinge's angle beats a search over all angles") {
  Hinge hinge;
  hinge.axis = {2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
  hinge.follow = Hinge::Follow::source;
  Transform transform;
  transform.axis = {0.6, 0.8, 0.0};
  transform.angle_rad = 1.1;
  const Vec3 source(0.48, -0.6, 0.64);
  const auto turn = [](const Vec3& v, const Vec3& a, double angle) {
    return rotated(Quaternion(std::cos(angle / 2), std::sin(angle / 2) * a.x, std::sin(angle / 2) * a.y,
                              std::sin(angle / 2) * a.z),
                   v);
  };
  const auto score = [&](double angle) {
    const Vec3 z = turn(turn({0, 0, 1}, transform.axis, transform.angle_rad), hinge.axis, angle);
    return z.x * source.x + z.y * source.y + z.z * source.z;
  };
  const double best = score(hinge_angle(hinge, transform, source, source));
  for (int i = 0; i < 3600; ++i) CHECK(score(i * kPi / 1800.0) <= best + kTolerance);
}
