// SPDX-License-Identifier: Apache-2.0
// The program from mesh to files: the closing table, the result folder, quiet and explained runs, the kernel's
// source, determinism, and signals.
#include <doctest/doctest.h>
#include <poll.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

nlohmann::json summary(const Scratch& scratch, const std::string& folder) {
  return nlohmann::json::parse(slurp(scratch / (folder + "/summary.json")));
}

std::vector<std::string> run_of(std::vector<std::string> more) {
  std::vector<std::string> arguments{"--device", "cpu", "--rays", "16384", "square.obj"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace

TEST_CASE("a mesh becomes a table and a folder of files") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto outcome = clray(scratch, run_of({}));
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  for (const char* row :
       {"device", "triangles", "rays", "time", "extent", "A ", "cross-section", "mean delay", "rms width", "files"}) {
    CAPTURE(row);
    CHECK(contains(outcome.out, std::string("\n  ") + row));
  }
  CHECK_FALSE(contains(outcome.err, "\r"));  // no progress bar where standard error is no terminal
  const auto result = summary(scratch, "clray-out/square");
  for (const auto& file : result["files"]) CHECK(scratch.has("clray-out/square/" + file.get<std::string>()));
  // Lambert 0.5 square on: A = rho/pi * area, exact to rounding of the fixed-point sums (2^-38).
  CHECK(result["detectors"]["delay"]["intensity_m2_per_sr"].get<double>() ==
        doctest::Approx(0.5 / 3.14159265358979323846).epsilon(1e-9));
}

TEST_CASE("options reach the run: seed, unit, bins, material") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto outcome = clray(scratch, run_of({"--seed", "7", "--length-unit", "cm", "--bins", "64", "--material",
                                              "lambert rho=1", "--no-plots", "--out", "one"}));
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  const auto result = summary(scratch, "one");
  CHECK(result["seed"] == 7);
  CHECK(result["detectors"]["delay"]["bins"] == 64);
  CHECK(result["detectors"]["delay"]["intensity_m2_per_sr"].get<double>() ==
        doctest::Approx(1e-4 / 3.14159265358979323846).epsilon(1e-9));
  CHECK_FALSE(scratch.has("one/delay.png"));
}

TEST_CASE("quiet says the device and the total; explain says what was left out") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto quiet = clray(scratch, run_of({"--quiet", "--no-plots"}));
  CHECK(quiet.status == 0);
  CHECK(quiet.out.rfind("device: ", 0) == 0);
  CHECK_FALSE(contains(quiet.out, "cross-section"));
  const auto explained = clray(scratch, run_of({"--explain", "--no-plots"}));
  CHECK(explained.status == 0);
  CHECK(contains(explained.out, "Left out:\n  - "));
}

TEST_CASE("the kernel's source is printed, nothing is traced") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto outcome = clray(scratch, run_of({"--dump-kernel"}));
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "kernel void"));
  CHECK_FALSE(scratch.has("clray-out"));
}

TEST_CASE("an unknown device is status 4") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto outcome = clray(scratch, {"--device", "no such device", "square.obj"});
  CHECK(outcome.status == 4);
  CHECK(contains(outcome.err, "no such device"));
  CHECK_FALSE(scratch.has("clray-out"));
}

TEST_CASE("a reference is measured against") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  REQUIRE(clray(scratch, run_of({"--out", "first", "--no-plots"})).status == 0);
  const auto outcome = clray(scratch, run_of({"--out", "second", "--no-plots", "--reference", "first/summary.json"}));
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "true error"));
  CHECK(summary(scratch, "second")["relative_true_error"].get<double>() == 0.0);  // same seed, same result
}

TEST_CASE("a signal ends early: what is finished is saved and marked, status 128 + signal") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Scratch scratch;
    spit(scratch / "square.obj", square());
    // More rays than any machine finishes in the time given here.
    const Running running(scratch, {"--device", "cpu", "--rays", "2^36", "--no-plots", "square.obj", "--out", "out"});
    ::poll(nullptr, 0, 8000);
    running.send(signal);
    const auto outcome = running.wait();
    CAPTURE(outcome.err);
    CHECK(outcome.status == 128 + signal);
    CHECK(contains(outcome.err, "interrupted"));
    REQUIRE(scratch.has("out/summary.json"));
    const auto result = summary(scratch, "out");
    CHECK(result.value("partial", false));
    CHECK(result["rays"].get<double>() < std::pow(2.0, 36));
  }
}
