// SPDX-License-Identifier: Apache-2.0
// lightcurve.csv and its entry in the summary, from results made by hand: standardised magnitudes in closed form, what
// a site does not see, and curves that do not reach 90 degrees.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "clray/write.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;
using io_test::slurp;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// Rows of a CSV file as texts, by the names of its columns.
struct Rows {
  std::vector<std::string> columns, comments;
  std::vector<std::vector<std::string>> rows;
  double number(std::size_t row, const std::string& column) const {
    return std::strtod(text(row, column).c_str(), nullptr);
  }
  std::string text(std::size_t row, const std::string& column) const {
    const auto place = std::find(columns.begin(), columns.end(), column);
    REQUIRE(place != columns.end());
    return rows.at(row).at(static_cast<std::size_t>(place - columns.begin()));
  }
};

Rows rows_of(const std::string& file) {
  Rows all;
  std::istringstream lines(slurp(file));
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '#') {
      all.comments.push_back(line);
      continue;
    }
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    if (all.columns.empty()) {
      all.columns = cells;
    } else {
      all.rows.push_back(cells);
    }
  }
  return all;
}

/// Standard magnitude 3 + 0.02 per degree, at 1000 (1 + o) km, behind 0.1 mag of extinction.
Result curve_result(const std::vector<double>& phases_deg, const std::vector<std::string>& bands) {
  Result result = io_test::result();
  result.orientations.clear();
  for (std::size_t o = 0; o < phases_deg.size(); ++o) {
    Orientation view;
    view.time_s = 10.0 * static_cast<double>(o);
    view.observers = {{0, 0, 1}};
    view.ranges_m = {1e6 * static_cast<double>(1 + o)};
    result.orientations.push_back(view);
    for (const std::string& band : bands) {
      SpectrometerResult s;
      s.key = {"spectrometer", "", "", band, o};
      s.band = {band, 400, 500};
      s.phase_angle_rad = phases_deg[o] * kDegree;
      s.extinction_mag = 0.1;
      s.air_mass = 1.0;
      s.magnitude_AB = 3.0 + 0.02 * phases_deg[o] + 5.0 * std::log10(1.0 + static_cast<double>(o)) + 0.1;
      s.magnitude_Vega = s.magnitude_AB - 0.25;
      s.magnitude_standard_error = 0.01;
      result.spectrometer.push_back(s);
    }
  }
  return result;
}

WriteOptions no_plots() {
  WriteOptions options;
  options.plots = false;
  return options;
}

}  // namespace

TEST_CASE("light curve: 1000 km and 90 degrees in closed form; names that differ in case alone stay apart") {
  Scratch scratch;
  const std::vector<double> phases{60, 68, 76, 84, 92, 100};
  write_result(curve_result(phases, {"G", "g"}), io_test::scene("spectrometer"), scratch / "out", no_plots());
  const Rows table = rows_of(scratch / "out/lightcurve.csv");
  REQUIRE(table.rows.size() == 12);
  CHECK(table.text(0, "band") == "G");
  CHECK(table.text(1, "band") == "g");
  for (std::size_t i = 0; i < 12; ++i) {
    const double phase = phases[i / 2];
    CHECK(table.number(i, "time_s") == 10.0 * static_cast<double>(i / 2));
    CHECK(table.number(i, "phase_angle_deg") == doctest::Approx(phase).epsilon(1e-14));
    CHECK(table.number(i, "range_m") == 1e6 * static_cast<double>(1 + i / 2));
    // Rounding of a few terms below 10.
    CHECK(table.number(i, "magnitude_1000km_AB") == doctest::Approx(3.0 + 0.02 * phase).epsilon(1e-14));
    CHECK(table.number(i, "magnitude_1000km_Vega") == doctest::Approx(2.75 + 0.02 * phase).epsilon(1e-14));
    // Linear in phase, so every instant gives the same at 90 degrees.
    CHECK(table.number(i, "magnitude_1000km_90deg_AB") == doctest::Approx(4.8).epsilon(1e-13));
    CHECK(table.number(i, "magnitude_1000km_90deg_Vega") == doctest::Approx(4.55).epsilon(1e-13));
    CHECK(table.number(i, "lit_share") == doctest::Approx(0.5 + 0.5 * std::cos(phase * kDegree)).epsilon(1e-14));
    CHECK(table.text(i, "mjd") == "nan");
    CHECK(table.text(i, "time_utc").empty());
  }
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  const auto& curve = summary["light_curves"][1];
  CHECK(curve["band"] == "g");
  CHECK(curve["magnitude_1000km_90deg_AB"].get<double>() == doctest::Approx(4.8).epsilon(1e-13));
  // 90 lies three quarters of the way from 84 to 92; each mean rests on one instant.
  CHECK(curve["standard_error"].get<double>() == doctest::Approx(0.01 * std::hypot(0.25, 0.75)).epsilon(1e-12));
  CHECK_FALSE(curve.contains("why_not"));
}

TEST_CASE("light curve: without 90 degrees there is no magnitude there, and a reason; at 90 degrees alone there is") {
  Scratch scratch;
  write_result(curve_result({45, 45, 46}, {"V"}), io_test::scene("spectrometer"), scratch / "out", no_plots());
  const Rows table = rows_of(scratch / "out/lightcurve.csv");
  REQUIRE(table.rows.size() == 3);
  CHECK(table.text(0, "magnitude_1000km_90deg_AB") == "nan");
  CHECK(std::count(table.comments.begin(), table.comments.end(),
                   "# no magnitude_1000km_90deg of the band V: the phase angles go from 45 to 46 deg") == 1);
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  CHECK(summary["light_curves"][0]["magnitude_1000km_90deg_AB"].is_null());
  CHECK(summary["light_curves"][0]["why_not"] == "the phase angles go from 45 to 46 deg");
  write_result(curve_result({90, 90}, {"V"}), io_test::scene("spectrometer"), scratch / "out", no_plots());
  CHECK(rows_of(scratch / "out/lightcurve.csv").number(1, "magnitude_1000km_90deg_AB") ==
        doctest::Approx(4.8).epsilon(1e-13));
}

TEST_CASE("light curve of a pass: dates, angles over the site, and only what the site sees") {
  Scratch scratch;
  Result result = curve_result({80, 90, 100}, {"V"});
  Scene scene = io_test::scene("spectrometer");
  scene.source.kind = Source::Kind::sun;
  scene.source.bands = {{"V", 500, 600}};
  scene.observers[0].monostatic = false;
  for (std::size_t i = 0; i < 3; ++i) {
    PassInstant instant;
    instant.epoch = {61369, 43200000000000000 + static_cast<std::int64_t>(i) * 10000000000000};
    instant.time_s = 10.0 * static_cast<double>(i);
    instant.orientation = i;
    instant.placed = true;
    instant.view = result.orientations[i];
    instant.sun_share = 0.5;
    instant.sites.push_back({0, 1e6, 30.0 * kDegree, 120.0 * kDegree, i != 1, 0.0, false});
    result.instants.push_back(instant);
  }
  write_result(result, scene, scratch / "out", no_plots());
  const Rows table = rows_of(scratch / "out/lightcurve.csv");
  REQUIRE(table.rows.size() == 2);
  CHECK(table.text(1, "orientation") == "2");
  CHECK(table.text(1, "time_utc") == "2026-11-25T12:00:20.000Z");
  CHECK(table.number(1, "mjd") == doctest::Approx(61369.5 + 20.0 / 86400.0).epsilon(1e-15));
  CHECK(table.number(0, "elevation_deg") == doctest::Approx(30.0).epsilon(1e-14));
  CHECK(table.number(0, "azimuth_deg") == doctest::Approx(120.0).epsilon(1e-14));
  CHECK(table.number(0, "sun_share") == 0.5);
  CHECK(table.number(0, "magnitude_1000km_90deg_AB") == doctest::Approx(4.8).epsilon(1e-13));
}
