// SPDX-License-Identifier: Apache-2.0
// Tables and summary read back to the very numbers that were written (shortest round-trip digits: tolerance zero),
// whatever the locale; true errors; names that users may choose.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "text/text.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::delay;
using io_test::Scratch;
using io_test::slurp;
using io_test::spit;

namespace {

struct Table {
  std::vector<std::string> comments, columns;
  std::vector<std::vector<std::string>> rows;
};

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all(1);
  bool inside = false;
  for (const char c : line) {
    if (c == '"')
      inside = !inside;
    else if (c == ',' && !inside)
      all.emplace_back();
    else
      all.back() += c;
  }
  return all;
}

Table read_table(const std::string& file) {
  Table table;
  std::istringstream in(slurp(file));
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("# ", 0) == 0)
      table.comments.push_back(line.substr(2));
    else if (table.columns.empty())
      table.columns = cells(line);
    else
      table.rows.push_back(cells(line));
  }
  return table;
}

double parse(const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0.0;
  in >> value;
  REQUIRE_FALSE(in.fail());
  return value;
}

WriteOptions no_plots() {
  WriteOptions options;
  options.plots = false;
  return options;
}

}  // namespace

TEST_CASE("delay.csv: columns, comments and numbers read back exactly") {
  Scratch scratch;
  Result result = io_test::result();
  result.delay.push_back(delay());
  const auto files = write_result(result, io_test::scene(), scratch / "out", no_plots());
  CHECK(files == std::vector<std::string>{"delay.csv", "error.csv", "summary.json"});
  const Table table = read_table(scratch / "out/delay.csv");
  CHECK(table.columns == std::vector<std::string>{"delay_ns", "intensity_m2_per_sr_per_ns", "standard_error", "hits",
                                                  "resolved", "upper_bound"});
  const auto comments = slurp(scratch / "out/delay.csv");
  for (const char* part : {"# what: ", "# units: ", "# scene: meshes/plate.toml\n", "# seed: 18446744073709551615\n",
                           "# digest: 00000000deadbeef\n"}) {
    CAPTURE(part);
    CHECK(comments.find(part) != std::string::npos);
  }
  const auto& d = result.delay.front();
  REQUIRE(table.rows.size() == d.bin_m2_per_sr.size());
  const double width_ns = d.bin_width_s * 1e9;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    CHECK(parse(table.rows[i][0]) == (d.first_bin_start_s + (static_cast<double>(i) + 0.5) * d.bin_width_s) * 1e9);
    CHECK(parse(table.rows[i][1]) == d.bin_m2_per_sr[i] / width_ns);
    CHECK(parse(table.rows[i][2]) == d.bin_standard_error[i] / width_ns);
    CHECK(table.rows[i][3] == std::to_string(i * 5));
    CHECK(table.rows[i][4] == (i >= 2 ? "1" : "0"));
    if (i < 2) CHECK(parse(table.rows[i][5]) == d.bin_upper_bound[i] / width_ns);
  }
}

TEST_CASE("delay.csv: a column of photons where a station gave them") {
  Scratch scratch;
  Result result = io_test::result();
  result.delay.push_back(delay(3));
  result.delay.front().photons_per_ns = {0.1, 0.25, 1e-300};
  write_result(result, io_test::scene(), scratch / "out", no_plots());
  const Table table = read_table(scratch / "out/delay.csv");
  REQUIRE(table.columns.back() == "photons_per_ns");
  for (std::size_t i = 0; i < 3; ++i) CHECK(parse(table.rows[i].back()) == result.delay.front().photons_per_ns[i]);
}

TEST_CASE("several bands: a table each, none taken for an orientation") {
  Scratch scratch;
  Result result = io_test::result();
  for (const char* band : {"400-500", "500-600"}) {
    result.delay.push_back(delay(4));
    result.delay.back().key.band = band;
  }
  write_result(result, io_test::scene(), scratch / "out", no_plots());
  for (const char* file : {"out/delay-400-500.csv", "out/delay-500-600.csv"}) {
    const Table table = read_table(scratch / file);
    CHECK(table.rows.size() == 4);
    CHECK(table.columns[0] == "delay_ns");
  }
}

TEST_CASE("several orientations and observers: rows carry their orientation, files their observer") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(3, {});
  for (std::size_t i = 0; i < 3; ++i) result.orientations[i].time_s = 0.25 * static_cast<double>(i);
  for (std::size_t i = 0; i < 3; ++i) {
    for (const char* observer : {"east", "we/st"}) {
      result.delay.push_back(delay(4, i));
      result.delay.back().key.observer = observer;
    }
  }
  write_result(result, io_test::scene(), scratch / "out", no_plots());
  for (const char* file : {"out/delay-east.csv", "out/delay-we_st.csv"}) {
    const Table table = read_table(scratch / file);
    REQUIRE(table.rows.size() == 12);
    CHECK(table.columns[0] == "orientation");
    CHECK(table.rows[11][0] == "2");
    CHECK(parse(table.rows[11][1]) == 0.5);
  }
  CHECK(read_table(scratch / "out/delay-east-totals.csv").rows.size() == 3);
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  CHECK(summary["detectors"]["delay"]["we/st"]["orientations"].size() == 3);
}

TEST_CASE("like names of variants, observers and bands: as many files as records, each with its own numbers") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(2, {});
  const std::vector<std::array<std::string, 3>> keys = {
      {"", "a b", ""},      {"", "a-b", ""},
      {"", "A B", ""},      {"a", "b", ""},
      {"a-b", "c", ""},     {"a", "b-c", ""},
      {"", "a", "b"},       {std::string(200, 'o'), std::string(200, 'v'), std::string(200, 'b')},
      {"", "x-totals", ""}, {"", "x", ""}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    for (std::size_t orientation : {0u, 1u}) {
      result.delay.push_back(delay(4, orientation));
      ResultKey& key = result.delay.back().key;
      key.observer = keys[i][0];
      key.variant = keys[i][1];
      key.band = keys[i][2];
      result.delay.back().intensity_m2_per_sr.value = static_cast<double>(i + 1);
    }
  }
  const auto files = write_result(result, io_test::scene(), scratch / "out", no_plots());
  std::set<double> found;
  std::size_t totals = 0;
  for (const std::string& file : files) {
    CHECK(file.size() < 255);
    if (file.find("totals") == std::string::npos || file.find(".csv") == std::string::npos) continue;
    const Table table = read_table(scratch / ("out/" + file));
    if (std::find(table.columns.begin(), table.columns.end(), "cross_section_m2") == table.columns.end()) continue;
    ++totals;
    found.insert(parse(table.rows[0][2]));
  }
  CHECK(totals == keys.size());
  CHECK(found.size() == keys.size());
}

TEST_CASE("a grid of pressure directions does not change how other records stand") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(5, {});
  result.delay.push_back(delay(4));
  result.spectrometer.emplace_back();
  result.spectrometer.back().key.detector = "spectrometer";
  result.spectrometer.back().key.band = "400-700";
  for (std::size_t i = 1; i < 5; ++i) {
    result.pressure.emplace_back();
    result.pressure.back().key.detector = "pressure";
    result.pressure.back().key.orientation = i;
  }
  const auto files = write_result(result, io_test::scene(), scratch / "out", no_plots());
  CHECK(std::count(files.begin(), files.end(), "lightcurve.csv") == 0);
  CHECK(read_table(scratch / "out/delay.csv").columns[0] == "delay_ns");
  CHECK(read_table(scratch / "out/spectrum.csv").columns[0] == "band");
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  CHECK(summary["detectors"]["delay"].contains("intensity_m2_per_sr"));
  CHECK(summary["detectors"]["pressure"]["orientations"].size() == 4);
}

TEST_CASE("summary.json: what it says is what was found; NaN is null") {
  Scratch scratch;
  Result result = io_test::result();
  result.delay.push_back(delay());
  result.delay.front().mean_delay_s.value = std::nan("");
  result.partial = true;
  result.target_asked = true;
  Scene scene = io_test::scene();
  scene.name = "quo\"te\nnew line ü \xff";
  scene.path = scene.name;
  result.warnings = {"bad byte \xfe"};
  WriteOptions options = no_plots();
  options.more.push_back([](const std::string& folder) {
    spit(folder + "/observations.csv", "x\n");
    return MoreFiles{{"observations.csv"}, "session", R"({"shots": 7})"};
  });
  write_result(result, scene, scratch / "out", options);
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  CHECK(summary["clray"] == CLRAY_VERSION);
  CHECK(summary["digest"] == "00000000deadbeef");
  CHECK(summary["seed"] == 18446744073709551615ull);
  CHECK(summary["partial"] == true);
  CHECK(summary["target_reached"] == false);
  const auto& entry = summary["detectors"]["delay"];
  CHECK(entry["intensity_m2_per_sr"].get<double>() == 1.0 / 3.0);
  CHECK(entry["cross_section_m2"].get<double>() == doctest::Approx(4.18879020478639).epsilon(1e-14));
  CHECK(entry["mean_delay_ns"].is_null());
  CHECK(entry["unresolved_bins"] == 2);
  CHECK(summary["session"]["shots"] == 7);
  CHECK(summary["files"].size() == 4);
  CHECK(io_test::slurp(scratch / "out/observations.csv") == "x\n");
  CHECK(read_table(scratch / "out/delay.csv").comments.size() == 8);
}

TEST_CASE("a number beside its error keeps two digits of the error") {
  CHECK(format_with_error(0.68504, 0.00144) == "0.6850 ± 0.0014");
  CHECK(format_with_error(1234.5, 12.3) == "1234 ± 12");
  CHECK(format_with_error(4.56e-6, 1.2e-8) == "(4.560 ± 0.012)e-6");
  CHECK(format_with_error(2.5, 0.0) == "2.5 ± 0");
  CHECK(format_with_error(std::nan(""), 1.0) == "n/a");
}

TEST_CASE("names that become alike get files of their own") {
  Scratch scratch;
  Result result = io_test::result();
  for (const char* observer : {"a b", "a_b"}) {
    result.delay.push_back(delay(2));
    result.delay.back().key.observer = observer;
  }
  const auto files = write_result(result, io_test::scene(), scratch / "out", no_plots());
  CHECK(files[0] == "delay-a_b.csv");
  CHECK(files[1] == "delay-a_b-2.csv");
}

TEST_CASE("a reference turns claimed into true error") {
  Scratch scratch;
  Result truth = io_test::result();
  truth.delay.push_back(delay());
  truth.delay.front().intensity_m2_per_sr.value = 0.32;
  write_result(truth, io_test::scene(), scratch / "truth", no_plots());
  Result result = io_test::result();
  result.delay.push_back(delay());
  // |1/3 - 0.32| / 0.32 = 1/24; the tolerance is that of three roundings.
  for (const char* file : {"truth/summary.json", "truth/delay.csv"}) {
    WriteOptions options = no_plots();
    options.reference_file = scratch / file;
    write_result(result, io_test::scene(), scratch / "out", options);
    const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
    CHECK(summary["relative_true_error"].get<double>() == doctest::Approx(1.0 / 24.0).epsilon(1e-14));
    const Table table = read_table(scratch / "out/error.csv");
    REQUIRE(table.columns[3] == "relative_true_error");
    CHECK(parse(table.rows[0][3]) == doctest::Approx(0.02 / 0.32).epsilon(1e-14));
    CHECK(parse(table.rows[2][3]) == doctest::Approx(1.0 / 24.0).epsilon(1e-14));
  }
  // The reference that says most: an exact one (its comment has a comma behind the total).
  truth.delay.front().intensity_m2_per_sr.rounding_bound = 1e-15;
  write_result(truth, io_test::scene(), scratch / "exact", no_plots());
  for (const char* file : {"exact/summary.json", "exact/delay.csv"})
    CHECK(relative_true_error(result, load_reference(scratch / file)) == doctest::Approx(1.0 / 24.0).epsilon(1e-14));
  spit(scratch / "hand.csv", "0.5,2\n1.0,3\n1.5,1\n");
  CHECK(load_reference(scratch / "hand.csv").totals.at("") == 3.0);
}

TEST_CASE("every number of a sum is a total of its own, and sums of one detector stand side by side") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.push_back({});
  for (std::size_t orientation = 0; orientation < 2; ++orientation) {
    for (const char* sum : {"lit", "absorbed"}) {
      TableResult table{{"delay", "", "", "", orientation}, sum, "m2", {}};
      for (const double value : {1.0, 2.0}) table.values.push_back({value + static_cast<double>(orientation), 0.1});
      result.table.push_back(table);
    }
  }
  write_result(result, io_test::scene(), scratch / "out", no_plots());
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  const auto& listed = summary["detectors"]["delay"]["orientations"];
  REQUIRE(listed.size() == 2);
  CHECK(listed[1]["orientation"] == 1);
  for (const char* sum : {"lit", "absorbed"}) CHECK(listed[1][sum]["values"][1]["value"].get<double>() == 3.0);
  REQUIRE(summary["totals"].size() == 8);
  CHECK(summary["totals"][7]["sum"] == "absorbed");
  CHECK(summary["totals"][7]["number"] == 1);
  const Reference same = load_reference(scratch / "out/summary.json");
  CHECK(same.totals.size() == 8);
  CHECK(same.totals.at("delay////1/lit/1") == 3.0);
  CHECK(relative_true_error(result, same) == 0.0);
  result.table[2].values[1].value = 3.75;  // was 3: off by a quarter
  CHECK(relative_true_error(result, same) == 0.25);
}

TEST_CASE("spectra, light curves and pressure tables read back exactly") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(2, {});
  result.orientations[1].time_s = 1.0 / 3.0;
  for (std::size_t o = 0; o < 2; ++o) {
    for (const char* name : {"400-500", "500, \"600\""}) {
      SpectrometerResult s;
      s.key = {"spectrometer", "", "", name, o};
      s.band = {name, 400, 500};
      s.intensity_m2_per_sr.value = (1.0 + static_cast<double>(o)) / 3.0;
      s.magnitude_AB = 1.0 / 7.0;
      s.phase_angle_rad = 0.5;
      result.spectrometer.push_back(s);
    }
    PressureResult p;
    p.key.detector = "pressure";
    p.key.orientation = o;
    p.sun = {0, 0.6, 0.8};
    p.coefficient_m2.value = {1.0 / 3.0, -2.0 / 3.0, 1e-17};
    p.torque_coefficient_m3.standard_error = {0.1, 0.2, 0.3};
    result.pressure.push_back(p);
  }
  Scene scene = io_test::scene("spectrometer");
  scene.detectors.push_back({"pressure", "pressure", {}});
  write_result(result, scene, scratch / "out", no_plots());
  const Table spectrum = read_table(scratch / "out/spectrum.csv");
  REQUIRE(spectrum.rows.size() == 4);
  const Table curve = read_table(scratch / "out/lightcurve.csv");
  REQUIRE(curve.rows.size() == 4);
  CHECK(curve.columns[5] == "magnitude_AB");
  CHECK(curve.rows[3][4] == "500, 600");  // read_table() drops quotes
  CHECK(parse(curve.rows[3][3]) == 1.0 / 3.0);
  CHECK(parse(curve.rows[3][5]) == 1.0 / 7.0);
  CHECK(parse(curve.rows[3][12]) == 2.0 / 3.0);
  CHECK(parse(curve.rows[3][14]) == doctest::Approx(28.6478897565412).epsilon(1e-14));
  const Table pressure = read_table(scratch / "out/pressure.csv");
  REQUIRE(pressure.rows.size() == 2);
  CHECK(parse(pressure.rows[0][5]) == doctest::Approx(90.0));
  CHECK(parse(pressure.rows[0][6]) == doctest::Approx(53.130102354156));
  CHECK(parse(pressure.rows[0][7]) == 1.0 / 3.0);
  CHECK(parse(pressure.rows[0][9]) == 1e-17);
  CHECK(parse(pressure.rows[0][18]) == 0.3);
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  // F = C / c per W/m².
  CHECK(summary["detectors"]["pressure"]["orientations"][0]["force_N_per_W_m2"][0].get<double>() ==
        doctest::Approx(1.0 / 3.0 / 299792458.0).epsilon(1e-15));
}
