// SPDX-License-Identifier: Apache-2.0
// All five detectors from the command line: together in one run with every total to its target, light curves with
// magnitudes at a range, pictures of a bare mesh, maps of radiation force, and what is said to what cannot be done.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

constexpr double kPi = 3.14159265358979323846;
using Json = nlohmann::json;

Json summary(const Scratch& scratch, const std::string& folder) {
  return Json::parse(slurp(scratch / (folder + "/summary.json")));
}

/// A white Lambert sphere of 1 m under light of 1 W/m²/nm.
const char* const kSphere =
    "[[material]]\nname = \"white\"\nmodel = \"lambert\"\nrho = 1\n"
    "[[component]]\nshape = \"sphere\"\nmaterial = \"white\"\n"
    "[source]\nkind = \"sun\"\nspectrum = \"flat.csv\"\n";

void write_sphere(const Scratch& scratch, const std::string& bands, const std::string& more) {
  spit(scratch / "flat.csv", "300,1\n1000,1\n");
  spit(scratch / "V.csv", "# a triangle\n500,0\n550,1\n600,0\n");
  spit(scratch / "s.toml", std::string(kSphere) + "bands = " + bands + "\n" + more);
}

/// Rows of numbers of a CSV file below its '#' lines and its column names.
std::vector<std::vector<double>> rows_of(const std::string& file) {
  std::istringstream lines(slurp(file));
  std::vector<std::vector<double>> rows;
  bool named = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (!named) {
      named = true;
      continue;
    }
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::strtod(cell.c_str(), nullptr));
  }
  return rows;
}

}  // namespace

TEST_CASE("five detectors in one run, each with its error, every total to its target") {
  const Scratch scratch;
  write_sphere(scratch, R"([[400, 500], "V.csv"])",
               "[observer]\ndirection = [1, 0, 1]\nrange_m = 1e6\n"
               "[[detector]]\nkind = \"delay\"\n[[detector]]\nkind = \"spectrometer\"\n"
               "[[detector]]\nkind = \"pressure\"\nthermal = true\n"
               "[[detector]]\nkind = \"rgb\"\nwidth = 32\nheight = 24\nsamples = 16\n"
               "[[detector]]\nkind = \"hyperspectral\"\nwidth = 16\nheight = 16\nsamples = 16\n");
  const auto outcome = clray(scratch, {"--device", "cpu", "--target-error", "0.5%", "--out", "o", "s.toml"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  const Json result = summary(scratch, "o");
  for (const char* name : {"delay", "spectrometer", "pressure", "rgb", "hyperspectral"}) {
    CAPTURE(name);
    CHECK(result["detectors"].contains(name));
  }
  for (const char* name : {"delay.csv", "spectrum.csv", "pressure-V.csv", "rgb.png", "rgb.exr", "hyperspectral.fits"}) {
    CAPTURE(name);
    CHECK((scratch.has(std::string("o/") + name) || contains(name, "delay")));
  }
  // NASA's checker of the FITS standard: no error, no warning.
  const std::string cube = scratch / "o/hyperspectral.fits";
  CHECK(std::system(("fitsverify -q '" + cube + "' | grep -q '^verification OK'").c_str()) == 0);
  // Totals of delay and spectrometer in two bands, and |C|: five at least; 2.131 is Student's t for 15.
  CHECK(result["totals"].size() >= 5);
  for (const Json& total : result["totals"])
    CHECK(2.1315 * total["standard_error"].get<double>() <= 0.005 * total["value"].get<double>());
  // (2/3π)[sin α + (π − α) cos α] at 45 degrees.
  const double alpha = kPi / 4.0;
  const double exact = 2.0 / (3.0 * kPi) * (std::sin(alpha) + (kPi - alpha) * std::cos(alpha));
  const Json v = result["detectors"]["spectrometer"]["bands"]["V"];
  CHECK(v["intensity_m2_per_sr"].get<double>() == doctest::Approx(exact).epsilon(0.01));
  // The triangle passes 50 of the 100 W/m²; received is A × 50 / range².
  CHECK(v["source_W_m2"].get<double>() == doctest::Approx(50.0).epsilon(1e-12));
  CHECK(v["received_W_m2"].get<double>() ==
        doctest::Approx(v["intensity_m2_per_sr"].get<double>() * 50.0 / 1e12).epsilon(1e-12));
  // AB: 3631 Jy through the triangle, by the trapezoid rule on 0.01 nm.
  double zero = 0.0;
  for (int i = 0; i <= 10000; ++i) {
    const double w = 500.0 + 0.01 * i;
    zero += 0.01 * (1.0 - std::fabs(w - 550.0) / 50.0) / (w * w);
  }
  zero *= 3631e-26 * 299792458e9;
  CHECK(v["magnitude_AB"].get<double>() ==
        doctest::Approx(-2.5 * std::log10(v["received_W_m2"].get<double>() / zero)).epsilon(1e-6));
  // Lambert white absorbs nothing: C = 13/9 π, thermal or not.
  CHECK(std::fabs(result["detectors"]["pressure"]["bands"]["V"]["coefficient_m2"][2].get<double>()) ==
        doctest::Approx(13.0 / 9.0 * kPi).epsilon(0.01));
}

TEST_CASE("light curve of a turning plate: magnitude, brighter when it faces the light, gaps where it is dark") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  spit(scratch / "s.toml",
       "[[component]]\nfile = \"square.obj\"\n[source]\nkind = \"sun\"\n[observer]\nrange_m = 1e6\n"
       "[motion]\naxis = [0, 1, 0]\nperiod_s = 360\nstop_s = 90\nstep_deg = 30\n"
       "[[detector]]\nkind = \"spectrometer\"\n");
  const auto outcome = clray(scratch, {"--device", "cpu", "--rays", "65536", "--out", "o", "s.toml"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(scratch.has("o/lightcurve.png"));
  const auto rows = rows_of(scratch / "o/lightcurve.csv");
  REQUIRE(rows.size() == 4);
  // A ∝ cos²θ: magnitudes differ by −5 log10 cos θ. Column 5 is magnitude_AB, 12 is A.
  for (std::size_t i = 1; i < 3; ++i)
    CHECK(rows[i][5] - rows[0][5] ==
          doctest::Approx(-5.0 * std::log10(std::cos(kPi / 6.0 * static_cast<double>(i)))).epsilon(1e-3));
  CHECK(std::isnan(rows[3][5]));
  CHECK(rows[3][12] == 0.0);
}

TEST_CASE("bands whose names differ in case alone have files of their own, and rows of their own in one light curve") {
  const Scratch scratch;
  spit(scratch / "v.csv", "500,0\n550,1\n600,0\n");
  spit(scratch / "s.toml",
       "[[component]]\nshape = \"sphere\"\n[source]\nkind = \"sun\"\nbands = [\"V\", \"v.csv\", \"G\", \"g\"]\n"
       "[motion]\naxis = [0, 1, 0]\nperiod_s = 360\nstop_s = 30\nstep_deg = 30\n[[detector]]\nkind = \"delay\"\n"
       "[[detector]]\nkind = \"spectrometer\"\n");
  const auto outcome = clray(scratch, {"--device", "cpu", "--rays", "4096", "--no-plots", "--out", "o", "s.toml"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  for (const char* file : {"delay-V.csv", "delay-v-2.csv", "delay-G.csv", "delay-g-2.csv"})
    CHECK(scratch.has(std::string("o/") + file));
  CHECK(rows_of(scratch / "o/lightcurve.csv").size() == 8);
  const Json bands = summary(scratch, "o")["detectors"]["spectrometer"]["bands"];
  CHECK(bands["V"]["orientations"][0]["source_W_m2"] != bands["v"]["orientations"][0]["source_W_m2"]);
  CHECK(bands["G"]["orientations"][0]["source_W_m2"] != bands["g"]["orientations"][0]["source_W_m2"]);
}

TEST_CASE("a picture of a bare mesh is lit from the side and anti-aliased") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto outcome = clray(scratch, {"--device", "cpu", "--detector", "rgb", "--out", "o", "square.obj"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  const Json picture = summary(scratch, "o")["detectors"]["rgb"];
  CHECK(picture["width"] == 800);
  CHECK(picture["bands"][0]["source_W_m2"].get<double>() > 400.0);
  const std::string png = slurp(scratch / "o/rgb.png");
  CHECK(contains(png, "Exposure: a white Lambert plate square to the light has luminance 1"));
  CHECK(contains(png, "digest"));
  const std::vector<Json> orientations = summary(scratch, "o")["orientations"];
  REQUIRE(orientations.size() == 1);
  CHECK(orientations[0]["source"][2].get<double>() < 0.9);
}

TEST_CASE("a grid of Sun directions gives a table with errors and a map") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  spit(scratch / "s.toml",
       "[[material]]\nname = \"black\"\nmodel = \"lambert\"\nrho = 0\n"
       "[[component]]\nfile = \"square.obj\"\nmaterial = \"black\"\n"
       "[[detector]]\nkind = \"pressure\"\nazimuth_steps = 36\nelevation_steps = 7\n");
  const auto outcome = clray(scratch, {"--device", "cpu", "--rays", "16384", "--out", "o", "s.toml"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(scratch.has("o/pressure.png"));
  const auto rows = rows_of(scratch / "o/pressure.csv");
  // Five rings of 36 and the poles, at the very angles that were asked for.
  REQUIRE(rows.size() == 182);
  for (const auto& row : rows) {
    CHECK(std::fmod(row[5], 10.0) == 0.0);
    CHECK(std::fmod(row[6], 30.0) == 0.0);
    // A black plate of 1 m²: C = −|s_z| s, exact but for rounding (2^-36) since the beam fills the plate.
    for (std::size_t k = 0; k < 3; ++k) {
      CAPTURE(k);
      CHECK(std::fabs(row[7 + k] + std::fabs(row[4]) * row[2 + k]) <= 4.0 * row[10 + k] + 1e-3);
      CHECK(row[10 + k] >= 0.0);
    }
  }
}

TEST_CASE("what cannot be done is said in one line, with status 2 or 3 and no folder") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  struct Case {
    const char* text;
    const char* complaint;
  };
  const std::string head = "[[component]]\nfile = \"square.obj\"\n";
  spit(scratch / "red.csv", "600,1\n700,1\n");
  for (const Case& c : {Case{"[source]\nkind = \"sun\"\nspectrum = \"red.csv\"\nbands = [[400, 500]]\n",
                             "the source has no light in the band 400-500"},
                        Case{"[[detector]]\nkind = \"rgb\"\nwidth = 0\n", "detector.width: expected"},
                        Case{"[[detector]]\nkind = \"hyperspectral\"\nheight = 0\n", "detector.height: expected"},
                        Case{"[[detector]]\nkind = \"rgb\"\nwidth = 32768\nheight = 32768\n"
                             "[motion]\naxis = [0, 0, 1]\nperiod_s = 1\nstop_s = 1000\nstep_deg = 90\n",  // 64 TiB
                             "most of it is for detector rgb"},
                        Case{"[source]\nkind = \"sun\"\ndirection = [0, 0, 0]\n", "source.direction: expected"}}) {
    CAPTURE(c.complaint);
    spit(scratch / "s.toml", head + c.text);
    const auto outcome = clray(scratch, {"--device", "cpu", "--rays", "1024", "--out", "o", "s.toml"});
    CAPTURE(outcome.err);
    CHECK(outcome.status == 3);
    CHECK(contains(outcome.err, c.complaint));
    CHECK_FALSE(scratch.has("o"));
  }
  CHECK(clray(scratch, {"--source", "0,0,0", "square.obj"}).status == 2);
}
