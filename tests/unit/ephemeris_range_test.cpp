// SPDX-License-Identifier: Apache-2.0
// CPF predictions against an analytic circular orbit, what their strict reader refuses, ranges from tables, and dates.
#include <doctest/doctest.h>

#include "clray/error.hpp"
#include "ephemeris/range.hpp"
#include "unit/ephemeris_support.hpp"

using namespace clray;
using namespace clray::ephemeris;
using clray::test::Folder;
using clray::test::orbit;

namespace {

constexpr int kStep_s = 60;

std::string cpf_text(int records, const std::function<std::string(int)>& change = {}) {
  std::string text =
      "H1 CPF  2  CLR 2023 11 23  2  327 01 testsat    notes\n"
      "H2  7603901 1155     8820 2023 11 22 23 50  0 2023 11 23 23 55  0    60 1 1  0 0 0  1\nH9\n";
  for (int i = 0; i < records; ++i) {
    const int second = 85800 + i * kStep_s;
    const Vec3 p = orbit(i * kStep_s);
    std::string line = fmt::format("10 0 {} {:13.6f}  0 {:19.6f} {:19.6f} {:19.6f}\n", 60270 + second / 86400,
                                   static_cast<double>(second % 86400), p.x, p.y, p.z);
    if (change) line = change(i).empty() ? line : change(i);
    if (line != "-\n") text += line;
  }
  return text + "99\n";
}

void check_refused(const std::string& text, const std::string& words) {
  const Folder folder;
  const std::string file = folder.write("bad.cpf", text);
  CAPTURE(words);
  CHECK_THROWS_WITH_AS(read_cpf(file), doctest::Contains(words.c_str()), Error);
}

}  // namespace

TEST_CASE("CPF: interpolation and light time on a circular orbit to 1 mm") {
  const Folder folder;
  const Trajectory p = read_cpf(folder.write("orbit.cpf", cpf_text(60)));
  CHECK(p.prediction->target == "testsat");
  CHECK(p.prediction->norad == "8820");
  CHECK(p.frame == Frame::itrf);
  CHECK(p.zero.mjd == 60270);
  CHECK(p.last_s() == 59 * kStep_s);
  double worst = 0.0, worst_distance = 0.0;
  const Vec3 station(6.378e6, 1.0e5, -2.0e5);
  Station there;
  there.cpf_file = p.path;
  there.position_m = station;
  const RangeModel ranges(there);
  for (double t = 0.0; t < 59.0 * kStep_s - 1.0; t += 1.7) {
    worst = std::max(worst, glm::length(p.at(t).value - orbit(t)));
    // Light time by bisection, apart from the code's iteration.
    double low = 0.0, high = 0.1;
    for (int i = 0; i < 80; ++i) {
      const double tau = 0.5 * (low + high);
      (glm::length(orbit(t + tau) - station) > 299792458.0 * tau ? low : high) = tau;
    }
    worst_distance = std::max(worst_distance, std::fabs(ranges.range_m(t) - 299792458.0 * low));
  }
  CHECK(worst < 1e-3);
  CHECK(worst_distance < 1e-3);
  MESSAGE("largest error of position " << worst << " m, of distance " << worst_distance << " m");
  for (int i = 0; i < 60; ++i) CHECK(glm::length(p.at(i * kStep_s).value - orbit(i * kStep_s)) < 1e-6);  // as written
}

TEST_CASE("CPF: epochs outside the table, ranges of a session") {
  const Folder folder;
  Station station;
  station.cpf_file = folder.write("orbit.cpf", cpf_text(60));
  CHECK_THROWS_WITH_AS(RangeModel{station}, doctest::Contains("station.position_m"), Error);
  station.position_m = Vec3(6.378e6, 0.0, 0.0);
  const RangeModel from_start(station);
  CHECK(from_start.zero().mjd == 60270);
  CHECK(from_start.range_m(600.0) == doctest::Approx(glm::length(orbit(600.0) - station.position_m)).epsilon(1e-4));
  CHECK_THROWS_WITH_AS(from_start.range_m(-1.0), doctest::Contains("outside the ephemeris"), Error);
  CHECK_THROWS_WITH_AS(from_start.range_m(59.0 * kStep_s), doctest::Contains("outside the ephemeris"),
                       Error);  // light time
  station.start_mjd = 60271.0;  // 600 s after the first record
  CHECK(RangeModel(station).range_m(0.0) == doctest::Approx(from_start.range_m(600.0)).epsilon(1e-12));
  station.start_mjd = 60272.0;
  CHECK_THROWS_WITH_AS(RangeModel(station).range_m(0.0), doctest::Contains("outside the ephemeris"), Error);
}

TEST_CASE("CPF: bad files are refused with their line") {
  const auto line = [](int at, const char* text) {
    return [=](int i) { return i == at ? std::string(text) + "\n" : std::string(); };
  };
  check_refused(cpf_text(20, line(5, "-")), "bad.cpf:9: epoch 120 s after the one before; the header says 60 s: a gap");
  check_refused(cpf_text(20, line(5, "10 0 60270 85000.0 0 1 2 3")),
                "bad.cpf:9: epoch -1040 s after the one before; expected increasing");
  check_refused(cpf_text(20, line(5, "10 0 60270 86100.0 0 1 2")), "bad.cpf:9: record 10 has 7 fields; expected 8");
  check_refused(cpf_text(20, line(5, "10 0 60270 86100.0 0 1 2 x3")),
                "bad.cpf:9: field 8 (Z) is \"x3\"; expected a number");
  check_refused(cpf_text(20, line(5, "10 0 60270 86100.0 0 1 2 nan")), "expected a number");
  check_refused(cpf_text(20, line(5, "10 1 60270 86100.0 0 1 2 3")), "direction flag");
  check_refused(cpf_text(20, line(5, "10 0 60270 86401.0 0 1 2 3")), "seconds of day");
  check_refused(cpf_text(20, line(5, "11 0 60270 86100.0 0 1 2 3")), "unknown record 11");
  check_refused(cpf_text(9), "9 positions (records 10); expected at least 10");
  std::string text = cpf_text(20);
  check_refused(text.substr(0, text.size() - 3), "ends without record 99");
  check_refused(text + "10 0 60270 0 0 1 2 3\n", "after record 99");
  check_refused(std::string(text).replace(8, 1, "3"), "bad.cpf:1: format version 3; expected 1 or 2");
  check_refused(std::string(text).replace(text.find("327"), 3, "6641"),
                "field 9 (sequence number of version 2) is \"6641\"; expected a whole number in [0..999]");
  check_refused(std::string(text).replace(text.find(" 0 0 0  1"), 9, " 0 0 0   "),
                "bad.cpf:2: record H2 has 22 fields; version 2 has 23");
  check_refused(std::string(text).replace(text.find(" 0 0 0  1"), 9, " 3 0 0  1"), "reference frame");
  check_refused("", "expected record H1");
  CHECK_THROWS_WITH_AS(read_cpf("/nowhere/at/all.cpf"), doctest::Contains("cannot be read"), Error);
}

TEST_CASE("CPF: version 1, free notes, blank lines and lower case, as archives have them") {
  const Folder folder;
  const std::string two = cpf_text(20);
  std::string one = two;
  one.replace(0, one.find("H9"),
              "h1 cpf  1  clr 2005 11 23 11  8271 testsat    notes of several words\n\n"
              "H2  7603901 1155     8820 2023 11 22 23 50  0 2023 11 23 23 55  0    60 1 1  0 0 0\n");
  one.insert(one.find("10 0"), "00 a comment\n\n");
  one += "\n\n";
  const Trajectory a = read_cpf(folder.write("one.cpf", one)), b = read_cpf(folder.write("two.cpf", two));
  CHECK(a.prediction->version == 1);
  CHECK(a.prediction->sequence == 8271);
  CHECK(a.prediction->target == "testsat");
  for (double t = 0.0; t < 19.0 * kStep_s; t += 13.0) CHECK(a.at(t).value == b.at(t).value);
  std::string celestial = two;
  celestial.replace(celestial.find(" 0 0 0  1"), 9, " 1 0 0  1");
  CHECK(read_cpf(folder.write("tod.cpf", celestial)).frame == Frame::tod);
  Station station;
  station.position_m = Vec3(6.378e6, 0.0, 0.0);
  station.cpf_file = folder.write("tod.cpf", celestial);
  CHECK_THROWS_WITH_AS(RangeModel{station}, doctest::Contains("not Earth-fixed"), Error);
}

TEST_CASE("CPF: a leap second, with the flag of the format and without") {
  // 2016-12-31 ended with a leap second; the orbit goes on evenly through it.
  const Folder folder;
  for (const bool flagged : {false, true}) {
    std::string text =
        "H1 CPF  2  CLR 2016 12 31  2  366 01 testsat\n"
        "H2  7603901 1155     8820 2016 12 31 23 50  0 2017 1 1 0 30  0    60 1 1  0 0 0  1\nH9\n";
    for (int i = 0; i < 30; ++i) {
      const double since = 60.0 * i, of_day = 86400.0 - 600.0 + since;
      const bool behind = of_day >= 86401.0;
      const double second = !behind ? of_day : flagged ? of_day - 86400.0 : of_day - 86401.0;
      const Vec3 p = orbit(since);
      text += fmt::format("10 0 {} {:.6f} {} {:.6f} {:.6f} {:.6f}\n", behind ? 57754 : 57753, second,
                          behind && flagged ? 1 : 0, p.x, p.y, p.z);
    }
    const Trajectory t = read_cpf(folder.write("leap.cpf", text + "99\n"));
    CHECK(t.last_s() == doctest::Approx(29.0 * 60.0).epsilon(1e-12));
    // 0h of 2017 is 601 s behind the first record.
    CHECK(glm::length(t.at(t.since({57754, 0})).value - orbit(601.0)) < 1e-3);
  }
}

TEST_CASE("ranges: fixed and from a table") {
  Station station;
  station.range_m = -1.0;
  CHECK_THROWS_WITH_AS(RangeModel{station}, doctest::Contains("station.range_m: is -1"), Error);
  station.range_m = 1e6;
  CHECK(RangeModel(station).range_m(123.0) == 1e6);
  for (int i = 0; i < 30; ++i) station.ranges.emplace_back(i * 2.0, 1e6 + 300.0 * i + 5.0 * i * i - 0.25 * i * i * i);
  const RangeModel cubic(station);
  for (double t = 0.0; t <= 58.0; t += 0.37) {  // a cubic is interpolated exactly
    const double i = t / 2.0;
    CHECK(cubic.range_m(t) == doctest::Approx(1e6 + 300.0 * i + 5.0 * i * i - 0.25 * i * i * i).epsilon(1e-13));
  }
  CHECK_THROWS_WITH_AS(cubic.range_m(58.1), doctest::Contains("outside the table"), Error);
  station.ranges = {{0.0, 1e6}, {1.0, 2e6}};
  CHECK(RangeModel(station).range_m(0.25) == doctest::Approx(1.25e6).epsilon(1e-14));
  station.ranges = {{0.0, 1e6}, {0.0, 2e6}};
  CHECK_THROWS_WITH_AS(RangeModel{station}, doctest::Contains("row 2: time does not increase"), Error);
  station.ranges = {{0.0, 1e6}, {1.0, -2e6}};
  CHECK_THROWS_WITH_AS(RangeModel{station}, doctest::Contains("row 2: range is -2000000"), Error);
}
