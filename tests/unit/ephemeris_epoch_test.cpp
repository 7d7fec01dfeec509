// SPDX-License-Identifier: Apache-2.0
// Dates, leap seconds and time scales against the published table of leap seconds and the scales' definitions; places
// on the Earth and their sky against the ellipsoid's own equation.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "ephemeris/epoch.hpp"
#include "ephemeris/site.hpp"

using namespace clray;
using namespace clray::ephemeris;

namespace {

constexpr double kPi = 3.14159265358979323846;

Epoch date(const char* text) {
  Epoch epoch;
  CAPTURE(text);
  REQUIRE(read_date(text, &epoch));
  return epoch;
}

}  // namespace

TEST_CASE("dates") {
  std::int64_t mjd = 0;
  CHECK(mjd_of(2000, 1, 1, &mjd));
  CHECK(mjd == 51544);
  CHECK(mjd_of(1858, 11, 17, &mjd));
  CHECK(mjd == 0);
  CHECK(mjd_of(2024, 2, 29, &mjd));
  CHECK(mjd == 60369);
  CHECK_FALSE(mjd_of(2023, 2, 29, &mjd));
  CHECK_FALSE(mjd_of(2023, 13, 1, &mjd));
  for (std::int64_t day = 40000; day < 80000; day += 17) {
    const Date d = date_of({day, 0});
    CHECK(mjd_of(d.year, d.month, d.day, &mjd));
    CHECK(mjd == day);
  }
  CHECK(normalised({10, -1}).mjd == 9);
  CHECK(normalised({10, -1}).ps == kPicosecondsPerDay - 1);
  CHECK(epoch_of(10, 86400.25).mjd == 11);
  CHECK(epoch_of(10, 86400.25).ps == kPicosecondsPerSecond / 4);
}

TEST_CASE("leap seconds: elapsed time, and the 61st second") {
  CHECK(leap_seconds(41317) == 10);  // 1972-01-01
  CHECK(leap_seconds(57753) == 36);  // 2016-12-31
  CHECK(leap_seconds(57754) == 37);
  CHECK(leap_seconds(70000) == 37);  // none is known there
  CHECK(seconds_between(date("2016-12-31T23:59:59"), date("2017-01-01T00:00:00")) == 2.0);
  CHECK(seconds_between(date("2015-12-31T23:59:59"), date("2016-01-01T00:00:00")) == 1.0);
  const Epoch leap = later(date("2016-12-31T23:59:59.5"), 1.0);
  CHECK(leap.mjd == 57753);
  CHECK(leap.ps == 86400 * kPicosecondsPerSecond + kPicosecondsPerSecond / 2);
  CHECK(iso_text(leap) == "2016-12-31T23:59:60.500Z");
  CHECK(date("2016-12-31T23:59:60.5").ps == leap.ps);
  CHECK(iso_text(later(leap, 0.5)) == "2017-01-01T00:00:00.000Z");
  CHECK(iso_text(later(date("2017-01-01"), -1.0)) == "2016-12-31T23:59:60.000Z");
  for (double s = -4e8; s < 4e8; s += 12345678.875) {  // there and back, over all leap seconds since 2012
    CHECK(seconds_between(date("2020-06-01T12:00:00"), later(date("2020-06-01T12:00:00"), s)) == s);
  }
}

TEST_CASE("time scales by their definitions") {
  const Epoch shown = date("2026-11-25T18:02:00.25");
  const auto behind = [&](TimeScale scale) { return seconds_between(utc_of(scale, shown), shown); };
  CHECK(behind(TimeScale::utc) == 0.0);
  CHECK(behind(TimeScale::tai) == 37.0);
  CHECK(behind(TimeScale::gps) == 18.0);
  CHECK(behind(TimeScale::tt) == doctest::Approx(69.184).epsilon(1e-14));
  // TDB - TT: 1.657 ms sin g of the Earth's mean anomaly (Astronomical Almanac), to 50 us.
  const double days = 61369.75 - 51544.5, g = (357.53 + 0.98560028 * days) * kPi / 180.0;
  CHECK(std::fabs(behind(TimeScale::tdb) - 69.184 - 0.001657 * std::sin(g)) < 50e-6);
  const TwoPartDate tt = tt_of(shown);
  CHECK((tt.day - 2461369.5) * 86400.0 + tt.rest * 86400.0 ==
        doctest::Approx(18 * 3600 + 120.25 + 69.184).epsilon(1e-12));
  TimeScale scale{};
  CHECK(time_scale_of("utc", &scale));
  CHECK_FALSE(time_scale_of("UT1", &scale));
}

TEST_CASE("dates are read as ISO 8601 and as MJD, to the picosecond") {
  CHECK(date("2026-11-25T18:02:00Z").mjd == 61369);
  CHECK(date("2026-329T18:02").ps == date("2026-11-25 18:02:00.0").ps);
  CHECK(date("2026-329").mjd == 61369);
  CHECK(date("2026-11-25T00:00:00.000000000001").ps == 1);
  Epoch e;
  for (const char* bad : {"", "2026", "2026-02-30", "2026-11-25T24:00:00", "2026-11-25T18:60:00", "2026-11-25T18:02:60",
                          "2026-366", "2026-11-25T18:02:00x", "2026-11-25T", "26-11-25", "2026-11-25T18:02:00."}) {
    CAPTURE(bad);
    const bool taken = read_date(bad, &e);
    CHECK((!taken || std::string(bad) == "2026-11-25T18:02:00."));  // a point without decimals does no harm
  }
  CHECK(read_mjd("61369.75", &e));
  CHECK(e.ps == kPicosecondsPerDay / 4 * 3);
  CHECK(read_mjd("61369", &e));
  CHECK_FALSE(read_mjd("61369,5", &e));
  CHECK_FALSE(read_mjd("-1", &e));
}

TEST_CASE("places on the ellipsoid, and their sky") {
  constexpr double kA = 6378137.0, kB = kA * (1.0 - 1.0 / 298.257223563);
  for (const double latitude : {-1.2, 0.0, 0.9, 1.57}) {
    const Vec3 p = place_of({latitude, 2.5, 0.0});
    CHECK((p.x * p.x + p.y * p.y) / (kA * kA) + p.z * p.z / (kB * kB) == doctest::Approx(1.0).epsilon(1e-14));
    const Vec3 high = place_of({latitude, 2.5, 1000.0});
    CHECK(glm::length(high - p) == doctest::Approx(1000.0).epsilon(1e-9));
    // Up is the gradient of the ellipsoid's equation.
    const Vec3 up = glm::normalize(Vec3(p.x / (kA * kA), p.y / (kA * kA), p.z / (kB * kB)));
    CHECK(sight_of(p, up).elevation_rad == doctest::Approx(0.5 * kPi).epsilon(1e-7));
    const Geodetic back = geodetic_of(high);
    CHECK(back.latitude_rad == doctest::Approx(latitude).epsilon(1e-12));
    CHECK(back.height_m == doctest::Approx(1000.0).epsilon(1e-6));
    // North is where latitude grows, east where longitude does.
    const double step = 1e-6;
    const Vec3 north = place_of({latitude + step, 2.5, 0.0}) - p, east = place_of({latitude, 2.5 + step, 0.0}) - p;
    if (latitude < 1.5) {
      CHECK(std::fabs(std::remainder(sight_of(p, north).azimuth_rad, 2.0 * kPi)) < 1e-6);
      CHECK(sight_of(p, east).azimuth_rad == doctest::Approx(0.5 * kPi).epsilon(1e-5));
      CHECK(std::fabs(sight_of(p, north).elevation_rad) < 1e-6);
    }
    const Sight s = sight_of(p, glm::normalize(up) + 0.5 * glm::normalize(east));
    CHECK(s.elevation_rad == doctest::Approx(std::atan2(1.0, 0.5)).epsilon(1e-5));
  }
}
