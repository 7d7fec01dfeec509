// SPDX-License-Identifier: Apache-2.0
// A pass that an error ends begins with a program that stands soon, and goes on with its lasting one where rays take
// long. Sums are integers: they are those of one program, bit for bit.
#include <doctest/doctest.h>

#include <algorithm>

#include "clray/prepared.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_runner.hpp"
#include "support/closed_forms.hpp"
#include "support/scenes.hpp"

using namespace clray_test;

namespace {

clray::Scene open_bowl() {
  clray::Scene scene = scene_of(bowl_mesh(12, 5, 1.0, 1.2, 3.0), lambert(0.8));
  scene.trace.max_bounces = 3;
  scene.trace.rays = 0;
  scene.trace.target_error_percent = 5.0;
  return scene;
}

clray::OpenStep step_of(std::uint64_t from, std::uint64_t points) {
  clray::OpenStep step;
  step.from = from;
  step.points = points;
  step.views = {0};
  return step;
}

}  // namespace

TEST_CASE("sums found with a pass's first program, and more with its lasting one, are those of one program") {
  const clray::Scene scene = open_bowl();
  const clray::Geometry geometry = clray::build_geometry(scene);
  clray::PassPlan one = clray::plan_passes(scene, geometry).at(0), two = one;
  two.lasting = two.program;
  clray::set_walk("plain", &two);
  two.program.options.optimised = false;
  const auto go_on = [](double) { return true; };
  const std::uint64_t few = 64, many = (1u << 18) / one.request.replicates * 2;
  clray::Sums alone(one.layout), mixed(two.layout);
  clray::KeptPass kept_one, kept_two;
  {
    clray::PassRunner runner(device(), one, geometry, scene.trace, &kept_one);
    clray::OpenStep step = step_of(0, many);
    REQUIRE(runner.run(&alone, &step, go_on, {}));
  }
  {
    clray::PassRunner runner(device(), two, geometry, scene.trace, &kept_two);
    clray::OpenStep step = step_of(0, few);
    REQUIRE(runner.run(&mixed, &step, go_on, {}));
    CHECK(two.lasting.has_value());  // few rays: still the first program
  }
  const double built_s = [&] {
    clray::PassRunner runner(device(), two, geometry, scene.trace, &kept_two);
    const double before = runner.compile_seconds();
    clray::OpenStep step = step_of(few, many);
    REQUIRE(runner.run(&mixed, &step, go_on, {}));
    return runner.compile_seconds() - before;
  }();
  CHECK(built_s > 0.0);
  CHECK_FALSE(two.lasting.has_value());
  CHECK(two.program.options == one.program.options);
  CHECK(clray::digest_of(0, two, mixed) == clray::digest_of(0, one, alone));
  CHECK(mixed.points == alone.points);
}

TEST_CASE("a run with a target says which program it ended with, and has the digest of a Prepared, which optimises") {
  clray::Scene scene = open_bowl();
  const clray::Result soon = run(scene);
  clray::Prepared prepared(scene, device());
  const clray::Result late = prepared.trace();
  CHECK(soon.digest == late.digest);
  CHECK(soon.rays_total == late.rays_total);
  const auto says = [](const std::vector<std::string>& lines, const std::string& text) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& l) { return l.find(text) == 0; });
  };
  CHECK_FALSE(says(late.left_out, "the compiler's optimiser: "));
  // An earlier process may have kept the optimised program.
  if (says(soon.left_out, "the compiler's optimiser: ")) CHECK(says(soon.left_out, "packets of rays: "));
}
