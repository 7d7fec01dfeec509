// SPDX-License-Identifier: Apache-2.0
// Columns of tables: found by name in any order and unit, or refused in words that name what was found and expected.
#include "scene/file/scene_csv.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "ephemeris/epoch.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::vector<CsvColumn> kRange = {{{"time", "t"}, "s"}, {{"range", "distance"}, "m"}};

/// The second value of the first row, whatever the order of columns.
double range_of(const SceneFolder& f, const std::string& text) {
  return read_csv(f.write("t.csv", text), kRange).rows.at(0).at(1);
}

std::string said(const SceneFolder& f, const std::string& text, CsvHeader header = CsvHeader::optional) {
  const std::string file = f.write("t.csv", text);
  try {
    read_csv(file, kRange, header);
  } catch (const Error& e) {
    return std::string(e.what()).substr(file.size());
  }
  return "fine";
}

}  // namespace

TEST_CASE("columns: by name, in any order, with their unit at the end of the name") {
  const SceneFolder f;
  CHECK(range_of(f, "time_s,range_m\n3,1e6\n") == 1e6);
  CHECK(range_of(f, "range_m,time_s\n1e6,3\n") == 1e6);
  CHECK(range_of(f, "time_s,range_km\n3,1000.1\n") == 1000.1 * 1000.0);
  CHECK(range_of(f, "T_ms, Distance [km]\n3,1\n") == 1e3);
  CHECK(range_of(f, "\"time (s)\",\"Range (km)\"\n3,1\n") == 1e3);
  CHECK(range_of(f, "\xEF\xBB\xBF# a comment, of two parts\n\ntime_s,range_mm\n3,1\n") == 1.0 / 1e3);
  CHECK(read_csv(f.write("t.csv", "time_min,range_m\n3,1\n"), kRange).rows[0][0] == 180.0);
  CHECK(read_csv(f.write("t.csv", "time_us,range_m\n3,1\n"), kRange).rows[0][0] == 3.0 / 1e6);
  // Without names: the order and the units asked for.
  CHECK(range_of(f, "3,1e6\n") == 1e6);
  // Names in a comment above the first row, as numpy.savetxt writes them.
  CHECK(range_of(f, "# time_s,range_km\n3,1\n") == 1e3);
  CHECK(range_of(f, "# range_m,time_s\n# by hand\n1e6,3\n") == 1e6);
  CHECK(range_of(f, "# of the pass, in metres\n3,1e6\n") == 1e6);  // no names
}

TEST_CASE("columns: what is not understood is refused, with what was found and what was expected") {
  const SceneFolder f;
  const std::string expected =
      "; expected time_s (or ms, us, ns, ps, min, h, d), range_m (or km, cm, mm, um, nm, angstrom, pm), in any order";
  CHECK(said(f, "time_s,height_m\n3,1\n") == ":1: columns time_s,height_m: 'height_m' is none of them" + expected);
  CHECK(said(f, "time_s,range_mi\n3,1\n") == ":1: columns time_s,range_mi: 'range_mi' is none of them" + expected);
  CHECK(said(f, "time_s,range\n3,1\n") == ":1: columns time_s,range: 'range' is none of them" + expected);
  CHECK(said(f, "time_s,range_s\n3,1\n") == ":1: columns time_s,range_s: 'range_s' is none of them" + expected);
  CHECK(said(f, "range_km,range_m\n3,1\n") ==
        ":1: columns range_km,range_m: 'range_km' and 'range_m' are the same" + expected);
  CHECK(said(f, "time_s\n3\n") == ":1: columns time_s: range_m is missing" + expected);
  CHECK(said(f, "time_s,range_m,elevation_deg\n3,1,4\n") ==
        ":1: columns time_s,range_m,elevation_deg: 'elevation_deg' is none of them" + expected);
  CHECK(said(f, "# time_s,range_mi\n3,1\n") == ":1: columns time_s,range_mi: 'range_mi' is none of them" + expected);
  CHECK(said(f, "time_s,range_m\n3,1,4\n") == ":2: expected 2 columns (time_s,range_m), found 3");
  CHECK(said(f, "time_s,range_m\ntime_s,range_m\n") == ":2: time_s: expected a finite number, found 'time_s'");
  CHECK(said(f, "3,1\n", CsvHeader::required) ==
        ":1: the columns have no names; expected a first line with time_s,range_m, in any order");
  CHECK(said(f, "inf,1\n") == ":1: time_s: expected a finite number, found 'inf'");
}

TEST_CASE("attitudes: the scalar stands where the header says; without one nobody knows") {
  const SceneFolder f;
  const double h = std::sqrt(0.5);
  const auto first = [&](const std::string& text) { return read_attitudes(f.write("a.csv", text)).at(0); };
  for (const char* text : {"time_s,qw,qx,qy,qz\n5,0.70710678118654752,0,0,0.70710678118654752\n",
                           "time_s,qx,qy,qz,qw\n5,0,0,0.70710678118654752,0.70710678118654752\n",
                           "qz,qw,time_ms,qy,qx\n0.70710678118654752,0.70710678118654752,5000,0,0\n",
                           "# time_s,qx,qy,qz,qw\n5,0,0,0.70710678118654752,0.70710678118654752\n"}) {
    CAPTURE(text);
    const Attitude a = first(text);
    CHECK(a.time_s == 5.0);
    CHECK(a.body_to_space.w == doctest::Approx(h).epsilon(1e-15));
    CHECK(a.body_to_space.z == doctest::Approx(h).epsilon(1e-15));
    CHECK(a.body_to_space.x == 0.0);
  }
  CHECK_THROWS_WITH_AS(first("5,1,0,0,0\n"), doctest::Contains("a.csv:1: the columns have no names"), Error);
  CHECK_THROWS_WITH_AS(first("time_s,q1,q2,q3,q4\n5,1,0,0,0\n"), doctest::Contains("'q1' is none of them"), Error);
}

TEST_CASE("spectra, filters and pulses: their units by name") {
  const SceneFolder f;
  const std::string ball =
      "[[material]]\nname = \"m\"\nmodel = \"lambert\"\nrho = \"rho.csv\"\n"
      "[[component]]\nshape = \"sphere\"\nmaterial = \"m\"\n";
  f.write("rho.csv", "wavelength_um,reflectance_percent\n0.4,10\n0.7,30\n");
  f.write("sun.csv", "wavelength_um,irradiance_W_m2_um\n0.3,1500\n0.8,1500\n");
  f.write("V.csv", "wavelength_angstrom,transmission_percent\n4000,0\n5000,100\n6000,0\n");
  f.write("pulse.csv", "power,time_ns\n0,0\n1,0.5\n0,1\n");
  const std::string more = "[source]\nkind = \"sun\"\nspectrum = \"sun.csv\"\nbands = [\"V.csv\"]\n";
  const Scene s = f.load(ball + more);
  CHECK(s.materials[0].spectra.at("rho").wavelength_nm == std::vector<double>{400.0, 700.0});
  CHECK(s.materials[0].spectra.at("rho").value == std::vector<double>{0.1, 0.3});
  CHECK(s.source.spectrum->wavelength_nm == std::vector<double>{300.0, 800.0});
  CHECK(s.source.spectrum->value == std::vector<double>{1.5, 1.5});
  CHECK(s.source.bands[0].low_nm == 400.0);
  CHECK(s.source.bands[0].high_nm == 600.0);
  CHECK(s.source.bands[0].response->value == std::vector<double>{0.0, 1.0, 0.0});
  const Scene p = f.load(ball + "[station]\npulse = \"pulse.csv\"\n");
  CHECK(p.station->pulse[1].first == 0.5 * 1000.0 / 1e12);
  CHECK(p.station->pulse[1].second == 1.0);
  f.write("V.csv", "frequency_THz,transmission\n500,0\n600,1\n700,0\n");
  CHECK(f.complaint(ball + more).find("V.csv:1: columns frequency_THz,transmission: 'frequency_THz' is none of them") ==
        0);
  f.write("rho.csv", "wavelength_nm,absorptance\n400,0.1\n700,0.3\n");
  CHECK(f.complaint(ball).find("rho.csv:1: columns wavelength_nm,absorptance: 'absorptance' is none of them") == 0);
  f.write("rho.csv", "wavelength_nm,rho\n400,0.1\n700,0.3\n");
  CHECK(f.complaint(ball) == "fine");
}

TEST_CASE("tables by date: ISO 8601, MJD or seconds from a start, and columns that may be left out") {
  const SceneFolder f;
  Epoch start;
  REQUIRE(ephemeris::read_date("2016-12-31T23:59:50", &start));  // ten seconds and a leap second before midnight
  const auto rows = [&](const std::string& text) { return read_directions(f.write("d.csv", text), start); };
  const auto said = [&](const std::string& text) {
    try {
      rows(text);
    } catch (const Error& e) {
      return std::string(e.what()).substr(f.path("").size());
    }
    return std::string("fine");
  };
  for (const char* text :
       {"time_utc,x,y,z\n2016-12-31T23:59:55Z,0,0,2\n2017-01-01T00:00:01Z,0,3,0\n", "z,y,x,t_s\n2,0,0,5\n0,3,0,12\n",
        "# z,y,x,time_min\n2,0,0,0.08333333333333333\n0,3,0,0.2\n"}) {
    const std::vector<Directions::Row> found = rows(text);
    REQUIRE(found.size() == 2);
    CHECK(found[0].time_s == doctest::Approx(5.0));
    CHECK(found[1].time_s == doctest::Approx(12.0));
    CHECK(found[0].direction == Vec3(0, 0, 1));
    CHECK(found[1].direction == Vec3(0, 1, 0));
    CHECK(found[0].range_m == 0.0);
  }
  const std::vector<Directions::Row> ranged = rows("mjd,x,y,z,range_km\n57753.99994212962963,1,0,0,7\n");
  CHECK(ranged[0].time_s == doctest::Approx(5.0).epsilon(1e-9));
  CHECK(ranged[0].range_m == 7000.0);
  CHECK(said("time_utc,x,y,z\nyesterday,0,0,1\n") ==
        "d.csv:2: time_utc: expected a date such as 2026-11-25T18:02:00.5Z, found 'yesterday'");
  CHECK(said("mjd,x,y,z\n5e4,0,0,1\n") == "d.csv:2: mjd: expected a Modified Julian Date, found '5e4'");
  CHECK(said("mjd,x,y,z\n50000,0,0,0\n") == "d.csv:2: x,y,z: expected a direction, found the zero vector");
  CHECK(said("mjd,x,y,z,range_km\n50000,0,0,1\n").find("d.csv:2: expected 5 columns") == 0);
  CHECK(said("mjd,x,y\n50000,0,0\n").find("d.csv:1: columns mjd,x,y: z is missing") == 0);
  CHECK(said("0,0,0,1\n").find("d.csv:1: the columns have no names") == 0);
  CHECK(said("time_s,x,y,z\n0,0,0,1\n0,0,0,1\n").find("d.csv:3: time: must increase") == 0);
}

TEST_CASE("a BRDF grid whose size wraps to zero in 64 bits is refused") {
  if (std::getenv("CLRAY_LONG_TESTS") == nullptr) return;  // such a file has millions of rows and takes some seconds
  constexpr int kRows = 1 << 22;                           // 2^22 x 2^21 x 2^21 angles = 2^64 cells
  std::string text = "theta_i_deg,theta_o_deg,phi_deg,value\n";
  for (int i = 0; i < kRows; ++i) {
    const double other = static_cast<double>(i % (kRows / 2)) / (kRows / 2);
    text += fmt::format("{:.6f},{:.6f},{:.5f},1\n", 90.0 * i / kRows, 90.0 * other, 180.0 * other);
  }
  const SceneFolder f;
  try {
    read_brdf_table(f.write("wraps.csv", text));
    FAIL("no error");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::input);
    CHECK(e.message().find("no full grid") != std::string::npos);
  }
}

TEST_CASE("tabulated BRDFs: angles in radians, columns in any order") {
  const SceneFolder f;
  const BrdfTable degrees =
      read_brdf_table(f.write("d.csv", "theta_i_deg,theta_o_deg,phi_deg,value\n0,0,0,1\n90,0,0,2\n"));
  const BrdfTable radians =
      read_brdf_table(f.write("r.csv", "value,phi_rad,theta_o_rad,theta_i_rad\n1,0,0,0\n2,0,0,1.5707963267948966\n"));
  CHECK(radians.value == degrees.value);
  CHECK(radians.theta_i_rad[1] == doctest::Approx(degrees.theta_i_rad[1]).epsilon(1e-15));
}
