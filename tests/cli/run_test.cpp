// SPDX-License-Identifier: Apache-2.0
// The program from mesh to files: the closing table, the result folder, quiet and explained runs, the kernel's
// source, determinism, and signals.
#include <doctest/doctest.h>

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

TEST_CASE("what the body decides of a scene is said with its place in the file, before tracing") {
  const Scratch scratch;
  const std::string box = "[[component]]\nshape = \"box\"\nsize = [1, 1, 1]\n[source]\ndirection = [0, 0, 1]\n";
  const auto said = [&](const std::string& more, const std::vector<std::string>& options = {}) {
    spit(scratch / "scene.toml", box + more);
    std::vector<std::string> arguments{"--device", "cpu", "scene.toml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto outcome = clray(scratch, arguments);
    CHECK(outcome.status == 3);
    CHECK_FALSE(scratch.has("clray-out"));
    return outcome.err;
  };
  CHECK(contains(said("[[detector]]\nkind = \"delay\"\nstart_ns = 100\n"),
                 "clray: scene.toml:8:12: detector.start_ns: the delay window is empty"));
  CHECK(contains(said("[[detector]]\nkind = \"delay\"\nbin_ps = 1e-9\n"),
                 "clray: scene.toml:8:10: detector.bin_ps: 1e-09 ps makes"));
  const std::string ball = "[[component]]\nshape = \"cylinder\"\nradius = 1\nheight = 1\n";
  CHECK(contains(said(ball + "[trace]\nmethod = \"tiles\"\n"),
                 "clray: scene.toml:11:10: trace.method: method = \"tiles\" is not possible for the detector delay"));
  // The command line says it, so the file is all there is to name.
  CHECK(contains(said(ball, {"--method", "tiles"}),
                 "clray: scene.toml: trace.method: method = \"tiles\" is not possible for the detector delay"));
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
  // Tilted: the outline is met by chance, so that other seeds give other totals. A = rho/pi * area * mu^2.
  const std::vector<std::string> tilted{"--source", "1,0.3,2", "--no-plots"};
  const auto traced = [&](std::vector<std::string> more) {
    more.insert(more.end(), tilted.begin(), tilted.end());
    return clray(scratch, run_of(more));
  };
  REQUIRE(traced({"--out", "first"}).status == 0);
  const double first = summary(scratch, "first")["detectors"]["delay"]["intensity_m2_per_sr"];
  for (const char* file : {"first/summary.json", "first/delay.csv"}) {
    CAPTURE(file);
    const auto same = traced({"--out", "second", "--reference", file});
    CHECK(same.status == 0);
    CHECK(contains(same.out, "\n  true error     0 % against " + std::string(file)));
    CHECK(summary(scratch, "second")["relative_true_error"].get<double>() == 0.0);  // same seed, same result

    const auto other = traced({"--out", "third", "--seed", "2", "--sampler", "random", "--reference", file});
    CHECK(other.status == 0);
    const auto third = summary(scratch, "third");
    const double value = third["detectors"]["delay"]["intensity_m2_per_sr"];
    const double wanted = std::fabs(value - first) / first;
    CHECK(wanted > 0.0);
    CHECK(third["relative_true_error"].get<double>() == doctest::Approx(wanted).epsilon(1e-12));
    CHECK_FALSE(contains(other.out, "true error     0 %"));
    const std::string table = slurp(scratch / "third/error.csv");
    CHECK(contains(table, "\nrays,seconds,relative_standard_error,relative_true_error,phase\n"));
    // The last row is the result: its true error is the summary's.
    const std::string last = table.substr(table.rfind('\n', table.size() - 2) + 1);
    std::size_t at = 0;
    for (int comma = 0; comma < 3; ++comma) at = last.find(',', at) + 1;
    CHECK(std::stod(last.substr(at)) == doctest::Approx(wanted).epsilon(1e-12));
  }
}

TEST_CASE("a signal ends early: what is finished is saved and marked, status 128 + signal") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Scratch scratch;
    spit(scratch / "square.obj", square());
    // More rays than any machine finishes in the time given here.
    const Running running(scratch, {"--device", "cpu", "--rays", "2^36", "--checkpoint", "1", "--no-plots",
                                    "square.obj", "--out", "out"});
    REQUIRE(has_found_something(scratch));
    running.send(signal);
    const auto outcome = running.wait();
    CAPTURE(outcome.err);
    CHECK(outcome.status == 128 + signal);
    CHECK(contains(outcome.err, "interrupted"));
    REQUIRE(scratch.has("out/summary.json"));
    const auto result = summary(scratch, "out");
    CHECK(result.value("partial", false));
    CHECK(result["stopped_by"] == "interrupt");
    CHECK(result["rays"].get<double>() < std::pow(2.0, 36));
  }
}

TEST_CASE("where the folder of compiled kernels cannot be written, a temporary one serves and is gone afterwards") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  std::filesystem::create_directory(scratch / "tmp");
  const auto outcome =
      clray(scratch, run_of({"--no-plots"}), {"POCL_CACHE_DIR=/proc/nowhere", "TMPDIR=" + (scratch / "tmp")});
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(std::filesystem::is_empty(scratch / "tmp"));
}
