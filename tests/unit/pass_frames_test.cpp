// SPDX-License-Identifier: Apache-2.0
// Frames, the Sun and the Earth's shadow against published examples and computations of the test's own: the SOFA
// cookbook, the Astronomical Almanac's low-precision Sun, the equinox, cones about a sphere, rays past an ellipsoid.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "clray/error.hpp"
#include "pass/frames.hpp"
#include "pass/shadow.hpp"
#include "pass/sun.hpp"
#include "unit/ephemeris_support.hpp"

using namespace clray;
using namespace clray::pass;
using clray::test::Folder;

namespace {

constexpr double kPi = 3.14159265358979323846, kArcsec = kPi / 648000.0;

Epoch date(const char* text) {
  Epoch epoch;
  REQUIRE(ephemeris::read_date(text, &epoch));
  return epoch;
}

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

TEST_CASE("frames: the SOFA cookbook's example of 2007 April 5, 12h UTC") {
  const Folder folder;
  const std::string eop =
      folder.write("eop.csv",
                   "mjd,ut1_utc_s,x_pole_arcsec,y_pole_arcsec\n54195,-0.072073685,0.0349282,0.4833163\n"
                   "54196,-0.072073685,0.0349282,0.4833163\n");
  const Epoch epoch = date("2007-04-05T12:00:00");
  const EarthFrames frames(epoch, epoch, EarthOrientation(eop));
  const Matrix m = frames.itrf_of_gcrf(epoch);
  // "Tools for Earth Attitude", section 5.5, row by row. The example also moves the pole by 0.2 mas (1.4e-9 rad).
  const double expected[3][3] = {{0.973104317697535, 0.230363826239128, -0.000703163482198},
                                 {-0.230363800456037, 0.973104570632801, 0.000118545366625},
                                 {0.000711560162668, 0.000046626403995, 0.999999745754024}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      CAPTURE(row);
      CAPTURE(column);
      CHECK(std::fabs(m[column][row] - expected[row][column]) < 3e-9);
    }
  }
}

TEST_CASE("frames: without Earth orientation, and of other epochs") {
  const Epoch start = date("2026-11-25T00:00:00"), stop = date("2026-11-26T00:00:00");
  const EarthFrames frames(start, stop, {});
  CHECK_FALSE(frames.orientation_known());
  for (double t = 0.0; t <= 86400.0; t += 3333.0) {
    const Epoch e = ephemeris::later(start, t);
    const Matrix m = frames.itrf_of_gcrf(e);
    CHECK(glm::determinant(m) == doctest::Approx(1.0).epsilon(1e-12));
    // Between the nodes as at a node.
    const Matrix own = EarthFrames(e, e, {}).itrf_of_gcrf(e);
    for (int c = 0; c < 3; ++c) CHECK(glm::length(m[c] - own[c]) < 1e-11);
    // IAU 1982 sidereal time on the mean equator: precession in right ascension and declination since 2000 take the
    // mean pole along; nutation moves the rest by less than 20 arcsec.
    const double tu =
        (60000.0 - 51544.5 + static_cast<double>(e.mjd - 60000) + static_cast<double>(e.ps) / 86400e12) / 36525.0;
    const double gmst =
        (67310.54841 + (876600.0 * 3600.0 + 8640184.812866) * tu + 0.093104 * tu * tu) / 86400.0 * 2.0 * kPi;
    const double zeta = 2306.2181 * tu * kArcsec, theta = 2004.3109 * tu * kArcsec;
    // Where the mean equinox of date stands in the frame of 2000, and the Earth's x axis a sidereal angle on from it.
    const Vec3 z(std::sin(theta) * std::cos(zeta), -std::sin(theta) * std::sin(zeta), std::cos(theta));
    const Vec3 equinox = glm::normalize(glm::cross(Vec3(0, -std::sin(0.40909), std::cos(0.40909)), z)) * -1.0;
    const Vec3 across = glm::cross(z, equinox);
    const Vec3 x = std::cos(gmst) * equinox + std::sin(gmst) * across;
    CHECK(angle(glm::transpose(m) * Vec3(1, 0, 0), x) < 25.0 * kArcsec);
    CHECK(angle(glm::transpose(m) * Vec3(0, 0, 1), z) <
          12.0 * kArcsec);  // nutation in obliquity 9", longitude 17" sin e
    // TOD's z axis is the pole, TEME shares it; both are rotations.
    const Matrix tod = frames.gcrf_of(Frame::tod, e), teme = frames.gcrf_of(Frame::teme, e);
    CHECK(angle(tod[2], glm::transpose(m) * Vec3(0, 0, 1)) < 1e-9);
    CHECK(angle(teme[2], tod[2]) < 1e-9);
    CHECK(angle(teme[0], tod[0]) < 20.0 * kArcsec);  // the equation of the equinoxes
    CHECK(angle(teme[0], equinox) < 20.0 * kArcsec);
    // The frame bias: 23 mas.
    CHECK(angle(frames.gcrf_of(Frame::eme2000, e)[0], Vec3(1, 0, 0)) < 0.03 * kArcsec);
    CHECK(angle(frames.gcrf_of(Frame::eme2000, e)[1], Vec3(0, 1, 0)) > 0.01 * kArcsec);
  }
}

TEST_CASE("Earth orientation: files of the IERS, between days, through a leap second, and faults") {
  const Folder folder;
  // The columns of finals2000A: MJD 8-15, flag 17, x 19-27, y 38-46, flag 58, UT1 - UTC 59-68.
  const auto finals = [](const char* mjd, const char* x, const char* y, const char* ut1) {
    return fmt::format("161231 {} I {:>9} 0.000035 {:>9} 0.000044  I{:>10} 0.0000083  1.0\n", mjd, x, y, ut1);
  };
  const std::string text = finals("57753.00", " 0.085000", " 0.290000", "-0.4080000") +
                           finals("57754.00", " 0.083000", " 0.292000", " 0.5910000") + "170102 57755.00\n";
  const EarthOrientation all(folder.write("finals.all", text));
  const EarthAngles o = all.at(date("2016-12-31T12:00:00"));
  CHECK(o.pole_x_rad == doctest::Approx(0.084 * kArcsec));
  CHECK(o.pole_y_rad == doctest::Approx(0.291 * kArcsec));
  CHECK(o.ut1_utc_s == doctest::Approx(-0.4085));  // the second of 2016 is no step of UT1
  CHECK(all.at(date("2017-01-01T00:00:00")).ut1_utc_s == doctest::Approx(0.591));
  const EarthOrientation csv(folder.write(
      "finals.csv",
      "MJD;Year;Month;Day;Type;x_pole;sigma_x_pole;y_pole;sigma_y_pole;Type;UT1-UTC;sigma\n"
      "57753;2016;12;31;final;0.085;0;0.290;0;final;-0.408;0\n57754;2017;1;1;final;0.083;0;0.292;0;final;0.591;0\n"
      "57755;2017;1;2;;;;;;;;\n"));
  CHECK(csv.at(date("2016-12-31T12:00:00")).ut1_utc_s == doctest::Approx(-0.4085));
  CHECK_THROWS_WITH_AS(csv.at(date("2017-01-03T00:00:00")), doctest::Contains("outside its days (MJD 57753 to 57754)"),
                       Error);
  const auto refused = [&](const std::string& bad, const char* words) {
    CHECK_THROWS_WITH_AS(EarthOrientation(folder.write("bad.csv", bad)), doctest::Contains(words), Error);
  };
  refused("", "is empty");
  refused("day,ut1\n1,2\n", "bad.csv:1: expected the names mjd");
  const std::string head = "mjd,ut1_utc_s,x_pole_arcsec,y_pole_arcsec\n";
  refused(head, "holds no day");
  refused(head + "57753,a,0,0\n", "bad.csv:2: 'a'; expected a number");
  refused(head + "57753,1.5,0,0\n", "bad.csv:2: UT1 - UTC is 1.5 s");
  refused(head + "57753,0,85,0\n", "bad.csv:2: the pole is at 85, 0 arcsec");
  refused(head + "57753,0,0,0\n57753,0,0,0\n", "bad.csv:3: days must increase");
}

TEST_CASE("the Sun: the Almanac's low-precision formula, and the equinox of March 2025") {
  for (int day = 0; day < 365; day += 11) {
    const Epoch e{61369 + day, 0};
    const double n = static_cast<double>(e.mjd) - 51544.5;
    const double l = (280.460 + 0.9856474 * n) * kPi / 180.0, g = (357.528 + 0.9856003 * n) * kPi / 180.0;
    const double longitude = l + (1.915 * std::sin(g) + 0.020 * std::sin(2.0 * g)) * kPi / 180.0;
    const double obliquity = (23.439 - 0.0000004 * n) * kPi / 180.0;
    const Vec3 of_date(std::cos(longitude), std::cos(obliquity) * std::sin(longitude),
                       std::sin(obliquity) * std::sin(longitude));
    const EarthFrames frames(e, e, {});
    const SunSight sun = sun_at(e);
    // Good to 0.01 degree (36 arcsec), aberration included, which is 20.5 arcsec here.
    const Vec3 apparent = glm::normalize(glm::normalize(sun.from_earth_m) + sun.earth_velocity_m_s / 299792458.0);
    CHECK(angle(frames.gcrf_of(Frame::tod, e) * of_date, apparent) < 40.0 * kArcsec);
    const double au = 1.00014 - 0.01671 * std::cos(g) - 0.00014 * std::cos(2.0 * g);
    CHECK(glm::length(sun.from_earth_m) / 149597870700.0 == doctest::Approx(au).epsilon(1e-4));
  }
  // 2025-03-20 09:01 UTC. The Sun's declination changes by 0.99 arcsec a minute.
  const Epoch equinox = date("2025-03-20T09:01:30");
  const SunSight sun = sun_at(equinox);
  const Matrix to_date = glm::transpose(EarthFrames(equinox, equinox, {}).gcrf_of(Frame::tod, equinox));
  const Vec3 apparent = glm::normalize(sun.from_earth_m) + sun.earth_velocity_m_s / 299792458.0;
  CHECK(std::fabs(std::asin((to_date * glm::normalize(apparent)).z)) < 1.0 * kArcsec);
}

TEST_CASE("shadow: the share of the disk by the area of a lens, umbra and penumbra by their cones") {
  constexpr double kSun = 6.957e8, kEarth = 6378137.0, kFar = 1.496e11;
  for (const double behind : {7.0e6, 26.6e6, 42.164e6}) {
    for (int i = -40; i <= 40; ++i) {
      // Along the shadow's edge: where the disks' edges touch, and steps about it.
      const double y = kEarth + i * 1e-3 * behind;
      const Vec3 place(-behind, y, 0.0), sun(kFar, 0.0, 0.0);
      const Vec3 s = sun - place;
      const double a = std::asin(kSun / glm::length(s)), b = std::asin(kEarth / glm::length(place)),
                   c = angle(s, -place);
      double dark = 0.0;
      if (c <= b - a) {
        dark = 1.0;
      } else if (c < a + b) {
        // Spherical caps of half angles a and b, the smaller about flat: the lens of Montenbruck and Gill
        // (2000), 3.4.2.
        const double x = (c * c + a * a - b * b) / (2.0 * c), h = std::sqrt(std::max(0.0, a * a - x * x));
        dark = (a * a * std::acos(x / a) + b * b * std::acos((c - x) / b) - c * h) / (kPi * a * a);
      }
      CAPTURE(behind);
      CAPTURE(i);
      // Montenbruck's flat disks are good to the square of their size where the Earth is large: 2e-3 at 65 degrees.
      CHECK(visible_share(place, sun, kSun, kEarth, 0.0) == doctest::Approx(1.0 - dark).epsilon(5e-3));
      const bool umbra = c<b - a - 1e-6, light = c> a + b + 1e-6;
      if (umbra) CHECK(visible_share(place, sun, kSun, kEarth, 0.0) == 0.0);
      if (light) CHECK(visible_share(place, sun, kSun, kEarth, 0.0) == 1.0);
      if (!umbra && !light) CHECK(visible_share(place, sun, kSun, kEarth, 0.0) > 0.0);
    }
  }
  CHECK(visible_share({1e7, 1e5, 0}, {kFar, 0, 0}, kSun, kEarth, 0.0) == 1.0);  // between Earth and Sun
  CHECK(visible_share({-1e7, 0, 0}, {kFar, 0, 0}, kSun, kEarth, 0.0) == 0.0);   // right behind
  // Beyond the umbra's tip the Earth covers a ring's middle: the ratio of the two disks.
  const double far = 2.5e9, ratio = std::pow(kEarth / far / (kSun / (kFar + far)), 2.0);
  CHECK(visible_share({-far, 0, 0}, {kFar, 0, 0}, kSun, kEarth, 0.0) == doctest::Approx(1.0 - ratio).epsilon(1e-3));
}

TEST_CASE("shadow: an ellipsoid, by rays to points of the disk") {
  constexpr double kSun = 6.957e8, kA = 6378137.0, kF = 0.1;  // flatter than the Earth, so that it shows
  const Vec3 sun = 1.496e11 * glm::normalize(Vec3(1.0, 0.2, 0.35));
  const Vec3 d = glm::normalize(sun), up = glm::normalize(Vec3(0, 0, 1) - d.z * d), side = glm::cross(d, up);
  int partial = 0;
  for (double turn = 0.0; turn < 6.2; turn += 0.7) {
    for (double out = 0.86; out < 1.06; out += 0.01) {
      const Vec3 place = -9e6 * d + kA * out * (std::cos(turn) * up + std::sin(turn) * side);
      const Vec3 s = sun - place, e = glm::normalize(s);
      const Vec3 u = glm::normalize(glm::cross(e, Vec3(0.1, 0.9, 0.4))), v = glm::cross(e, u);
      // Sunflower's points fill the disk evenly; a ray is dark if it comes within the ellipsoid, by its nearest point
      // in the space in which that is a sphere.
      int dark = 0;
      constexpr int kPoints = 4000;
      for (int i = 0; i < kPoints; ++i) {
        const double r = kSun * std::sqrt((i + 0.5) / kPoints), phi = i * 2.399963229728653;
        Vec3 ray = s + r * (std::cos(phi) * u + std::sin(phi) * v), p = place;
        ray.z /= 1.0 - kF;
        p.z /= 1.0 - kF;
        ray = glm::normalize(ray);
        const double along = -glm::dot(p, ray);
        dark += along > 0.0 && glm::length(p + along * ray) < kA;
      }
      const double expected = 1.0 - static_cast<double>(dark) / kPoints;
      partial += dark > 0 && dark < kPoints;
      CAPTURE(turn);
      CAPTURE(out);
      CHECK(std::fabs(visible_share(place, sun, kSun, kA, kF) - expected) < 3e-3);  // of 4000 points along an edge
    }
  }
  CHECK(partial > 5);
}
