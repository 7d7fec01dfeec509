// SPDX-License-Identifier: Apache-2.0
// Whole sessions: counts against the expected rates, files against each other, parts redone alone, the size and speed
// of long ones, and the scenes that are refused.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/session.hpp"
#include "clray/write.hpp"
#include "shared/photon.h"
#include "slr/crd.hpp"
#include "slr/link.hpp"
#include "slr/session.hpp"
#include "support/sanitized.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("clray-session-{}", static_cast<const void*>(this));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string text(const std::string& name) const {
    std::ifstream file(path / name, std::ios::binary);
    std::stringstream all;
    all << file.rdbuf();
    return all.str();
  }
};

/// A body with two facets 6 m apart that turns: `orientations` steps over `seconds`.
struct Spin {
  Scene scene;
  Result result;
  Spin(double seconds, int orientations) {
    scene.name = "two facets";
    scene.materials.emplace_back();
    scene.components.emplace_back();
    scene.components[0].shape = "sphere";
    scene.components[0].materials = {0};
    scene.detectors.emplace_back();
    scene.observers.emplace_back();
    scene.station.emplace();
    scene.motion.emplace();
    scene.motion->stop_s = seconds;
    scene.motion->period_s = 2.0 * seconds;
    // A hair more than the half turn's share, so that no orientation comes at its end.
    scene.motion->step_rad = constants::kPi / orientations * (1.0 + 1e-6);
    result.seed = 42;
    for (int i = 0; i < orientations; ++i) {
      result.orientations.push_back(
          {seconds * i / orientations, Quaternion(1, 0, 0, 0), Vec3(0, 0, 1), {Vec3(0, 0, 1)}, {}});
      DelayResult d;
      d.key.detector = "delay";
      d.key.orientation = static_cast<std::size_t>(i);
      d.first_bin_start_s = -25.6e-9;
      d.bin_width_s = 0.1e-9;
      d.bin_m2_per_sr.assign(512, 0.0);
      d.bin_m2_per_sr[static_cast<std::size_t>(100 + i)] = 0.01;
      d.bin_m2_per_sr[static_cast<std::size_t>(400 - i)] = 0.02;
      d.bin_standard_error = d.bin_upper_bound = std::vector<double>(512, 0.0);
      d.hits.assign(512, 100);
      d.resolved.assign(512, 1);
      d.intensity_m2_per_sr.value = 0.03;
      result.delay.push_back(d);
    }
  }
};

SessionOptions without_picture() {
  SessionOptions options;
  options.plots = false;
  return options;
}

void check_share(double hits, double count, double probability) {
  CHECK(std::fabs(hits / count - probability) < 4.0 * std::sqrt(probability * (1.0 - probability) / count));
}

long peak_memory_KiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

TEST_CASE("a session: counts as expected, each photon where its orientation has light") {
  Spin pass(20.0, 10);
  Session session(pass.result, pass.scene, {});
  CHECK(session.shots() == 40000);
  const double photons = 4.0 * constants::kPi * 0.03 * link_budget(*pass.scene.station, 532.0, 1e6).photons_per_m2;
  std::uint64_t last = 0, wrong = 0;
  const SessionSummary s = session.run([&](const Shot& shot) {
    CHECK(shot.time.s * kPicosecondsPerSecond + shot.time.ps == static_cast<std::int64_t>(shot.number) * 500000000);
    if (last != 0 && shot.number <= last) ++wrong;
    last = shot.number;
    const double orientation = std::floor(static_cast<double>(shot.number) / 4000.0);
    const double first = -25.6 + 0.1 * (100 + orientation), second = -25.6 + 0.1 * (400 - orientation);
    const bool lit = (shot.delay_ns >= first - 1e-9 && shot.delay_ns <= first + 0.1 + 1e-9) ||
                     (shot.delay_ns >= second - 1e-9 && shot.delay_ns <= second + 0.1 + 1e-9);
    if (shot.kind == CLRAY_PHOTON_SIGNAL && !lit) ++wrong;
  });
  CHECK(wrong == 0);
  CHECK(s.shots == s.signal + s.noise + s.none);
  check_share(static_cast<double>(s.none), 40000.0, std::exp(-photons - 0.1));
  check_share(static_cast<double>(s.signal + s.noise), 40000.0, -std::expm1(-photons - 0.1));
  CHECK(s.signal > 10 * s.noise);
}

TEST_CASE("files agree with each other, and parts redone alone agree with the whole") {
  const Folder folder;
  Spin pass(20.0, 10);
  pass.scene.station->jitter_fwhm_s = 50e-12;
  pass.scene.station->pulse_fwhm_s = 200e-12;
  pass.scene.station->flag_signal = true;
  pass.scene.station->ranges = {{0.0, 1.2e6}, {10.0, 1.0e6}, {20.0, 1.1e6}};
  pass.scene.station->start_mjd = 60000.0 + 86390.0 / 86400.0;  // over midnight
  SessionOptions options;
  const SessionSummary s = write_session(pass.result, pass.scene, folder.path.string(), options);
  std::vector<CrdRange> ranges;
  const CrdFile crd =
      read_crd((folder.path / "observations.crd").string(), [&](const CrdRange& r) { ranges.push_back(r); });
  CHECK(crd.ranges == s.signal + s.noise);
  CHECK(crd.header.start.mjd == 60000);
  CHECK(crd.header.stop.mjd == 60001);
  std::istringstream csv(folder.text("observations.csv"));
  std::string line;
  std::size_t row = 0;
  while (std::getline(csv, line)) {
    if (line[0] == '#' || line[0] == 'e') continue;
    double epoch = 0, flight = 0, residual = 0;
    char kind[16];
    REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf,%15s", &epoch, &flight, &residual, kind) == 4);
    REQUIRE(row < ranges.size());
    // A double holds the epoch's second of day to 2e-11 s, the start_mjd to 1e-6 s.
    const double second = std::fmod(86390.0 + epoch, 86400.0);
    CHECK(std::fabs(static_cast<double>(ranges[row].epoch_ps) * 1e-12 - second) < 2e-6);
    CHECK(std::fabs(static_cast<double>(ranges[row].flight_ps) * 1e-12 - flight) < 1e-15);
    CHECK(ranges[row].filter_flag == (std::string(kind) == "signal" ? 2 : 1));
    const double range = RangeModel(*pass.scene.station).range_m(epoch);
    CHECK(std::fabs(flight - 2.0 * range / 299792458.0 - residual * 1e-9) < 1.1e-12);  // both rounded to a ps or less
    ++row;
  }
  CHECK(row == ranges.size());
  CHECK(std::filesystem::exists(folder.path / "observations.png"));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 3);

  options = without_picture();
  options.first_shot = 12345;
  options.shots = 6789;
  options.stem = "part";
  options.threads = 1;
  write_session(pass.result, pass.scene, folder.path.string(), options);
  const std::string whole = folder.text("observations.csv"), part = folder.text("part.csv");
  const std::string rows = part.substr(part.find("kind\n") + 5);
  CHECK(rows.size() > 10000);
  CHECK(whole.find(rows) != std::string::npos);
}

TEST_CASE("noise and signal are told apart; dark counts add to the noise") {
  Spin pass(100.0, 1);
  for (auto& bin : pass.result.delay[0].bin_m2_per_sr) bin = 0.0;
  pass.scene.station->dark_per_ns = 0.002;
  Session session(pass.result, pass.scene, {});
  const SessionSummary s = session.run([](const Shot&) {});
  CHECK(s.signal == 0);
  check_share(static_cast<double>(s.noise), 200000.0, -std::expm1(-0.3));
}

TEST_CASE("dead time: a blind detector misses gates, and parts still agree with the whole") {
  Spin pass(50.0, 5);
  Station& station = *pass.scene.station;
  station.noise_per_ns = 0.005;
  const double busy = -std::expm1(-0.5 - 4.0 * constants::kPi * 0.03 * link_budget(station, 532.0, 1e6).photons_per_m2);
  station.dead_time_s = 100e-6;  // over long before the next pulse
  SessionSummary s = Session(pass.result, pass.scene, {}).run([](const Shot&) {});
  check_share(static_cast<double>(s.signal + s.noise), 1e5, busy);
  // Two periods: the gates of the next shot and, for the most part, of the one after are missed; the gate after that
  // is open. Shots with a photon over all: p/(1 + 2p) with two missed (dead time a little over two periods).
  station.dead_time_s = 2.0 / station.rate_Hz + 200e-9;
  std::vector<std::uint64_t> whole, part;
  s = Session(pass.result, pass.scene, {}).run([&](const Shot& shot) { whole.push_back(shot.number); });
  const double expected = busy / (1.0 + 2.0 * busy), n = 1e5;
  // Renewal process: variance of the count is n var/mean^3 of the spacing, geometric plus 2.
  const double mean = 1.0 / busy + 2.0, variance = (1.0 - busy) / (busy * busy);
  CHECK(std::fabs(static_cast<double>(whole.size()) - n * expected) <
        4.0 * std::sqrt(n * variance / (mean * mean * mean)));
  for (std::size_t i = 1; i < whole.size(); ++i) REQUIRE(whole[i] - whole[i - 1] > 2);
  SessionOptions options;
  options.first_shot = 50001;
  Session(pass.result, pass.scene, options).run([&](const Shot& shot) { part.push_back(shot.number); });
  whole.erase(whole.begin(), std::lower_bound(whole.begin(), whole.end(), 50001));
  CHECK(part == whole);
}

TEST_CASE("a million records in under 3 s, with flat memory") {
  const Folder folder;
  Spin pass(500.0, 50);
  for (auto& d : pass.result.delay) {
    for (double& bin : d.bin_m2_per_sr) bin *= 1e3;  // every shot a photon
  }
  SessionOptions options = without_picture();
  options.shots = 100000;
  write_session(pass.result, pass.scene, folder.path.string(), options);
  const long before = peak_memory_KiB();
  options.shots = 0;
  const auto begin = std::chrono::steady_clock::now();
  const SessionSummary s = write_session(pass.result, pass.scene, folder.path.string(), options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  CHECK(s.shots == 1000000);
  CHECK(s.signal + s.noise == 1000000);
  MESSAGE("seconds for a million records: " << seconds);
  if (!clray_test::kSanitized) CHECK(seconds < 3.0);
  if (!clray_test::kSanitized)
    CHECK(peak_memory_KiB() - before < 2048);  // ten times the records: at most one block more
  const auto read_begin = std::chrono::steady_clock::now();
  CHECK(read_crd((folder.path / "observations.crd").string(), {}).ranges == 1000000);
  MESSAGE(
      "seconds to read them: " << std::chrono::duration<double>(std::chrono::steady_clock::now() - read_begin).count());
}

TEST_CASE("a session along a prediction: distances solved for, the prediction named in the CRD file") {
  const Folder folder;
  std::ofstream cpf(folder.path / "orbit.cpf");
  cpf << "H1 CPF  2  CLR 2023 11 23  2  327 01 testsat\n"
         "H2  7603901 1155     8820 2023 11 22 23 50  0 2023 11 23 23 55  0    60 1 1  0 0 0  1\nH9\n";
  const auto orbit = [](double t) {
    return Vec3(7.0e6 * std::cos(1e-3 * t), 4.2e6 * std::sin(1e-3 * t), 5.6e6 * std::sin(1e-3 * t));
  };
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = orbit(60.0 * i);
    cpf << fmt::format("10 0 60270 {} 0 {:.6f} {:.6f} {:.6f}\n", 3600 + 60 * i, p.x, p.y, p.z);
  }
  cpf << "99\n";
  cpf.close();
  Spin pass(500.0, 10);
  Station& station = *pass.scene.station;
  station.cpf_file = (folder.path / "orbit.cpf").string();
  station.position_m = Vec3(6.0e6, 1.0e6, 1.0e6);
  pass.scene.motion->start_s = 0.0;
  std::vector<CrdRange> ranges;
  const auto begin = std::chrono::steady_clock::now();
  const SessionSummary s = write_session(pass.result, pass.scene, folder.path.string(), without_picture());
  MESSAGE("seconds for " << s.shots << " shots along a prediction: "
                         << std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  const CrdFile crd =
      read_crd((folder.path / "observations.crd").string(), [&](const CrdRange& r) { ranges.push_back(r); });
  CHECK(crd.header.target == "testsat");
  CHECK(crd.header.cospar == "7603901");
  CHECK(crd.header.prediction_type == 1);
  CHECK(crd.header.prediction_year == "23");
  CHECK(crd.header.prediction_date == "112302");
  CHECK(crd.header.prediction_sequence == "32701");
  CHECK(crd.header.start.ps == 3600 * kPicosecondsPerSecond);
  REQUIRE(ranges.size() == s.signal + s.noise);
  CHECK(crd.supplements.size() >= 8);
  std::size_t outside = 0;
  for (const CrdRange& r : ranges) {
    const double t = static_cast<double>(r.epoch_ps) * 1e-12 - 3600.0;
    double tau = 0.0;
    for (int i = 0; i < 6; ++i) tau = glm::length(orbit(t + tau) - station.position_m) / 299792458.0;
    // All flights lie within the gate around 2 tau (1 mm of distance is 7 ps).
    outside += std::fabs(static_cast<double>(r.flight_ps) * 1e-12 - 2.0 * tau) > 0.5 * station.gate_s + 1e-11;
  }
  CHECK(outside == 0);
  station.start_mjd = 60270.0 + 5000.0 / 86400.0;
  CHECK_THROWS_WITH_AS(Session(pass.result, pass.scene, {}), doctest::Contains("outside the ephemeris"), Error);
}

TEST_CASE("one session for each variant, with the link budget in the summary") {
  const Folder folder;
  Spin pass(2.0, 2);
  const auto one = session_files(pass.result, pass.scene, folder.path.string(), without_picture());
  CHECK(one.names == std::vector<std::string>{"observations.csv", "observations.crd"});
  CHECK(one.summary_key == "session");
  CHECK(one.summary_json.find("\"divergence_urad\": {\"value\": 25, \"unit\": \"urad\", \"default\": 25") !=
        std::string::npos);
  const auto delays = pass.result.delay;
  for (auto d : delays) {
    d.key.variant = "dull/dark";
    pass.result.delay.push_back(d);
  }
  const auto two = session_files(pass.result, pass.scene, folder.path.string(), without_picture());
  CHECK(two.names == std::vector<std::string>{"observations-2.csv", "observations-2.crd", "observations-dull_dark.csv",
                                              "observations-dull_dark.crd"});
  CHECK(two.summary_json.find("\"dull/dark\": {\"shots\": 4000") != std::string::npos);
  Scene still = pass.scene;
  still.motion.reset();
  CHECK_FALSE(has_session(still));
  CHECK(session_files(pass.result, still, folder.path.string()).names.empty());
}

TEST_CASE("sessions whose variants have like or long names have files of their own") {
  const Folder folder;
  Spin pass(1.0, 1);
  const DelayResult delay = pass.result.delay.front();
  pass.result.delay.clear();
  // The light of each is a share of the noise-free gate's: the files must not hold one another's photons.
  const std::vector<std::string> variants = {
      "a b", "a-b", "A B", "тёмный", "чёрный", std::string(300, 'x'), std::string(299, 'x') + "y"};
  pass.scene.station->noise_per_ns = 0.0;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    pass.result.delay.push_back(delay);
    pass.result.delay.back().key.variant = variants[i];
    for (double& bin : pass.result.delay.back().bin_m2_per_sr) bin *= i % 2 == 0 ? 1e3 : 0.0;
  }
  const MoreFiles files = session_files(pass.result, pass.scene, folder.path.string(), without_picture());
  REQUIRE(files.names.size() == 2 * variants.size());
  for (std::size_t i = 0; i < variants.size(); ++i) {
    CAPTURE(files.names[2 * i]);
    const std::string csv = folder.text(files.names[2 * i]);
    CHECK(std::count(csv.begin(), csv.end(), '\n') == (i % 2 == 0 ? 2000 + 4 : 4));
    CHECK(read_crd((folder.path / files.names[2 * i + 1]).string(), {}).ranges == (i % 2 == 0 ? 2000 : 0));
  }
}

TEST_CASE("scenes that make no session are refused") {
  const auto refused = [](const char* words, auto&& change) {
    Spin pass(20.0, 3);
    change(pass);
    CAPTURE(words);
    CHECK_THROWS_WITH_AS(Session(pass.result, pass.scene, {}), doctest::Contains(words), Error);
  };
  refused("needs a [station]", [](Spin& p) { p.scene.station.reset(); });
  refused("needs a [motion]", [](Spin& p) { p.scene.motion.reset(); });
  refused("source.kind", [](Spin& p) { p.scene.source.kind = Source::Kind::sun; });
  refused("seen from the source", [](Spin& p) {
    p.scene.observers[0].monostatic = false;
    p.scene.observers[0].direction = Vec3(1, 0, 0);
  });
  refused("station.range_m: expected a number in [1e-3,1e13], found -5",
          [](Spin& p) { p.scene.station->range_m = -5.0; });
  refused("station.divergence_rad: expected a number in [1e-9,4e6] urad, found 0",
          [](Spin& p) { p.scene.station->divergence_rad = 0.0; });
  refused("outside the table", [](Spin& p) { p.scene.station->ranges = {{0.0, 1e6}, {19.0, 1e6}}; });
  refused("orientation 2 has no delay result", [](Spin& p) { p.result.delay.pop_back(); });
  refused("station.cpf", [](Spin& p) {
    p.scene.station->cpf_file = "/nowhere/station.cpf";
    p.scene.station->position_m = Vec3(6e6, 0, 0);
  });
  Spin pass(20.0, 3);
  CHECK_THROWS_WITH_AS(write_session(pass.result, pass.scene, "/nowhere/at/all"),
                       doctest::Contains("cannot write /nowhere/at/all/observations.csv: No such file or directory"),
                       Error);
}
