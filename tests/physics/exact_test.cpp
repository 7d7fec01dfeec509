// SPDX-License-Identifier: Apache-2.0
// The exact method in scenes: what it takes and refuses, variants and windows, force and torque, the automatic choice.
// Closed forms stand in exact_forms_test.cpp, soups and comparisons with points in exact_soups_test.cpp.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/error.hpp"
#include "support/exact_checks.hpp"

using namespace clray_test;

TEST_CASE("box, rectangle and hinged shapes count as polygons, curved shapes do not") {
  clray::Scene box = scene_of("box", {{"size_x", 1.0}, {"size_y", 2.0}, {"size_z", 3.0}}, lambert(0.6));
  monostatic(box, toward(0.9, 0.5));
  check_exact(solve(box),
              convex_lambert(*box_mesh(1.0, 2.0, 3.0), 0.6, toward(0.9, 0.5), toward(0.9, 0.5)).total_m2_per_sr);
  clray::Scene sphere = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  CHECK_THROWS_WITH_AS(solve(sphere), doctest::Contains("every shape is curved"), clray::Error);
  clray::Scene rayed = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  rayed.trace.method = clray::Method::exact;
  CHECK_THROWS_WITH_AS(run(rayed), doctest::Contains("rays"), clray::Error);
}

TEST_CASE("variants, bands and several windows are those of runs alone") {
  clray::Scene scene = lambert_scene(mesh_of(soup(3, 50, 0.8)), toward(0.2, 0.1));
  clray::Variant dull{"dull", {scene.materials.front()}};
  dull.materials.front().parameters["rho"] = 0.25;
  scene.variants = {{"as is", {}}, dull};
  scene.detectors.push_back({"delay", "fine", {{"bins", 64.0}, {"start_ns", -2.0}, {"stop_ns", 1.0}}});
  const clray::Result both = solve(scene);
  REQUIRE(both.delay.size() == 4);
  for (const clray::DelayResult& d : both.delay) {
    const double rho = d.key.variant == "dull" ? 0.25 : 0.5;
    clray::Scene alone = lambert_scene(mesh_of(soup(3, 50, 0.8)), toward(0.2, 0.1), rho);
    if (d.key.detector == "fine") alone.detectors = {scene.detectors.back()};
    const clray::DelayResult single = solve(alone).delay.at(0);
    CHECK(d.intensity_m2_per_sr.value == relative(single.intensity_m2_per_sr.value).epsilon(1e-15));
    for (std::size_t b = 0; b < single.bin_m2_per_sr.size(); ++b)
      CHECK(std::fabs(d.bin_m2_per_sr[b] - single.bin_m2_per_sr[b]) <= 1e-15 * single.intensity_m2_per_sr.value);
  }
}

TEST_CASE("automatic takes the exact method where it can, and rays where they are asked for") {
  clray::Scene scene = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  scene.trace.method = clray::Method::automatic;
  scene.trace.rays = 0;
  CHECK(total(run(scene)).exact());
  scene.trace.target_error_percent = 0.5;
  const clray::Result reached = run(scene);
  CHECK(total(reached).exact());
  CHECK(reached.target_reached);
  CHECK(reached.stopped_by == "exact");
  rays(scene, 14);
  CHECK(!total(run(scene)).exact());
}

TEST_CASE("force and torque on plates and boxes against closed forms, even and mirroring") {
  const clray::Vec3 s = toward(0.7, 0.4), n(0.0, 0.0, 1.0);
  const double mu = s.z, area = 2.0 * mu, rho = 0.6;
  for (const bool shiny : {false, true}) {
    CAPTURE(shiny);
    clray::Scene scene = scene_of(moved(plate_mesh(2.0, 1.0), {0.5, -0.25, 0.125}), shiny ? mirror(rho) : lambert(rho));
    monostatic(scene, s);
    detect(scene, "pressure");
    const clray::Result result = solve(scene);
    const clray::PressureResult& p = result.pressure.at(0);
    const clray::Vec3 sent = shiny ? rho * (2.0 * mu * n - s) : 2.0 / 3.0 * rho * n;
    const clray::Vec3 force = area * (-s - sent), r(0.5, -0.25, 0.125);
    const clray::Vec3 torque(r.y * force.z - r.z * force.y, r.z * force.x - r.x * force.z,
                             r.x * force.y - r.y * force.x);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::fabs(p.coefficient_m2.value[k] - force[k]) <= kExact * area);
      CHECK(std::fabs(p.torque_coefficient_m3.value[k] - torque[k]) <= kExact * area);
      CHECK(p.coefficient_m2.standard_error[k] == 0.0);
    }
    CHECK(p.coefficient_m2.rounding_bound < 1e-11 * area);
    CHECK(p.absorbed_m2.value == relative((1.0 - rho) * area).epsilon(kExact));
    const clray::EnergyBooks& books = result.energy.at(0);
    CHECK(books.incident_m2.value == relative(area).epsilon(kExact));
    CHECK(std::isnan(books.truncated_m2.value));
  }
}

TEST_CASE("a grid of Sun directions on a body that hides parts of itself agrees with points") {
  clray::Scene scene =
      scene_of(merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})}), lambert(0.4));
  scene.reference_point = {0.1, 0.2, 0.3};
  detect(scene, "pressure", {{"azimuth_steps", 6.0}, {"elevation_steps", 5.0}, {"thermal", 1.0}});
  const clray::Result exact = solve(scene);
  rays(scene, 16);
  const clray::Result points = run(scene);
  REQUIRE(points.pressure.size() == exact.pressure.size());
  for (std::size_t k = 0; k < exact.pressure.size(); ++k) {
    const clray::PressureResult &e = exact.pressure[k], &p = points.pressure[k];
    CHECK(e.sun == p.sun);
    for (int axis = 0; axis < 3; ++axis) {
      check_component(p.coefficient_m2.value[axis], p.coefficient_m2.standard_error[axis], e.coefficient_m2.value[axis],
                      1.0, 0.02, "force");
      check_component(p.torque_coefficient_m3.value[axis], p.torque_coefficient_m3.standard_error[axis],
                      e.torque_coefficient_m3.value[axis], 1.0, 0.05, "torque");
    }
  }
}

TEST_CASE("detectors that are found in different ways share one set of books") {
  // The push on mirrors is solved, and what they send to an observer rays must find: two passes, each with books.
  clray::Scene scene = lambert_scene(plate_mesh(2.0, 1.0), toward(0.4));
  add(scene, moved(plate_mesh(1.0, 1.0), {3.0, 0.0, 0.0}), mirror(0.9));
  scene.detectors.push_back({"pressure", "push", {}});
  scene.trace.method = clray::Method::automatic;
  scene.trace.rays = 0;
  const clray::Result result = run(scene);
  REQUIRE(result.energy.size() == 1);
  CHECK(!std::isnan(result.energy.front().truncated_m2.value));
  check_estimate(result.energy.front().incident_m2, 3.0 * std::cos(0.4), 1e-3, "incident");
}
