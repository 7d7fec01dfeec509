// SPDX-License-Identifier: Apache-2.0
// Whole laser-ranging runs: beside other detectors, with names of every kind, at any time, and what is refused before
// anything is traced.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.hpp"

using namespace cli_test;

namespace {

const std::string kBall =
    "[[material]]\nname = \"m\"\nmodel = \"lambert\"\nrho = 0.5\n"
    "[[component]]\nshape = \"sphere\"\nradius = 1\nmaterial = \"m\"\n";

nlohmann::json summary_of(const Scratch& scratch, const std::string& folder) {
  return nlohmann::json::parse(slurp(scratch / (folder + "/summary.json")));
}

Outcome traced(const Scratch& scratch, const std::string& scene, const std::string& folder) {
  spit(scratch / "s.toml", scene);
  return clray(scratch, {"--device", "cpu", "--rays", "65536", "--no-plots", "--out", folder, "s.toml"});
}

}  // namespace

TEST_CASE("a session and a grid of pressure directions in one run: each as alone") {
  const Scratch scratch;
  const std::string session =
      "[station]\nrate_Hz = 10\n[motion]\naxis = [0, 0, 1]\nperiod_s = 8\nstop_s = 8\nstep_deg = 90\n"
      "[[detector]]\nkind = \"delay\"\n";
  const std::string grid = "[[detector]]\nkind = \"pressure\"\nazimuth_steps = 4\nelevation_steps = 3\n";
  REQUIRE(traced(scratch, kBall + session + grid, "both").status == 0);
  REQUIRE(traced(scratch, kBall + session, "alone").status == 0);
  const auto both = summary_of(scratch, "both"), alone = summary_of(scratch, "alone");
  CHECK(both["session"] == alone["session"]);
  CHECK(both["session"]["shots"] == 80);
  CHECK(both["detectors"]["delay"] == alone["detectors"]["delay"]);
  CHECK(both["detectors"]["pressure"]["orientations"].size() == 6);  // four at the equator and two poles
  const auto rows = [&](const std::string& folder) {
    const std::string csv = slurp(scratch / (folder + "/observations.csv"));
    return csv.substr(csv.find("epoch_s,"));
  };
  CHECK(rows("both") == rows("alone"));
}

TEST_CASE("the terminal and the summary tell the same of a session; each session has its files") {
  const Scratch scratch;
  const std::string like =
      "[[variant]]\nname = \"a b\"\nmaterial = [{ name = \"m\", rho = 1 }]\n"
      "[[variant]]\nname = \"a-b\"\nmaterial = [{ name = \"m\", rho = 0.25 }]\n"
      "[[variant]]\nname = \"" +
      std::string(250, 'x') + "\"\nmaterial = [{ name = \"m\", rho = 0 }]\n";
  const Outcome run = traced(scratch,
                             kBall + like +
                                 "[station]\nrate_Hz = 100\n[motion]\naxis = [0, 0, 1]\nperiod_s = 20\n"
                                 "stop_s = 1\nstep_deg = 90\n",
                             "out");
  REQUIRE(run.status == 0);
  const auto summary = summary_of(scratch, "out");
  REQUIRE(summary["session"].size() == 3);
  CHECK(summary["session"]["a b"]["mean_cross_section_m2"].get<double>() == doctest::Approx(8.37758).epsilon(1e-3));
  CHECK(summary["session"]["a-b"]["mean_cross_section_m2"].get<double>() == doctest::Approx(2.09440).epsilon(1e-3));
  for (const auto& one : summary["session"].items()) {
    const auto& name = one.key();
    const auto& session = one.value();
    CAPTURE(name);
    std::ostringstream shown;
    shown << session["mean_cross_section_m2"].get<double>();  // six digits
    CHECK(contains(run.out, shown.str() + " m^2"));
    CHECK(session["mean_cross_section_m2"] == session["link"]["cross-section"]["value"]);
  }
  int tables = 0;
  for (const auto& file : summary["files"]) {
    tables += contains(file.get<std::string>(), "observations") && contains(file.get<std::string>(), ".csv");
    CHECK(scratch.has("out/" + file.get<std::string>()));
  }
  CHECK(tables == 3);
}

TEST_CASE("what a station lacks is found by --check, and before anything is traced") {
  const Scratch scratch;
  spit(scratch / "r.csv", "time_s,range_m\n0,1e6\n10,2e6\n");
  spit(scratch / "s.toml", kBall +
                               "[station]\nranges = \"r.csv\"\n[motion]\naxis = [0, 0, 1]\nperiod_s = 20\n"
                               "stop_s = 20\nstep_deg = 90\n");
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--check", "s.toml"}, {"s.toml"}}) {
    const Outcome run = clray(scratch, arguments);
    CHECK(run.status == 3);
    CHECK(
        contains(run.err, "s.toml:10:10: station.ranges: the table covers 0 s to 10 s; the motion needs 0 s to 20 s"));
    CHECK_FALSE(scratch.has("clray-out"));
  }
}
