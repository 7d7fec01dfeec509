// SPDX-License-Identifier: Apache-2.0
// Normal points of made-up ranges whose trend, scatter and outliers are known; tests/readers/normal_points compares
// those of whole sessions with another implementation.
#include <doctest/doctest.h>

#include <cmath>

#include "slr/normal_points.hpp"

using namespace clray::slr;

namespace {

constexpr std::int64_t kSecond_ps = 1000000000000;

/// Ten ranges a second from 10 s before midnight, 50 ps above and below a line by turns.
std::vector<Observation> alternating(int count) {
  std::vector<Observation> all;
  for (int i = 0; i < count; ++i) {
    const std::int64_t ps = 86390 * kSecond_ps + i * (kSecond_ps / 10);
    Observation o;
    o.shot = static_cast<std::uint64_t>(7 * i);
    o.epoch = {60000 + ps / (86400 * kSecond_ps), ps % (86400 * kSecond_ps)};
    o.flight_ps = 6000000000 + 12345 * i;
    o.residual_ns = -3.0 + 0.02 * i + (i % 2 == 0 ? 0.05 : -0.05);
    all.push_back(o);
  }
  return all;
}

}  // namespace

TEST_CASE("normal points: bins begin with the day, outliers go, and each point is its nearest range less its scatter") {
  std::vector<Observation> ranges = alternating(200);
  for (const std::size_t i : {15u, 95u, 150u}) ranges[i].residual_ns += 20.0;
  const NormalPoints found = normal_points(ranges, 7.0);
  // 86387-86394, 86394-86400, 0-7 and 7-10 s; the means of the epochs are 1.95, 2.95, 3.45 and 1.45 s into the ranges
  // of each, up to what the outliers move.
  REQUIRE(found.points.size() == 4);
  const std::uint64_t counts[] = {39, 59, 69, 30};
  const int first[] = {0, 40, 100, 170}, all[] = {40, 60, 70, 30};
  for (std::size_t b = 0; b < 4; ++b) {
    const NormalPoint& p = found.points[b];
    CHECK(p.bin.count == counts[b]);
    CHECK(p.bin.rms_ps == doctest::Approx(50.0).epsilon(0.02));
    const auto i = static_cast<std::size_t>(p.shot / 7);
    CHECK(std::fabs(static_cast<double>(i) - (first[b] + 0.5 * (all[b] - 1))) <= 1.0);
    CHECK(p.epoch.mjd == ranges[i].epoch.mjd);
    CHECK(p.epoch.ps == ranges[i].epoch.ps);
    // The trend has nine terms over 200 ranges: it follows the scatter by less than a tenth.
    const double scatter_ps = i % 2 == 0 ? 50.0 : -50.0;
    CHECK(std::fabs(static_cast<double>(p.flight_ps - ranges[i].flight_ps) + scatter_ps) < 5.0);
  }
  CHECK(found.session.count == 197);
  CHECK(found.session.rms_ps == doctest::Approx(50.0).epsilon(0.02));
  CHECK(std::fabs(found.session.skewness) < 0.1);
  CHECK(found.session.kurtosis == doctest::Approx(-2.0).epsilon(0.05));  // of two values alike
}

TEST_CASE("normal points: of no range, of one, and of ranges that are all alike") {
  CHECK(normal_points({}, 5.0).points.empty());
  const NormalPoints one = normal_points(alternating(1), 5.0);
  REQUIRE(one.points.size() == 1);
  CHECK(one.points[0].flight_ps == 6000000000);
  CHECK(one.points[0].bin.count == 1);
  CHECK(one.points[0].bin.rms_ps == 0.0);
  CHECK(std::isnan(one.points[0].bin.skewness));
  std::vector<Observation> alike = alternating(100);
  for (Observation& o : alike) o.residual_ns = 1.0 / 3.0;
  const NormalPoints same = normal_points(alike, 86400.0);
  REQUIRE(same.points.size() == 1);  // the session ends before midnight
  CHECK(same.points[0].bin.count == 100);
  CHECK(same.points[0].bin.rms_ps < 1e-6);
  for (Observation& o : alike) o.epoch = alike.front().epoch;  // no time passes
  CHECK(normal_points(alike, 1.0).points.size() == 1);
}
