// SPDX-License-Identifier: Apache-2.0
// Instants of passes: sights, attitudes, steps, shadow, masks, each against a computation of the test's own from the
// circular orbit that the files were written from.
#include <doctest/doctest.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "pass/instants.hpp"
#include "unit/pass_support.hpp"

using namespace clray;
using namespace clray::test;

namespace {

constexpr double kPi = 3.14159265358979323846, kLight = 299792458.0, kEarthRate = 7.292115146706979e-5;

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Vec3 turned(const Vec3& v, double about_z) {
  const double c = std::cos(about_z), s = std::sin(about_z);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

/// A place on the ellipsoid below an Earth-fixed direction, and its upward normal.
struct Place {
  Vec3 at, up;
};
Place place_below(const Vec3& direction, double height_m) {
  constexpr double kA = 6378137.0, kB = kA * (1.0 - 1.0 / 298.257223563);
  const Vec3 axes2(kA * kA, kA * kA, kB * kB);
  const Vec3 d = direction / std::sqrt(glm::dot(direction / axes2, direction));
  const Vec3 up = glm::normalize(d / axes2);
  return {d + height_m * up, up};
}

}  // namespace

TEST_CASE("pass: range, elevation and azimuth of a station and of an observer apart, light times included") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, -300, 900, 30, "ITRF2014"));
  const Place station = place_below(orbit.at(250.0) + Vec3(4e5, 3e5, 0.0), 120.0);
  const Place other = place_below(orbit.at(300.0) - Vec3(0.0, 5e5, 2e5), 0.0);
  const Scene scene =
      f.load("[station]\nposition_m = " + vector_text(station.at) + "\n[[observer]]\nname = \"here\"\n" +
             "[[observer]]\nname = \"there\"\necef_m = " + vector_text(other.at) + "\n" +
             "[[component]]\nshape = \"sphere\"\n" + pass_text("step_s = 20\n").substr(kPassBall.size()));
  CHECK(at_source(scene.observers[0], scene.source));
  CHECK_FALSE(at_source(scene.observers[1], scene.source));
  const std::vector<PassInstant> all = pass_instants(scene);
  REQUIRE(all.size() == 31);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PassInstant& x = all[i];
    const double t = 20.0 * static_cast<double>(i);
    CHECK(x.time_s == t);
    REQUIRE(x.sites.size() == 2);
    const Vec3 p = orbit.at(t), sight = p - station.at;
    CHECK(x.sites[0].observer == -1);
    CHECK(std::fabs(x.sites[0].range_m - glm::length(sight)) < 1e-3);
    CHECK(std::fabs(x.sites[0].elevation_rad - (0.5 * kPi - angle(sight, station.up))) < 1e-9);
    const Vec3 east = glm::normalize(glm::cross(Vec3(0, 0, 1), station.up)), north = glm::cross(station.up, east);
    const double azimuth = std::atan2(glm::dot(sight, east), glm::dot(sight, north));
    CHECK(std::fabs(std::remainder(x.sites[0].azimuth_rad - azimuth, 2.0 * kPi)) < 1e-9);
    CHECK(x.view.source_range_m == x.sites[0].range_m);
    CHECK(x.view.ranges_m[0] == x.sites[0].range_m);
    // The other site has moved on with the Earth when the light arrives.
    double back = glm::length(p - other.at);
    for (int round = 0; round < 5; ++round) back = glm::length(p - turned(other.at, kEarthRate * back / kLight));
    CHECK(std::fabs(x.view.ranges_m[1] - back) < 2e-3);
    const Vec3 seen = turned(p, -kEarthRate * back / kLight) - other.at;
    CHECK(std::fabs(x.sites[1].elevation_rad - (0.5 * kPi - angle(seen, other.up))) < 1e-9);
    // Angles between directions do not depend on the frame: up, down, and to the Earth's centre.
    double out = glm::length(p - station.at);
    for (int round = 0; round < 5; ++round) out = glm::length(p - turned(station.at, -kEarthRate * out / kLight));
    const Vec3 up = turned(station.at, -kEarthRate * out / kLight) - p,
               down = turned(other.at, kEarthRate * back / kLight) - p;
    CHECK(std::fabs(angle(x.view.source, x.view.observers[1]) - angle(up, down)) < 2e-9);
    CHECK(x.view.observers[0] == x.view.source);
    const Vec3 centre = glm::conjugate(x.view.body_to_space) * -x.position_m;
    CHECK(std::fabs(angle(x.view.source, centre) - angle(up, -p)) < 2e-9);
  }
}

TEST_CASE("pass: ranges of shots are those of the instants, up to the light's time") {
  const SceneFolder f;
  const Circle orbit;
  const Place station = place_below(orbit.at(250.0) + Vec3(4e5, 3e5, 0.0), 120.0);
  for (const char* frame : {"ITRF", "ICRF"}) {
    f.write("o.oem", circle_oem(orbit, -300, 900, 30, frame));
    const Scene scene =
        f.load("[station]\nposition_m = " + vector_text(station.at) + "\n[[component]]\nshape = \"sphere\"\n" +
               pass_text("step_s = 20\nmin_elevation_deg = -90\n").substr(kPassBall.size()));
    const ephemeris::RangeModel ranges = pass::range_model(scene);
    for (const PassInstant& x : pass_instants(scene)) {
      // A shot fired one light time before an instant meets the body at that instant.
      const double fired = x.time_s - x.sites[0].range_m / kLight;
      CHECK(std::fabs(ranges.range_m(fired) - x.sites[0].range_m) < 1e-3);
      CHECK(ephemeris::seconds_between(ranges.epoch(ephemeris::instant_of(x.time_s)), x.epoch) == 0.0);
    }
  }
}

TEST_CASE("pass: attitude laws by what defines them") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, -300, 900));
  const auto instants = [&](const std::string& attitude) {
    return pass_instants(f.load(kSunlit + pass_text("step_s = 100\n[pass.attitude]\n" + attitude)));
  };
  const auto in_body = [](const PassInstant& x, const Vec3& v) {
    return glm::conjugate(x.view.body_to_space) * glm::normalize(v);
  };
  for (const PassInstant& x : instants("law = \"nadir\"\n")) {
    CHECK(glm::length(x.position_m - orbit.at(x.time_s)) < 1e-4);
    CHECK(angle(in_body(x, -orbit.at(x.time_s)), Vec3(0, 0, 1)) < 1e-9);
    CHECK(angle(in_body(x, orbit.velocity(x.time_s)), Vec3(1, 0, 0)) < 1e-9);
  }
  for (const PassInstant& x : instants("law = \"nadir-yaw-steering\"\n")) {
    CHECK(angle(in_body(x, -orbit.at(x.time_s)), Vec3(0, 0, 1)) < 1e-9);
    CHECK(std::fabs(x.sun.y) < 1e-9);
    CHECK(x.sun.x > 0.0);
  }
  for (const PassInstant& x : instants("law = \"sun-pointing\"\n")) {
    CHECK(angle(x.view.source, Vec3(0, 0, 1)) < 1e-9);
    const Vec3 pole = in_body(x, Vec3(0, 0, 1));
    CHECK(std::fabs(pole.y) < 1e-9);
    CHECK(pole.x > 0.0);
  }
  const std::vector<PassInstant> still =
      instants("law = \"inertial\"\noffset = { axis = [1, 0, 0], angle_deg = 90 }\n");
  CHECK(angle(in_body(still[0], Vec3(0, 0, 1)), Vec3(0, 1, 0)) < 1e-12);  // the body's y now points up
  // A turn in 40 s from 30 degrees on, about z in space: 100 s make two turns and a half.
  const std::vector<PassInstant> spin =
      instants("law = \"spin\"\nspin = { axis = [0, 0, 1], period_s = 40, phase_deg = 30 }\n");
  CHECK(angle(spin[0].view.body_to_space * Vec3(1, 0, 0), Vec3(std::cos(kPi / 6), std::sin(kPi / 6), 0)) < 1e-12);
  CHECK(angle(spin[1].view.body_to_space * Vec3(1, 0, 0), spin[0].view.body_to_space * Vec3(-1, 0, 0)) < 1e-12);
  // The same about y of the orbit: against its normal.
  for (const PassInstant& x :
       instants("law = \"spin\"\nspin = { axis = [0, 1, 0], period_s = 40, frame = \"orbit\" }\n"))
    CHECK(angle(in_body(x, glm::cross(orbit.velocity(x.time_s), orbit.at(x.time_s))), Vec3(0, 1, 0)) < 1e-9);
  f.write("a.csv", "mjd,qx,qy,qz,qw\n61369.75,0,0,0,1\n61369.7600,0,0,1,0\n");
  const std::vector<PassInstant> table = instants("attitudes = \"a.csv\"\n");
  CHECK(angle(table[4].view.body_to_space * Vec3(1, 0, 0), turned(Vec3(1, 0, 0), kPi * 400.0 / 864.0)) < 1e-9);
  f.write(
      "a.aem",
      "CCSDS_AEM_VERS = 2.0\nCREATION_DATE = 2026-11-25\nORIGINATOR = CLR\nMETA_START\nOBJECT_NAME = A\nOBJECT_ID = B\n"
      "REF_FRAME_A = LVLH\nREF_FRAME_B = SC_BODY_1\nTIME_SYSTEM = UTC\nSTART_TIME = " +
          date_after(0) + "\nSTOP_TIME = " + date_after(600) + "\nATTITUDE_TYPE = QUATERNION\nMETA_STOP\nDATA_START\n" +
          date_after(0) + " 0 0 0 1\n" + date_after(600) + " 0 0 0 1\nDATA_STOP\n");
  for (const PassInstant& x : instants("file = \"a.aem\"\n"))
    CHECK(angle(in_body(x, -orbit.at(x.time_s)), Vec3(0, 0, 1)) < 1e-9);
}

TEST_CASE("pass: steps by angle hold the angle, and are as few as that allows") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, -300, 2400));
  const std::string observer =
      "[[observer]]\necef_m = " + vector_text(place_below(turned(orbit.at(600.0), -4.3), 0.0).at) + "\n";
  for (const std::string& attitude : {std::string("law = \"nadir\"\n"),
                                      std::string("law = \"spin\"\nspin = { axis = [0, 0.6, 0.8], period_s = 9 }\n")}) {
    const bool spins = attitude.find("spin") != std::string::npos;
    const std::string step = spins ? "step_deg = 15\n" : "step_deg = 2\n";
    const Scene scene =
        f.load(observer + "[source]\nkind = \"sun\"\n[[component]]\nshape = \"sphere\"\n" +
               pass_text(step + "min_elevation_deg = -90\n[pass.attitude]\n" + attitude, spins ? 90 : 1200)
                   .substr(kPassBall.size()));
    Scene fine = scene;
    fine.pass->step_rad = 0.0;
    fine.pass->step_s = spins ? 0.01 : 1.0;
    const std::vector<PassInstant> all = pass_instants(scene), dense = pass_instants(fine);
    CHECK(all.size() > 20);
    const double hold = spins ? 15.0 : 2.0;
    const auto moved = [](const PassInstant& a, const PassInstant& b) {
      return std::max(angle(a.view.source, b.view.source), angle(a.view.observers[0], b.view.observers[0])) * 180.0 /
             kPi;
    };
    for (const PassInstant& d : dense) {
      const auto after = std::upper_bound(all.begin(), all.end(), d.time_s,
                                          [](double t, const PassInstant& x) { return t < x.time_s; });
      CHECK(moved(*(after - 1), d) <= hold * (1.0 + 1e-6));
    }
    for (std::size_t i = 0; i + 2 < all.size(); ++i) CHECK(moved(all[i], all[i + 1]) > 0.999 * hold);
  }
}

TEST_CASE("pass: entry into the Earth's shadow to 0.1 s, and the share of the Sun on the way") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, 0, 7200));
  Scene scene = f.load(kSunlit + pass_text("step_s = 10\n", 7000));
  const std::vector<PassInstant> all = pass_instants(scene);
  const auto dark = std::find_if(all.begin(), all.end(), [](const PassInstant& x) { return x.sun_share == 0.0; });
  REQUIRE(dark != all.end());
  REQUIRE(dark != all.begin());
  CHECK(dark->reason == "in the Earth's shadow");
  CHECK_FALSE(dark->traced());
  // Rays to the Sun's limb past the ellipsoid: all blocked in the umbra, none outside the penumbra. Where the Sun is,
  // is another test's matter; in gcrf the Earth's pole is z to 2.6e-3, which tilts a flattening of 21 km by 60 m.
  const Vec3 sun = 1.476e11 * (dark->view.body_to_space * dark->sun);
  const auto blocked = [&](double t) {
    constexpr double kStretch = 1.0 / (1.0 - 1.0 / 298.257223563);
    int count = 0;
    const Vec3 p = orbit.at(t), e = glm::normalize(sun);
    const Vec3 u = glm::normalize(glm::cross(e, Vec3(0.3, 0.5, 0.8))), v = glm::cross(e, u);
    for (int i = 0; i < 720; ++i) {
      const double phi = i * kPi / 360.0;
      Vec3 q = p, ray = sun + 6.957e8 * (std::cos(phi) * u + std::sin(phi) * v);
      q.z *= kStretch;
      ray.z *= kStretch;
      ray = glm::normalize(ray);
      const double along = -glm::dot(q, ray);
      count += along > 0.0 && glm::length(q + along * ray) < 6378137.0;
    }
    return count;
  };
  const auto entry = [&](int limb_points) {
    double low = dark->time_s - 60.0, high = dark->time_s;
    while (high - low > 1e-3) {
      const double middle = 0.5 * (low + high);
      (blocked(middle) >= limb_points ? high : low) = middle;
    }
    return high;
  };
  const double penumbra = entry(1), umbra = entry(720);
  CHECK(umbra - penumbra > 5.0);
  const auto share_at = [&](double t) {
    scene.pass->times_s = {t};
    scene.pass->stop_s = t;
    scene.source.toward = Toward::sun;
    try {
      return pass_instants(scene).front().sun_share;
    } catch (const Error&) {
      return 0.0;  // nothing is left to trace
    }
  };
  CHECK(share_at(penumbra - 0.1) == 1.0);
  CHECK(share_at(penumbra + 0.1) < 1.0);
  CHECK(share_at(umbra - 0.1) > 0.0);
  CHECK(share_at(umbra + 0.1) == 0.0);
  CHECK(share_at(0.5 * (penumbra + umbra)) == doctest::Approx(0.5).epsilon(0.1));
  for (const PassInstant& x : all) CHECK(x.view.light == x.sun_share);
}

TEST_CASE("pass: masks, daylight, files that do not reach, and why instants are not traced") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, -60, 600, 30, "ITRF"));
  const Place station = place_below(orbit.at(300.0), 0.0);
  const std::string at = "[station]\nposition_m = " + vector_text(station.at) + "\n[[component]]\nshape = \"sphere\"\n";
  const auto text = [&](const std::string& more, int seconds) {
    return at + pass_text(more, seconds).substr(kPassBall.size());
  };
  const Scene scene = f.load(text("step_s = 20\nmin_elevation_deg = 30\n", 800));
  std::size_t traced = 0, low = 0, beyond = 0;
  for (const PassInstant& x : pass_instants(scene)) {
    if (x.time_s > 600.0) {
      CHECK(x.reason == "no ephemeris");
      CHECK_FALSE(x.placed);
      ++beyond;
    } else if (x.sites[0].elevation_rad < kPi / 6.0) {
      CHECK(x.reason == "below min_elevation_deg");
      ++low;
    } else {
      CHECK(x.traced());
      CHECK(x.orientation == traced++);
      CHECK(x.until_s == doctest::Approx(x.time_s + 20.0));
    }
    if (x.placed) CHECK(x.sites[0].daylight == (x.sites[0].sun_elevation_rad > -0.8333 * kPi / 180.0));
  }
  CHECK(traced > 5);
  CHECK(low > 3);
  CHECK(beyond == 10);
  CHECK(pass::views(scene).size() == traced);
  const std::vector<std::string> warnings = pass_warnings(scene);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].find("UT1 is taken as UTC") != std::string::npos);
  CHECK(warnings[1].find("10 are not traced, as files do not reach them") != std::string::npos);
  const std::string said = describe_pass(scene);
  CHECK(said.find("41 from 2026-11-25T18:00:00.000Z to 2026-11-25T18:13:20.000Z") != std::string::npos);
  CHECK(said.find("10 no ephemeris") != std::string::npos);
  CHECK(said.find("station clray: elevation") != std::string::npos);
  CHECK(pass_complaint(f, text("step_s = 20\nmin_elevation_deg = 89.999\n", 100)) ==
        "s.toml:6:9: pass.start: nothing to trace: of 6 instants, 6 below min_elevation_deg");
  const std::string late = pass_complaint(
      f, at + "[pass]\nstart = 2026-11-26T18:00:00Z\nstop = 2026-11-26T18:01:00Z\nstep_s = 9\nephemeris = \"o.oem\"\n");
  CHECK(late ==
        "s.toml:9:13: pass.ephemeris: the orbit covers 2026-11-25 17:59:00 UTC to 2026-11-25 18:10:00 UTC; the pass "
        "needs "
        "2026-11-26 18:00:00 UTC to 2026-11-26 18:00:54 UTC");
}

TEST_CASE("pass: aberration tilts light and sight by v/c") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", circle_oem(orbit, -300, 900));
  const auto instants = [&](bool on) {
    return pass_instants(f.load(
        "[[observer]]\necef_m = " + vector_text(place_below(turned(orbit.at(0.0), -1.1), 0.0).at) +
        "\n[source]\nkind = \"sun\"\n[[component]]\nshape = \"sphere\"\n" +
        pass_text(std::string("min_elevation_deg = -90\nstep_s = 100\naberration = ") + (on ? "true\n" : "false\n"))
            .substr(kPassBall.size())));
  };
  const std::vector<PassInstant> with = instants(true), without = instants(false);
  for (std::size_t i = 0; i < with.size(); ++i) {
    const Vec3 v = orbit.velocity(with[i].time_s) / kLight;
    const Vec3 o = without[i].view.observers[0], s = without[i].view.source;
    CHECK(angle(with[i].view.observers[0], o - v) < 1e-9);
    // The Earth's 30 km/s and the orbit's 7: between 7 and 13 parts in 1e5 across, less along the Sun's direction.
    const Vec3 tilt = with[i].view.source - s;
    CHECK(glm::length(tilt - (v - glm::dot(v, s) * s)) == doctest::Approx(29.8e3 / kLight).epsilon(0.03));
  }
}

TEST_CASE("pass: instants from a file, tables of directions and of states") {
  const SceneFolder f;
  const Circle orbit;
  std::string states = "time_utc,x_km,y_km,z_km\n", seconds = "z_m,y_m,x_m,t_s\n";
  for (int t = -60; t <= 600; t += 20) {
    const Vec3 p = orbit.at(t);
    states += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", date_after(t), p.x / 1e3, p.y / 1e3, p.z / 1e3);
    seconds += fmt::format("{:.6f},{:.6f},{:.6f},{}\n", p.z, p.y, p.x, t);
  }
  f.write("states.csv", states);
  f.write("seconds.csv", seconds);
  f.write("t.csv", "time_utc\n2026-11-25T18:00:00Z\n2026-11-25T18:00:07.25Z\n2026-11-25T18:05:00Z\n");
  f.write("d.csv", "time_s,x,y,z,range_km\n0,0,0,2,1000\n400,0,2,0,3000\n");
  const std::string text =
      kPassBall +
      "[source]\ndirections = \"d.csv\"\nframe = \"body\"\n[[observer]]\n"
      "direction = [1, 0, 0]\nrange_m = 5e6\n[pass]\ntimes = \"t.csv\"\nephemeris = \"states.csv\"\n";
  const std::vector<PassInstant> all = pass_instants(f.load(text));
  REQUIRE(all.size() == 3);
  CHECK(all[1].time_s == 7.25);
  CHECK(glm::length(all[1].position_m - orbit.at(7.25)) < 1e-3);
  CHECK(all[2].view.source_range_m == 2.5e6);
  CHECK(angle(all[2].view.source, Vec3(0, 3, 1)) < 1e-9);  // three quarters of the way along the chord
  CHECK(all[2].view.ranges_m[0] == 5e6);
  const std::vector<PassInstant> same =
      pass_instants(f.load(kPassBall + kSunlit +
                           "[pass]\nstart = 2026-11-25T18:00:00Z\nstop_mjd = 61369.7502\nstep_s = 5\n"
                           "ephemeris = \"seconds.csv\"\nframe = \"gcrf\"\n"));
  CHECK(same.size() == 4);  // 17.28 s
  CHECK(glm::length(same[1].position_m - orbit.at(5.0)) < 1e-3);
}
