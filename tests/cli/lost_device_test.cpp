// SPDX-License-Identifier: Apache-2.0
// A device that fails at any one launch: the others do its share, to the same digest, and it is said. With none left
// what was found before is saved. And one that runs smaller work-groups than are asked for.
// tests/support/device_faults.cpp makes devices fail.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

std::string digest(const Scratch& scratch) {
  return nlohmann::json::parse(slurp(scratch / "out/summary.json"))["digest"];
}

Outcome traced(const Scratch& scratch, const char* device, long failing_launch, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"--device", device,  "--method", "points",     "--rays",       "32768", "--seed",
                                     "3",        "--out", "out",      "--no-plots", "--checkpoint", "0.01"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.push_back("square.obj");
  return clray(scratch, arguments,
               {std::string("LD_PRELOAD=") + CLRAY_FAULTS, "POCL_DEVICES=pthread basic",
                "CLRAY_FAULT_LAUNCH=" + std::to_string(failing_launch)});
}

}  // namespace

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
