// SPDX-License-Identifier: Apache-2.0
// Pressure with several bounces, of which the first is solved; and convex bodies, which have no second one.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/trace.hpp"
#include "support/checks.hpp"
#include "support/corner.hpp"

using namespace clray_test;

TEST_CASE("force and torque: the first push is that of one bounce, and the sum agrees with points") {
  const clray::Vec3 s = toward(0.9, 0.4);
  const MeshPtr box_wing = merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})});
  clray::Scene scenes[] = {corner(lambert(0.8), mirror(0.7), s, 3), scene_of(box_wing, lambert(0.9))};
  monostatic(scenes[1], s);
  for (clray::Scene& scene : scenes) {
    scene.reference_point = {0.1, 0.2, 0.3};
    detect(scene, "pressure", {{"thermal", 1.0}});
    scene.trace.method = clray::Method::exact;
    scene.trace.max_bounces = 1;
    scene.trace.rays = 0;
    const clray::PressureResult once = run(scene).pressure.at(0);
    scene.trace.max_bounces = 3;
    const clray::PressureResult mixed = run(rays(scene, 16)).pressure.at(0);
    scene.trace.method = clray::Method::points;
    const clray::PressureResult points = run(scene).pressure.at(0);
    double errors[2] = {};
    for (const auto vector : {&clray::PressureResult::coefficient_m2, &clray::PressureResult::torque_coefficient_m3}) {
      const clray::VectorEstimate &first = once.*vector, &a = mixed.*vector, &b = points.*vector;
      CHECK(a.partly_exact());
      CHECK(a.rounding_bound > 0.0);
      for (int k = 0; k < 3; ++k) {
        CHECK(std::fabs(a.exact_part[k] - first.value[k]) <= 1e-12);
        CHECK(std::fabs(a.value[k] - b.value[k]) <= 4.0 * std::hypot(a.standard_error[k], b.standard_error[k]) + 1e-9);
        errors[0] += a.standard_error[k] * a.standard_error[k];
        errors[1] += b.standard_error[k] * b.standard_error[k];
      }
    }
    for (std::size_t part = 0; part < mixed.component_m2.size(); ++part) {
      const clray::VectorEstimate &a = mixed.component_m2[part], &b = points.component_m2[part];
      for (int k = 0; k < 3; ++k)
        CHECK(std::fabs(a.value[k] - b.value[k]) <= 4.0 * std::hypot(a.standard_error[k], b.standard_error[k]) + 1e-9);
    }
    INFO("standard errors ", std::sqrt(errors[0]), ", of points ", std::sqrt(errors[1]));
    CHECK(errors[0] < (scene.components.size() == 1 ? 0.5 : 1.0) * errors[1]);
    // Books are of the rays alone, whatever is solved.
    CHECK(std::fabs(mixed.absorbed_m2.value - points.absorbed_m2.value) <=
          4.0 * std::hypot(mixed.absorbed_m2.standard_error, points.absorbed_m2.standard_error));
  }
}

TEST_CASE("a grid of Sun directions with several bounces agrees with points") {
  const MeshPtr box_wing = merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})});
  clray::Scene scene = scene_of(box_wing, lambert(0.9));
  detect(scene, "pressure", {{"azimuth_steps", 4.0}, {"elevation_steps", 3.0}});
  scene.trace.max_bounces = 2;
  scene.trace.method = clray::Method::exact;
  const clray::Result mixed = run(rays(scene, 14));
  scene.trace.method = clray::Method::points;
  const clray::Result points = run(scene);
  REQUIRE(mixed.pressure.size() == points.pressure.size());
  for (std::size_t k = 0; k < mixed.pressure.size(); ++k) {
    const clray::VectorEstimate &a = mixed.pressure[k].coefficient_m2, &b = points.pressure[k].coefficient_m2;
    CHECK(a.partly_exact());
    for (int axis = 0; axis < 3; ++axis)
      CHECK(std::fabs(a.value[axis] - b.value[axis]) <=
            4.5 * std::hypot(a.standard_error[axis], b.standard_error[axis]) + 1e-9);
  }
}

TEST_CASE("light leaves a convex body at once: with any number of bounces all is exact") {
  const clray::Vec3 s = toward(0.6, 0.4);
  clray::Scene scene = scene_of(box_mesh(1.0, 2.0, 3.0), lambert(0.6));
  monostatic(scene, s);
  scene.detectors.push_back({"pressure", "pressure", {}});
  scene.trace.method = clray::Method::exact;
  scene.trace.rays = 0;
  const clray::Result once = run(scene);
  scene.trace.max_bounces = 4;
  const clray::Result result = run(scene);
  CHECK(result.delay.at(0).intensity_m2_per_sr.exact());
  CHECK(result.delay.at(0).intensity_m2_per_sr.value == once.delay.at(0).intensity_m2_per_sr.value);
  CHECK(result.pressure.at(0).coefficient_m2.value == once.pressure.at(0).coefficient_m2.value);
  CHECK(result.rays == 0);
  const double lit = std::fabs(s.x) * 6.0 + std::fabs(s.y) * 3.0 + std::fabs(s.z) * 2.0;
  const clray::EnergyBooks& books = result.energy.at(0);
  CHECK(books.incident_m2.value == relative(lit).epsilon(1e-12));
  CHECK(books.reflected_m2.value == relative(0.6 * lit).epsilon(1e-12));
  CHECK(books.absorbed_m2.value == relative(0.4 * lit).epsilon(1e-12));
  CHECK(books.truncated_m2.value == 0.0);
}
