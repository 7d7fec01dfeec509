// SPDX-License-Identifier: Apache-2.0
// OEM and AEM files, written here to the grammar of the books (502.0-B-3 section 5, 504.0-B-1 section 4, 504.0-B-2
// section 5), against the motions that they were made from; every fault with its line.
#include <doctest/doctest.h>

#include <glm/gtc/quaternion.hpp>

#include "clray/error.hpp"
#include "ephemeris/aem.hpp"
#include "ephemeris/oem.hpp"
#include "unit/ephemeris_support.hpp"

using namespace clray;
using namespace clray::ephemeris;
using clray::test::Folder;
using clray::test::orbit;
using clray::test::orbit_velocity;

namespace {

constexpr double kPi = 3.14159265358979323846;

std::string time_text(int seconds) {
  return fmt::format("2026-11-25T18:{:02}:{:02}.000", seconds / 60, seconds % 60);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// A block of states every `step` seconds from `first` to `last`.
std::string oem_block(int first, int last, int step, const std::string& more = "", const std::string& scale = "UTC") {
  std::string text =
      "META_START\nOBJECT_NAME = TEST SAT\nOBJECT_ID = 1998-999A\nCENTER_NAME = EARTH\nREF_FRAME = EME2000\n"
      "TIME_SYSTEM = " +
      scale + "\nSTART_TIME = " + time_text(first) + "\nSTOP_TIME = " + time_text(last) + "\n" + more + "META_STOP\n\n";
  for (int s = first; s <= last; s += step) {
    const Vec3 p = orbit(s) / 1e3, v = orbit_velocity(s) / 1e3;
    text +=
        fmt::format("{} {:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f}\n", time_text(s), p.x, p.y, p.z, v.x, v.y, v.z);
  }
  return text;
}

const std::string kOemHead =
    "CCSDS_OEM_VERS = 2.0\nCOMMENT a comment with = in it\nCREATION_DATE = 2026-11-25T00:00:00\nORIGINATOR = CLR\n\n";
const std::string kHermite = "INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n";
const std::string kLagrange = "INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 9\n";

void check_refused(const std::string& text, const std::string& words, bool attitude = false) {
  const Folder folder;
  const std::string file = folder.write("bad", text);
  CAPTURE(words);
  if (attitude) {
    CHECK_THROWS_WITH_AS(read_aem(file), doctest::Contains(words.c_str()), Error);
  } else {
    CHECK_THROWS_WITH_AS(read_oem(file), doctest::Contains(words.c_str()), Error);
  }
}

/// The largest error of position between two times, and of velocity.
std::pair<double, double> worst_of(const Trajectory& t, double from, double to) {
  std::pair<double, double> worst{0.0, 0.0};
  for (double s = from; s <= to; s += 0.7) {
    const Motion3 m = t.at(s);
    worst.first = std::max(worst.first, glm::length(m.value - orbit(s)));
    worst.second = std::max(worst.second, glm::length(m.rate - orbit_velocity(s)));
  }
  return worst;
}

}  // namespace

TEST_CASE("OEM: records as written, and between them as the interpolation's error says") {
  const Folder folder;
  for (const std::string& method : {kHermite, kLagrange, std::string()}) {
    const Trajectory t = read_oem(folder.write("orbit.oem", kOemHead + oem_block(0, 1800, 60, method)));
    CHECK(t.frame == Frame::eme2000);
    CHECK(t.object == "TEST SAT");
    CHECK(iso_text(t.zero) == "2026-11-25T18:00:00.000Z");
    for (int s = 0; s <= 1800; s += 60) CHECK(glm::length(t.at(s).value - orbit(s)) < 2e-6);  // as rounded in the file
    // The polynomial's own error is at most a (w h)^n |x (x - 1) ... | / n! with n = 8 (Hermite's points count twice)
    // or 10 and w h = 0.065: below 1e-7 m in the middle and 3e-7 m at the ends. The file's rounding to 5e-7 m is
    // magnified by up to 3 there, and by up to 30 (the Lebesgue constant of 10 even points) at the ends.
    const auto [middle, middle_rate] = worst_of(t, 300.0, 1500.0);
    const auto [ends, ends_rate] = worst_of(t, 0.0, 1800.0);
    CHECK(middle < 2e-6);
    CHECK(middle_rate < 2e-7);
    CHECK(ends < 2e-5);
    CHECK(ends_rate < 2e-6);
  }
}

TEST_CASE("OEM: a withheld record of a dense orbit comes back") {
  const Folder folder;
  std::string text = kOemHead + oem_block(0, 600, 30, kLagrange);
  const std::string line =
      text.substr(text.find(time_text(300)), text.find(time_text(330)) - text.find(time_text(300)));
  const Trajectory t = read_oem(folder.write("gap.oem", replaced(text, line, "")));
  // The polynomial's own error is below 1e-9 m here; the file's rounding to 5e-7 m is magnified by the gap.
  CHECK(glm::length(t.at(300.0).value - orbit(300.0)) < 3e-6);
}

TEST_CASE("OEM: blocks, usable times, covariances, versions and time systems") {
  const Folder folder;
  const std::string covariance =
      "COVARIANCE_START\nEPOCH = 2026-11-25T18:10:00\nCOV_REF_FRAME = RTN\n1.0\n0.0 1.0\n0 0 1\n0 0 0 1\n0 0 0 0 1\n"
      "0 0 0 0 0 1\nCOVARIANCE_STOP\n";
  const std::string text =
      replaced(kOemHead, "2.0", "3.0") +
      oem_block(0, 600, 60,
                "USEABLE_START_TIME = " + time_text(60) + "\nUSEABLE_STOP_TIME = " + time_text(540) + "\n" + kHermite) +
      covariance + oem_block(600, 1200, 60, kLagrange);
  const Trajectory t = read_oem(folder.write("two.oem", text));
  REQUIRE(t.segments.size() == 2);
  CHECK(t.segment_at(59.9) == nullptr);
  CHECK(t.segment_at(60.0) == &t.segments[0]);
  CHECK(t.segment_at(540.0) == &t.segments[0]);
  CHECK(t.segment_at(570.0) == nullptr);
  CHECK(t.segment_at(600.0) == &t.segments[1]);
  CHECK_THROWS_WITH_AS(t.at(570.0), doctest::Contains("2026-11-25T18:09:30.000Z is outside the ephemeris"), Error);
  const std::pair<const char*, double> scales[] = {{"TAI", 37.0}, {"TT", 69.184}, {"GPS", 18.0}};
  for (const auto& [scale, ahead] : scales) {
    const Trajectory shifted = read_oem(folder.write("scale.oem", kOemHead + oem_block(0, 600, 60, "", scale)));
    CHECK(seconds_between(shifted.zero, {61369, 18 * 3600 * kPicosecondsPerSecond}) == doctest::Approx(ahead));
  }
  for (const char* frame : {"ITRF2014", "ITRF-97", "ITRF", "WGS84"}) {
    const std::string fixed = replaced(kOemHead + oem_block(0, 600, 60), "EME2000", frame);
    CHECK(read_oem(folder.write("frame.oem", fixed)).frame == Frame::itrf);
  }
  std::string day_of_year = kOemHead + oem_block(0, 600, 60);
  for (std::size_t at; (at = day_of_year.find("2026-11-25T18")) != std::string::npos;)
    day_of_year.replace(at, 13, "2026-329T18");
  CHECK(read_oem(folder.write("day.oem", day_of_year)).zero.mjd == 61369);
}

TEST_CASE("OEM: a line of nothing but white space is empty, whichever white space it is") {
  const Folder folder;
  for (const char* line : {"\v", "\f", " \t\v\f\r"}) {
    const std::string text =
        std::string(line) + "\n" + replaced(kOemHead, "ORIGINATOR", std::string(line) + "\nORIGINATOR");
    CHECK(read_oem(folder.write("spaces", text + oem_block(0, 600, 60, kHermite))).segments.size() == 1);
  }
}

TEST_CASE("OEM: faults with their line") {
  const std::string good = kOemHead + oem_block(0, 600, 60, kHermite);
  check_refused("", "expected CCSDS_OEM_VERS");
  check_refused(replaced(good, "2.0", "4.0"), "bad:1: CCSDS_OEM_VERS is \"4.0\"; expected 1.0 to 3.0");
  check_refused(replaced(good, "ORIGINATOR", "ORIGINATR"),
                "bad:4: \"ORIGINATR\"; expected one of CREATION_DATE, ORIGINATOR");
  check_refused(replaced(good, "CENTER_NAME = EARTH", "CENTER_NAME = MARS"),
                "bad:9: CENTER_NAME is MARS; expected EARTH");
  check_refused(replaced(good, "EME2000", "RTN"), "bad:10: REF_FRAME is RTN; expected one of EME2000");
  check_refused(replaced(good, "= UTC", "= UT1"), "bad:11: TIME_SYSTEM is UT1, which needs");
  check_refused(replaced(good, "= UTC", "= MET"), "bad:11: TIME_SYSTEM is MET; expected one of UTC");
  check_refused(replaced(good, "TIME_SYSTEM = UTC\n", ""), "the metadata lack TIME_SYSTEM");
  check_refused(replaced(good, "HERMITE", "SPLINE"), "bad:14: INTERPOLATION is SPLINE; expected LAGRANGE");
  check_refused(replaced(good, "DEGREE = 7", "DEGREE = 70"), "INTERPOLATION_DEGREE is \"70\"; expected a whole number");
  check_refused(replaced(good, "OBJECT_ID", "OBJEKT_ID"),
                "bad:8: \"OBJEKT_ID\"; expected META_STOP or one of OBJECT_NAME");
  check_refused(replaced(good, "META_STOP\n", ""), "expected META_STOP or one of");
  check_refused(replaced(good, time_text(120) + " ", time_text(30) + " "), "expected increasing epochs");
  check_refused(replaced(good, time_text(120) + " ", "2026-11-25T18:61:00 "),
                "bad:20: the epoch is \"2026-11-25T18:61:00\"");
  check_refused(replaced(good, time_text(120) + " ", time_text(120) + " 1 "), "bad:20: a row of 8 words");
  check_refused(replaced(good, time_text(120) + " ", time_text(120) + " x"), "a coordinate is \"x");
  check_refused(good + "COVARIANCE_START\n1\n", "the file ends; expected COVARIANCE_STOP");
  check_refused(good + "EPOCH = 3\n", "\"EPOCH\"; expected a state");
  check_refused(kOemHead + oem_block(0, 0, 60), "a block of 1 states; expected at least 2");
  check_refused(good + replaced(oem_block(600, 900, 60), "1998-999A", "1998-888A"), "OBJECT_ID differs from 1998-999A");
  check_refused(good + replaced(oem_block(600, 900, 60), "EME2000", "ICRF"), "REF_FRAME differs");
  check_refused(kOemHead + oem_block(0, 600, 60, "USEABLE_STOP_TIME = " + time_text(700) + "\n"),
                "bad:14: USEABLE_STOP_TIME lies behind the last row");
}

namespace {

/// A turn of 3 degrees a minute about an axis that is none of the frame's, from another attitude.
Quaternion turning(double t) {
  return glm::angleAxis(0.4 + t / 60.0 * kPi / 60.0, glm::normalize(Vec3(1, 2, 2))) *
         glm::angleAxis(0.7, glm::normalize(Vec3(0, 1, -1)));
}

std::string aem_head(const std::string& version, const std::string& more, const std::string& a = "EME2000",
                     const std::string& b = "SC_BODY_1") {
  return "CCSDS_AEM_VERS = " + version +
         "\nCREATION_DATE = 2026-11-25T00:00:00\nORIGINATOR = CLR\nMETA_START\nOBJECT_NAME = TEST\nOBJECT_ID = "
         "1998-999A\n"
         "CENTER_NAME = EARTH\nREF_FRAME_A = " +
         a + "\nREF_FRAME_B = " + b + "\nTIME_SYSTEM = UTC\nSTART_TIME = " + time_text(0) +
         "\nSTOP_TIME = " + time_text(600) + "\n" + more + "META_STOP\nDATA_START\n";
}

using Row = std::function<std::string(double)>;
std::string aem_rows(const Row& row) {
  std::string text;
  for (int s = 0; s <= 600; s += 60) text += time_text(s) + " " + row(s) + "\n";
  return text + "DATA_STOP\n";
}

/// The largest angle between a file's attitudes and `truth`.
double worst_angle(const std::string& text, const std::function<Quaternion(double)>& truth) {
  const Folder folder;
  const AttitudeTable table = read_aem(folder.write("a.aem", text));
  double worst = 0.0;
  for (double t = 0.0; t <= 600.0; t += 7.0) {
    const Quaternion q = glm::conjugate(truth(t)) * table.at(t);
    worst = std::max(worst, 2.0 * std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z));
  }
  return worst;
}

std::string first(const Quaternion& q) {
  return fmt::format("{:.15f} {:.15f} {:.15f} {:.15f}", q.w, q.x, q.y, q.z);
}
std::string last(const Quaternion& q) {
  return fmt::format("{:.15f} {:.15f} {:.15f} {:.15f}", q.x, q.y, q.z, q.w);
}

}  // namespace

TEST_CASE("AEM: quaternions of either order, direction and version") {
  // A turn at an even rate about one axis is what slerp gives, so only rounding is left.
  const std::string q = "ATTITUDE_TYPE = QUATERNION\n";
  const auto straight = [&](double t) { return first(turning(t)); };
  const auto back = [&](double t) { return last(glm::conjugate(turning(t))); };
  CHECK(worst_angle(aem_head("1.0", "ATTITUDE_DIR = A2B\n" + q + "QUATERNION_TYPE = FIRST\n") + aem_rows(straight),
                    turning) < 1e-12);
  CHECK(worst_angle(aem_head("1.0", "ATTITUDE_DIR = B2A\n" + q + "QUATERNION_TYPE = LAST\n") + aem_rows(back),
                    turning) < 1e-12);
  CHECK(worst_angle(aem_head("1.0", "ATTITUDE_DIR = A2B\n" + q + "QUATERNION_TYPE = LAST\n", "SC_BODY_1", "ICRF") +
                        aem_rows(back),
                    turning) < 1e-12);
  CHECK(worst_angle(aem_head("2.0", q) + aem_rows([](double t) { return last(turning(t)); }), turning) < 1e-12);
  CHECK(worst_angle(aem_head("2.0",
                             "ATTITUDE_TYPE = QUATERNION/ANGVEL\nANGVEL_FRAME = SC_BODY_1\n"
                             "INTERPOLATION_METHOD = LAGRANGE\nINTERPOLATION_DEGREE = 5\n") +
                        aem_rows([](double t) { return last(turning(t)) + " 0.1 0.2 0.3"; }),
                    turning) < 1e-10);
}

TEST_CASE("AEM: Euler angles as one turn after another, and a spin") {
  // Frame turned about its z by 10 t, then about its new x by 20 degrees, then about its new z: v_A = R1 R2 R3 v_B.
  const auto angles = [](double t) { return std::array<double, 3>{10.0 + t / 60.0, 20.0, -30.0}; };
  const auto zxz = [&](double t) {
    const auto a = angles(t);
    const Vec3 x(1, 0, 0), z(0, 0, 1);
    return glm::angleAxis(a[0] * kPi / 180.0, z) * glm::angleAxis(a[1] * kPi / 180.0, x) *
           glm::angleAxis(a[2] * kPi / 180.0, z);
  };
  const auto row = [&](double t) { return fmt::format("{} {} {}", angles(t)[0], angles(t)[1], angles(t)[2]); };
  const std::string euler = "ATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = ";
  CHECK(worst_angle(aem_head("1.0", "ATTITUDE_DIR = A2B\n" + euler + "313\n") + aem_rows(row), zxz) < 1e-12);
  CHECK(worst_angle(aem_head("2.0", euler + "ZXZ\n") + aem_rows(row), zxz) < 1e-12);
  // Its +z points to right ascension 40, declination 25 degrees, and it turns 7 times between two rows.
  const auto spin = [](double t) {
    const Vec3 y(0, 1, 0), z(0, 0, 1);
    return glm::angleAxis(40.0 * kPi / 180.0, z) * glm::angleAxis(65.0 * kPi / 180.0, y) *
           glm::angleAxis((5.0 + 43.0 * t) * kPi / 180.0, z);
  };
  const std::string text = aem_head("1.0", "ATTITUDE_DIR = A2B\nATTITUDE_TYPE = SPIN\n") + aem_rows([](double t) {
                             return fmt::format("40 25 {} 43", std::fmod(5.0 + 43.0 * t, 360.0));
                           });
  CHECK(worst_angle(text, spin) < 1e-10);
  const Vec3 axis = spin(17.0) * Vec3(0, 0, 1);
  CHECK(std::atan2(axis.y, axis.x) == doctest::Approx(40.0 * kPi / 180.0));
  CHECK(std::asin(axis.z) == doctest::Approx(25.0 * kPi / 180.0));
}

TEST_CASE("AEM: faults with their line") {
  const std::string meta = "ATTITUDE_DIR = A2B\nATTITUDE_TYPE = QUATERNION\nQUATERNION_TYPE = FIRST\n";
  const std::string good = aem_head("1.0", meta) + aem_rows([](double t) { return first(turning(t)); });
  const auto refused = [](const std::string& text, const std::string& words) { check_refused(text, words, true); };
  refused(replaced(good, "= 1.0", "= 3.0"), "bad:1: CCSDS_AEM_VERS is \"3.0\"; expected 1.0 to 2.0");
  refused(replaced(good, "SC_BODY_1", "ICRF"), "bad:9: REF_FRAME_B is ICRF and REF_FRAME_A EME2000; expected the body");
  refused(replaced(good, "EME2000", "MARS_FIXED"), "bad:8: REF_FRAME_A is MARS_FIXED; expected one of");
  refused(replaced(good, "A2B", "A2C"), "bad:13: ATTITUDE_DIR is A2C; expected A2B or B2A");
  refused(replaced(good, "ATTITUDE_DIR = A2B\n", ""), "the metadata lack ATTITUDE_DIR");
  refused(replaced(good, "QUATERNION_TYPE = FIRST\n", ""), "the metadata lack QUATERNION_TYPE");
  refused(replaced(good, "= QUATERNION\n", "= RODRIGUES\n"), "bad:14: ATTITUDE_TYPE is RODRIGUES; expected QUATERNION");
  refused(replaced(good, "DATA_START", "DATA_BEGIN"), "bad:17: expected DATA_START");
  refused(replaced(good, "DATA_STOP\n", ""), "the file ends; expected DATA_STOP");
  refused(replaced(good, time_text(60) + " ", time_text(60) + " 1 "), "bad:19: a row of 6 words; expected epoch and 4");
  refused(replaced(good, time_text(60) + " ", time_text(60) + " 1"), "a quaternion of length");
  refused(replaced(good, time_text(60) + " ", time_text(0) + " "), "expected increasing epochs");
  refused(good + "META_STOP\n", "\"META_STOP\"; expected META_START");
  refused(aem_head("1.0", "ATTITUDE_DIR = A2B\nATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = 331\n") +
              aem_rows([](double) { return "1 2 3"; }),
          "EULER_ROT_SEQ is 331; expected three axes");
}
