// SPDX-License-Identifier: Apache-2.0
// A device that fails at any one launch: the others do its share, to the same digest, and it is said. With none left
// what was found before is saved. And one that runs smaller work-groups than are asked for.
// tests/support/device_faults.cpp makes devices fail.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

std::string digest(const Scratch& scratch) {
  return nlohmann::json::parse(slurp(scratch / "out/summary.json"))["digest"];
}

Outcome run(const Scratch& scratch, const char* device, long failing_launch, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"--device", device, "--out", "out", "--no-plots"});
  return clray(
      scratch, arguments,
      {std::string("LD_PRELOAD=") + CLRAY_FAULTS, "POCL_DEVICES=pthread basic",
       "CLRAY_FAULT_LAUNCHES=" + (scratch / "launches"), "CLRAY_FAULT_LAUNCH=" + std::to_string(failing_launch)});
}

}  // namespace

Outcome traced(const Scratch& scratch, const char* device, long failing_launch, std::vector<std::string> more = {}) {
  more.insert(more.begin(),
              {"--method", "points", "--rays", "32768", "--seed", "3", "--checkpoint", "0.01", "square.obj"});
  return run(scratch, device, failing_launch, more);
}

/// A sheet of n by n squares, each at a height of its own: so many that an exact run needs several launches.
std::string sheet(int n) {
  std::string text;
  for (int i = 0; i < n * n; ++i) {
    const double x = i % n, y = i / n, z = 0.3 * (i % 7);
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      text += fmt::format("v {} {} {}\n", x + dx, y + dy, z);
    text += "f -4 -3 -2 -1\n";
  }
  return text;
}

TEST_CASE("a device that fails is left out and said, the other does its share, and the digest is the same") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const Outcome whole = traced(scratch, "all", 0);
  CAPTURE(whole.err);
  REQUIRE(whole.status == 0);
  CHECK_FALSE(contains(whole.err, "left out"));
  const std::string before = digest(scratch);
  const bool all = ::getenv("CLRAY_LONG_TESTS") != nullptr;
  std::mt19937 random(11);
  for (const long launch : {1l, 2l, 3l + static_cast<long>(random() % 4), 7l + static_cast<long>(random() % 4)}) {
    CAPTURE(launch);
    const Outcome outcome = traced(scratch, "all", launch);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(contains(outcome.err, "failed and is left out; the other devices do its share"));
    CHECK(digest(scratch) == before);
    if (!all && launch > 2) break;
  }
}

TEST_CASE("exact pulses and tiles: what a device that fails has taken the others solve again, to the same digest") {
  const Scratch scratch;
  const bool all = ::getenv("CLRAY_LONG_TESTS") != nullptr;
  spit(scratch / "sheet.obj", all ? sheet(150) : square());
  std::vector<std::vector<std::string>> methods{{"--method", "exact", "sheet.obj"},
                                                {"--method", "tiles", "--rays", "2048", "sheet.obj"}};
  if (all) methods.push_back({"--method", "exact", "--observer", "0.3,0.1,1", "sheet.obj"});
  for (const std::vector<std::string>& method : methods) {
    const Outcome whole = run(scratch, "all", 0, method);
    CAPTURE(whole.err);
    REQUIRE(whole.status == 0);
    CHECK_FALSE(contains(whole.err, "left out"));
    const std::string before = digest(scratch);
    const long launches = std::stol(slurp(scratch / "launches"));
    REQUIRE(launches >= (all ? 2 : 1));
    for (const long launch : {1l, 2l, 3l, 5l}) {
      if (launch > launches || (!all && launch > 1)) break;
      CAPTURE(method[1]);
      CAPTURE(launch);
      const Outcome outcome = run(scratch, "all", launch, method);
      CAPTURE(outcome.err);
      CHECK(outcome.status == 0);
      CHECK(contains(outcome.err, "failed and is left out; the other devices do its share"));
      CHECK(digest(scratch) == before);
    }
  }
}

TEST_CASE("with no device left the run ends with status 4, and resumes to the digest of a whole run") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  REQUIRE(traced(scratch, "cpu", 0).status == 0);
  const std::string whole = digest(scratch);
  std::filesystem::remove_all(scratch / "out");
  const Outcome failed = traced(scratch, "cpu", 2);
  CAPTURE(failed.err);
  CHECK(failed.status == 4);
  CHECK(contains(failed.err, "what was found before is saved: --resume goes on from it"));
  const Outcome resumed = traced(scratch, "cpu", 0, {"--resume", "out"});
  CAPTURE(resumed.err);
  CHECK(resumed.status == 0);
  CHECK(digest(scratch) == whole);
}

TEST_CASE("where nothing was found before the last device failed, nothing is saved and none is said to be") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  REQUIRE(traced(scratch, "cpu", 0).status == 0);  // now self-tests are remembered
  std::filesystem::remove_all(scratch / "out");
  const Outcome failed = traced(scratch, "cpu", 1);
  CAPTURE(failed.err);
  CHECK(failed.status == 4);
  CHECK_FALSE(contains(failed.err, "what was found before is saved"));
  CHECK_FALSE(scratch.has("out.sums"));
}

TEST_CASE("a device that runs smaller work-groups than are asked for is asked for those it runs") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  REQUIRE(traced(scratch, "cpu", 0).status == 0);
  const std::string whole = digest(scratch);
  const Outcome outcome = clray(scratch,
                                {"--device", "cpu", "--method", "points", "--rays", "32768", "--seed", "3", "--out",
                                 "out", "--no-plots", "--work-group", "256", "square.obj"},
                                {std::string("LD_PRELOAD=") + CLRAY_FAULTS, "CLRAY_FAULT_GROUP=24"});
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(digest(scratch) == whole);
}
