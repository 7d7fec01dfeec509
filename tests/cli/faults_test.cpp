// SPDX-License-Identifier: Apache-2.0
// A disk that fails at any one call while a result is written: the program ends with status 5 or has written a whole
// result, and an older result stays whole until then. A program that is killed at any one call: the next run removes
// what it left. tests/support/faults.cpp makes the calls fail, and kills.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;
namespace fs = std::filesystem;

namespace {

/// The digest of a result, if it is whole.
std::string digest(const Scratch& scratch) {
  const auto result = nlohmann::json::parse(slurp(scratch / "out/summary.json"), nullptr, false);
  if (!result.is_object()) return "no summary";
  for (const auto& file : result["files"]) {
    if (!scratch.has("out/" + file.get<std::string>())) return "no " + file.get<std::string>();
  }
  return result["digest"];
}

/// Every detector that has files of a kind of its own.
std::string scene() {
  return "[[component]]\nfile = \"square.obj\"\n[source]\nkind = \"sun\"\ndirection = [0, 0, 1]\nbands = [[400, 500], "
         "[500, 700]]\n[observer]\ndirection = [0, 1, 2]\nrange_m = 1e6\n[motion]\naxis = [0, 1, 0]\nperiod_s = 9\n"
         "stop_s = 2\nstep_deg = 40\n[[detector]]\nkind = \"delay\"\n[[detector]]\nkind = \"spectrometer\"\n"
         "[[detector]]\nkind = \"pressure\"\n[[detector]]\nkind = \"rgb\"\nwidth = 8\nheight = 8\nsamples = 4\n"
         "[[detector]]\nkind = \"hyperspectral\"\nwidth = 8\nheight = 8\nsamples = 4\n[trace]\nmethod = \"points\"\n";
}

/// What stands in a folder, in order.
std::vector<std::string> names(const Scratch& scratch) {
  std::vector<std::string> all;
  for (const auto& entry : fs::directory_iterator(scratch.path)) all.push_back(entry.path().filename());
  std::sort(all.begin(), all.end());
  return all;
}

/// The run's result, what it was told and said, and files of others.
const std::vector<std::string> kOwn{".err", ".out", ".out.clray-mine", ".out.mine", "out", "square.obj"};

}  // namespace

TEST_CASE("whichever call fails while a result is written: status 5 or a whole result, and the older one stays") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  spit(scratch / "scene.toml", scene());
  const auto run = [&](const std::string& seed, const std::vector<std::string>& environment) {
    return clray(scratch,
                 {"--device", "cpu", "--rays", "1024", "--no-plots", "--quiet", "--keep-sums", "--format", "netcdf",
                  "--seed", seed, "--out", "out", "scene.toml"},
                 environment);
  };
  std::vector<std::string> environment{std::string("LD_PRELOAD=") + CLRAY_FAULTS,
                                       "CLRAY_FAULT_IN=" + scratch.path.filename().string() + "/",
                                       "CLRAY_FAULT_TOTAL=" + (scratch / "total")};
  const auto old = run("1", {});
  CAPTURE(old.err);
  REQUIRE(old.status == 0);
  const std::string before = digest(scratch);
  REQUIRE(run("2", environment).status == 0);
  const std::string after = digest(scratch);
  REQUIRE(before != after);
  const int calls = std::stoi(slurp(scratch / "total"));
  REQUIRE(calls > 100);
  for (const char* kind : {"write", "close", "flush", "sync", "rename", "mkdir", "open"})
    CHECK_MESSAGE(contains(slurp(scratch / "total"), kind), kind);
  std::mt19937 random(3);
  const bool all = ::getenv("CLRAY_LONG_TESTS") != nullptr;
  int failed = 0;
  for (int k = 0; k < (all ? calls : 8); ++k) {
    REQUIRE(run("1", {}).status == 0);
    // The last calls force the files to disk and put the folder in place.
    const int from = k % 2 == 0 ? 0 : calls - 60;
    const int at = all ? k + 1 : 1 + from + static_cast<int>(random() % static_cast<unsigned>(calls - from));
    environment[2] = "CLRAY_FAULT_AT=" + std::to_string(at);
    const auto outcome = run("2", environment);
    CAPTURE(at);
    CAPTURE(outcome.err);
    const std::string found = digest(scratch);
    CHECK((outcome.status == 0 || outcome.status == 5));
    if (outcome.status == 0) CHECK(found == after);
    CHECK((found == before || found == after));
    failed += outcome.status == 5;
    for (const auto& entry : fs::directory_iterator(scratch.path)) {
      const std::string name = entry.path().filename();
      CHECK(name.rfind(".out.", 0) != 0);
      if (name.rfind("out.unfinished-", 0) != 0) continue;
      CHECK(contains(outcome.err, "the files that were finished are in"));
      fs::remove_all(entry.path());
    }
  }
  CHECK(failed > 0);
  MESSAGE(failed << " failed of " << calls << " calls");
}

TEST_CASE("what a process leaves that is killed while it writes, the next run removes, and nothing else") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> whole{"--device", "cpu",        "--method", "points", "--rays",    "1024",
                                       "--quiet",  "--no-plots", "--out",    "out",    "square.obj"};
  std::vector<std::string> saving = whole;
  saving.push_back("--keep-sums");
  spit(scratch / ".out.mine", "mine");
  spit(scratch / ".out.clray-mine", "mine");
  std::mt19937 random(4);
  const bool all = ::getenv("CLRAY_LONG_TESTS") != nullptr;
  for (const std::string part : {"out.sums", "/.out."}) {
    std::vector<std::string> environment{std::string("LD_PRELOAD=") + CLRAY_FAULTS, "CLRAY_FAULT_IN=" + part,
                                         "CLRAY_FAULT_TOTAL=" + (scratch / "total")};
    REQUIRE(clray(scratch, saving, environment).status == 0);
    const int calls = std::stoi(slurp(scratch / "total"));
    fs::remove(scratch / "total");
    fs::remove(scratch / "out.sums");
    environment[2] = "CLRAY_FAULT_KILLS=1";
    environment.emplace_back();
    const int most = all || calls < 8 ? calls : 8;
    REQUIRE(most > 2);
    int left = 0;
    for (int k = 1; k <= most; ++k) {
      const int at = most == calls ? k : 1 + static_cast<int>(random() % static_cast<unsigned>(calls));
      CAPTURE(part);
      CAPTURE(at);
      environment[3] = "CLRAY_FAULT_AT=" + std::to_string(at);
      REQUIRE(clray(scratch, saving, environment).status == 128 + SIGKILL);
      left += static_cast<int>(names(scratch).size() > kOwn.size());
      const auto next = clray(scratch, whole);
      CAPTURE(next.err);
      REQUIRE(next.status == 0);
      CHECK(names(scratch) == kOwn);
    }
    CHECK(left > 0);
  }
}
