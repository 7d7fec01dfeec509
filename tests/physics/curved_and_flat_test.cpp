// SPDX-License-Identifier: Apache-2.0
// Flat faces solved beside curved shapes that rays find (docs/exact.md): a Lambert plate of many faces below a Lambert
// sphere, whose shadows fall on the plate or beside it. Closed forms: the sphere's phase function (Lambert 1760, ch. 8)
// and the ellipses that the sphere covers on the plate toward the source and toward the observer.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "support/checks.hpp"
#include "support/scenes.hpp"

using namespace clray_test;
using clray::Scene;
using clray::Vec3;

namespace {

constexpr double kSide = 8.0, kRadius = 0.4, kHeight = 2.0, kPlate = 0.6, kSphere = 0.3;

/// A plate of `cells` by `cells` squares in z = 0, centred, that looks up.
MeshPtr tiled_plate(int cells) {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  const double step = kSide / cells;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) mesh->vertices.push_back({x * step - 0.5 * kSide, y * step - 0.5 * kSide, 0.0});
  }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (cells + 1) + x); };
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      mesh->triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh->triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
      mesh->triangle_slot.insert(mesh->triangle_slot.end(), {0, 0});
    }
  }
  return mesh;
}

Scene plate_and_sphere() {
  Scene scene = scene_of(tiled_plate(24), lambert(kPlate));
  // Rays that are asked for ask for points. A target that nobody meets takes as many.
  scene.trace.method = clray::Method::automatic;
  scene.trace.rays = 0;
  scene.trace.target_error_percent = 1e-9;
  scene.trace.max_rays = 1u << 17;
  scene.materials.push_back(lambert(kSphere));
  scene.materials.back().name = "ball";
  clray::Component ball;
  ball.name = "ball";
  ball.shape = "sphere";
  ball.parameters["radius"] = kRadius;
  ball.materials = {1};
  ball.transform.translate = {0.3, -0.2, kHeight};
  scene.components.push_back(ball);
  return scene;
}

/// Radiant intensity over irradiance of both, where the sphere's two shadows fall on the plate and apart, or are one.
double expected(const Vec3& source, const Vec3& observer) {
  const double cosine = source.x * observer.x + source.y * observer.y + source.z * observer.z;
  const double phase = std::acos(std::min(1.0, cosine));
  const double sphere =
      2.0 / (3.0 * kPi) * kSphere * kRadius * kRadius * (std::sin(phase) + (kPi - phase) * std::cos(phase));
  const double circle = kPi * kRadius * kRadius;
  const double shadows = circle / source.z + (phase > 0.0 ? circle / observer.z : 0.0);
  return sphere + kPlate / kPi * source.z * observer.z * (kSide * kSide - shadows);
}

}  // namespace

TEST_CASE("a sphere above a plate: most of the plate is exact, rays find the sphere and what it may shade") {
  for (const auto& one : {std::pair(toward(0.0), toward(0.0)), std::pair(toward(0.6, 0.3), toward(0.6, 0.3)),
                          std::pair(toward(0.5, 0.2), toward(0.4, 2.4))}) {
    const auto& source = one.first;
    const auto& observer = one.second;
    CAPTURE(source.x);
    CAPTURE(observer.x);
    Scene scene = plate_and_sphere();
    bistatic(scene, source, observer);
    scene.detectors.push_back({"spectrometer", "spectrometer", {}});
    const double truth = expected(source, observer);
    const clray::Result solved = run(scene);
    const clray::Estimate& a = solved.delay.at(0).intensity_m2_per_sr;
    CHECK(a.partly_exact());
    // A cell of the grid across the beam is 1/64 of the body's size, some 0.18 m: at most a quarter of the plate is
    // within one of the shadows' rectangles (0.8 m, and 1.2 m along the slope) and the faces (0.33 m) that meet them.
    CHECK(a.exact_part > 0.75 * kPlate / kPi * source.z * observer.z * kSide * kSide);
    CHECK(a.exact_part < truth);
    check_estimate(a, truth, 1e-3, "plate and sphere");
    CHECK(solved.spectrometer.at(0).intensity_m2_per_sr.value == a.value);
    double sum = solved.delay.at(0).below_m2_per_sr + solved.delay.at(0).above_m2_per_sr;
    for (const double bin : solved.delay.at(0).bin_m2_per_sr) sum += bin;
    CHECK(sum == relative(a.value).epsilon(1e-12));
    scene.trace.method = clray::Method::points;
    const clray::Estimate points = run(scene).delay.at(0).intensity_m2_per_sr;
    CHECK(!points.partly_exact());
    CHECK(std::fabs(points.value - a.value) < 5.0 * std::hypot(points.standard_error, a.standard_error));
  }
}

TEST_CASE("what is solved beside curved shapes follows them: hinged parts, several views, more bounces") {
  Scene scene = plate_and_sphere();
  scene.trace.max_bounces = 3;
  scene.views.clear();
  for (const double tilt : {0.1, 0.5, 0.9}) {
    clray::Orientation view;
    view.source = toward(tilt, 1.0);
    view.observers = {view.source};
    scene.views.push_back(view);
  }
  const clray::Result solved = run(scene);
  scene.trace.method = clray::Method::points;
  const clray::Result points = run(scene);
  REQUIRE(solved.delay.size() == points.delay.size());
  for (std::size_t v = 0; v < solved.delay.size(); ++v) {
    const clray::Estimate &a = solved.delay[v].intensity_m2_per_sr, &b = points.delay[v].intensity_m2_per_sr;
    CHECK(a.partly_exact());
    CHECK(std::fabs(a.value - b.value) < 5.0 * std::hypot(a.standard_error, b.standard_error));
  }
}

TEST_CASE("a curved shape before everything leaves nothing to solve, and one behind everything takes nothing away") {
  Scene scene = plate_and_sphere();
  clray::Component& ball = scene.components.back();
  ball.parameters["radius"] = 30.0;
  ball.transform.translate = {0.0, 0.0, 40.0};
  monostatic(scene, toward(0.0));
  const clray::Estimate before = run(scene).delay.at(0).intensity_m2_per_sr;
  CHECK(before.exact_part == 0.0);
  check_estimate(before, 2.0 / 3.0 * kSphere * 900.0, 1e-3, "the ball alone");
  ball.transform.translate.z = -40.0;
  const clray::Estimate behind = run(scene).delay.at(0).intensity_m2_per_sr;
  CHECK(behind.exact_part == relative(kPlate / kPi * kSide * kSide).epsilon(1e-12));
}

TEST_CASE("a small glossy face that no ray met is warned of, alone among large ones or beside what is solved") {
  const clray::Material glossy = ashikhmin_shirley(0.9, 0.0, 1e5);
  const auto warned = [](const clray::Scene& scene) {
    const clray::Result r = run(scene);
    return std::any_of(r.warnings.begin(), r.warnings.end(),
                       [](const std::string& w) { return w.find("may have missed") != std::string::npos; });
  };
  for (const bool round : {false, true}) {
    CAPTURE(round);
    clray::Scene scene = scene_of(plate_mesh(2.0, 2.0), lambert(0.3));
    const double half = 1e-3;  // of 2^14 rays on 4 m² none comes to 4 mm²
    clray::Component& facet =
        round ? add(scene, "disk", {{"radius", half}}, glossy) : add(scene, plate_mesh(2.0 * half, 2.0 * half), glossy);
    facet.transform.translate = {0.331, 0.217, 0.2};
    monostatic(scene, {0, 0, 1});
    rays(scene, 14);
    scene.trace.method = round ? clray::Method::exact : clray::Method::points;
    CHECK(warned(scene));
    // A facet that spans the plate is met by all.
    scene.components[1] = scene.components[0];
    scene.components[1].name = "facet";
    scene.components[1].materials = {1};
    scene.components[1].transform.translate = {0.0, 0.0, 0.2};
    scene.trace.method = clray::Method::points;
    CHECK_FALSE(warned(scene));
  }
}
