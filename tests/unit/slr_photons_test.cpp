// SPDX-License-Identifier: Apache-2.0
// Photons expected of each orientation and observer, means of a session over its shots, sessions beside a grid of
// pressure directions, and sessions far from time 0. Expected values: the link written out here, and counted shots.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "slr/crd.hpp"
#include "slr/session.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

constexpr double kPiHere = 3.14159265358979323846;

/// A scene with a table of attitudes at these times, and a delay record of one full bin for each.
struct Run {
  Scene scene;
  Result result;
  explicit Run(const std::vector<double>& times, const std::vector<double>& intensities = {}) {
    scene.name = "run";
    scene.materials.emplace_back();
    scene.components.emplace_back();
    scene.components[0].shape = "sphere";
    scene.components[0].materials = {0};
    scene.detectors.emplace_back();
    scene.observers.emplace_back();
    scene.station.emplace();
    scene.motion.emplace();
    for (std::size_t i = 0; i < times.size(); ++i) {
      scene.motion->attitudes.push_back({times[i], {1, 0, 0, 0}});
      result.orientations.push_back({times[i], Quaternion(1, 0, 0, 0), Vec3(0, 0, 1), {Vec3(0, 0, 1)}, {}});
      add("", i, intensities.empty() ? 0.03 : intensities[i]);
    }
    scene.motion->start_s = times.front();
    scene.motion->stop_s = times.back();
  }
  void add(const std::string& observer, std::size_t orientation, double intensity) {
    DelayResult d;
    d.key.detector = "delay";
    d.key.observer = observer;
    d.key.orientation = orientation;
    d.first_bin_start_s = -5e-9;
    d.bin_width_s = 10e-9;
    d.bin_m2_per_sr = {intensity};
    d.bin_standard_error = d.bin_upper_bound = {0.0};
    d.hits = {100};
    d.resolved = {1};
    d.intensity_m2_per_sr.value = intensity;
    result.delay.push_back(d);
  }
};

/// Degnan's formula for the default station, all efficiencies 1: photons per ns of a bin 10 ns wide.
double rate_by_hand(double intensity, double out_m, double back_m) {
  const double sent = 0.08 * 532e-9 / (6.62607015e-34 * 299792458.0), gain = 8.0 / (25e-6 * 25e-6);
  const double area = kPiHere * 0.25 * 0.25, cross_section = 4.0 * kPiHere * intensity;
  return sent * gain * cross_section / (4 * kPiHere * out_m * out_m) / (4 * kPiHere * back_m * back_m) * area / 10.0;
}

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("clray-photons-{}", static_cast<const void*>(this));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '#' || line[0] == 'e') continue;
    std::stringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

}  // namespace

TEST_CASE("photons of each orientation are those at the range of its own time") {
  Run run({0.0, 5.0, 10.0, 15.0, 20.0});
  run.scene.station->ranges = {{0.0, 1e6}, {10.0, 2e6}, {20.0, 3e6}};  // on a line, so any interpolation has it
  expect_photons(run.scene, &run.result);
  for (std::size_t i = 0; i < 5; ++i) {
    const double range = 1e6 + 1e5 * 5.0 * static_cast<double>(i);
    REQUIRE(run.result.delay[i].photons_per_ns.size() == 1);
    CHECK(run.result.delay[i].photons_per_ns[0] == doctest::Approx(rate_by_hand(0.03, range, range)).epsilon(1e-12));
  }
}

TEST_CASE("photons toward an observer elsewhere go with both ranges") {
  Run run({0.0, 10.0});
  run.result.delay.clear();
  run.scene.station->ranges = {{0.0, 1e6}, {10.0, 2e6}};
  run.scene.observers = {Observer{}, Observer{}, Observer{}};
  run.scene.observers[0].name = "station";
  run.scene.observers[1].name = "far";
  run.scene.observers[2].name = "beside";  // says no range: that of the station
  for (const std::size_t i : {1u, 2u}) {
    run.scene.observers[i].monostatic = false;
    run.scene.observers[i].direction = Vec3(1, 0, 0);
  }
  run.scene.observers[1].range_m = 3e6;
  for (Orientation& o : run.result.orientations) o.observers.resize(3, Vec3(1, 0, 0));
  for (const char* name : {"station", "far", "beside"}) {
    for (const std::size_t o : {0u, 1u}) run.add(name, o, 0.02);
  }
  expect_photons(run.scene, &run.result);
  const double expected[] = {rate_by_hand(0.02, 1e6, 1e6), rate_by_hand(0.02, 2e6, 2e6), rate_by_hand(0.02, 1e6, 3e6),
                             rate_by_hand(0.02, 2e6, 3e6), rate_by_hand(0.02, 1e6, 1e6), rate_by_hand(0.02, 2e6, 2e6)};
  for (std::size_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(run.result.delay[i].photons_per_ns.at(0) == doctest::Approx(expected[i]).epsilon(1e-12));
  }
}

TEST_CASE("a session's mean cross-section is that over its shots, in the summary and for a person alike") {
  // 9 s of 1/pi m^2/sr (4 m^2), 1 s of nothing, and a last attitude at which no shot is fired any more.
  Run run({0.0, 9.0, 10.0}, {1.0 / kPiHere, 0.0, 7.0});
  run.scene.station->rate_Hz = 10.0;
  CHECK(Session(run.result, run.scene, {}).mean_cross_section_m2() == doctest::Approx(3.6).epsilon(1e-14));
  const Folder folder;
  SessionOptions options;
  options.plots = false;
  const MoreFiles files = session_files(run.result, run.scene, folder.path.string(), options);
  CHECK(files.summary_json.find("\"mean_cross_section_m2\": 3.6,") != std::string::npos);
  CHECK(files.summary_json.find("\"cross-section\": {\"value\": 3.6,") != std::string::npos);
  CHECK(files.text.find("  3.6 m^2  ") != std::string::npos);
  CHECK(files.text.find("  cross-section  3.6") != std::string::npos);
}

TEST_CASE("a session beside a grid of pressure directions fires the shots that it fires alone") {
  Run alone({0.0, 2.0, 4.0}), beside({0.0, 2.0, 4.0});
  for (std::size_t i = 3; i < 10; ++i) {
    beside.result.orientations.push_back({0.0, Quaternion(1, 0, 0, 0), Vec3(1, 0, 0), {Vec3(1, 0, 0)}, {}});
    beside.result.pressure.emplace_back();
    beside.result.pressure.back().key.orientation = i;
  }
  std::vector<double> first, second;
  Session(alone.result, alone.scene, {}).run([&](const Shot& s) { first.push_back(s.delay_ns); });
  Session(beside.result, beside.scene, {}).run([&](const Shot& s) { second.push_back(s.delay_ns); });
  CHECK(first.size() > 1000);
  CHECK(first == second);
  beside.result.delay.pop_back();
  CHECK_THROWS_WITH_AS(Session(beside.result, beside.scene, {}), doctest::Contains("orientation 2 has no delay result"),
                       Error);
}

TEST_CASE("Unix, GPS and Julian seconds: shots, ranges and dates keep their picoseconds") {
  // The range is 1000 km + 7 km/s (t - start): in doubles of 1e9 s and more its time would be off by 0.1 us and more.
  struct Case {
    double start, mjd;  // of the motion, of its time 0
    int day;            // on which it starts
  };
  const Case cases[] = {{0.0, 0.0, 51544},
                        {1e7, 51544.0, 51544 + 115},
                        {1.7e9, 40587.0, 60262},
                        {1.4e9 + 0.5, 44244.0, 60447},
                        {2.12e11, -2400000.5, 53703},
                        {-3e9, 95000.0, 60277}};
  for (const Case& c : cases) {
    const double start = c.start;
    CAPTURE(start);
    Run run({start, start + 1.0, start + 2.0});
    Station& station = *run.scene.station;
    station.rate_Hz = 8192.0;
    station.start_mjd = c.mjd;
    station.noise_per_ns = 0.0;
    for (auto& d : run.result.delay) d.bin_m2_per_sr = {1e6};  // every shot a photon
    for (int i = 0; i <= 4; ++i) station.ranges.emplace_back(start + 0.5 * i, 1e6 + 7e3 * 0.5 * i);
    const Folder folder;
    SessionOptions options;
    options.plots = false;
    const SessionSummary s = write_session(run.result, run.scene, folder.path.string(), options);
    CHECK(s.signal == 16384);
    const auto rows = rows_of(folder.path / "observations.csv");
    REQUIRE(rows.size() == 16384);
    double worst_m = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      // 1/8192 s is 122070312.5 ps: the text must be the start plus that, rounded to a picosecond.
      if (k % 8192 % 2 == 0) {
        const auto halves = static_cast<long long>(std::llround(start * 2.0));
        const long long ps = static_cast<long long>(k % 8192) * 1220703125 / 10 + (halves % 2 != 0 ? 500000000000 : 0);
        const long long second =
            static_cast<long long>(std::floor(start)) + static_cast<long long>(k / 8192) + ps / 1000000000000;
        // All starts are whole seconds or halves; below zero, whole.
        const long long past = ps % 1000000000000;
        const std::string text = second >= 0 || past == 0
                                     ? fmt::format("{}.{:012}", second, past)
                                     : fmt::format("-{}.{:012}", -(second + 1), 1000000000000 - past);
        REQUIRE(rows[k][0] == text);
      }
      const double range = 0.5 * 299792458.0 * (std::stod(rows[k][1]) - std::stod(rows[k][2]) * 1e-9);
      worst_m = std::max(worst_m, std::fabs(range - (1e6 + 7e3 * static_cast<double>(k) / 8192.0)));
    }
    // Flight times are rounded to 1 ps (0.15 mm), residuals to 1e-6 ns.
    CHECK(worst_m < 1e-4);
    const CrdFile crd = read_crd((folder.path / "observations.crd").string(), {});
    CHECK(crd.ranges == 16384);
    CHECK(crd.header.start.mjd == c.day);
  }
}
