// SPDX-License-Identifier: Apache-2.0
// The delay camera on meshes against closed forms: Lambert plates up to grazing light, and convex polyhedra
// (inscribed spheres and cylinders) against their facet sums. Within 4 standard errors and 0.05 % of the total.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"

using namespace clray_test;

TEST_CASE("Lambert plate at 0, 37, 80 and 89.9 degrees: total, uniform depth, moments") {
  for (double degrees : {0.0, 37.0, 80.0, 89.9}) {
    CAPTURE(degrees);
    const double tilt = radians(degrees), rho = 0.5, a = 2.0, b = 1.0;
    clray::Scene scene = scene_of(plate_mesh(a, b), lambert(rho));
    monostatic(scene, toward(tilt));
    const clray::Result result = run(scene);
    const clray::DelayResult& found = result.delay.at(0);
    const Pulse exact = lambert_plate(rho, a, b, tilt);
    check_estimate(found.intensity_m2_per_sr, exact.total_m2_per_sr, 5e-4, "plate", 1.0 / std::cos(tilt));
    const double length_s = 2.0 * a * std::sin(tilt) / kLightSpeed;
    const double scale_s = 2.0 * a / kLightSpeed;
    check_component(found.mean_delay_s.value, found.mean_delay_s.standard_error, 0.0, scale_s, 1e-3, "mean delay");
    // The width is the root of a difference of squares: an error q of those is sqrt(q) where the width is zero.
    if (degrees > 0.0)
      check_component(found.rms_width_s.value, found.rms_width_s.standard_error, length_s / std::sqrt(12.0), scale_s,
                      1e-3, "rms width");
    if (degrees == 0.0) CHECK(found.rms_width_s.value <= 1e-5 * scale_s);
    if (degrees > 0.0)
      check_bins(found, exact, result.rays, result.replicates, a * b * std::cos(tilt), rho / kPi * std::cos(tilt),
                 "plate");
  }
}

TEST_CASE("a plate off the origin comes back by its distance") {
  clray::Scene scene = scene_of(moved(plate_mesh(1, 1), {0, 0, 7.5}), lambert(1.0));
  const clray::Result result = run(scene);
  CHECK(result.delay.at(0).mean_delay_s.value == relative(-15.0 / kLightSpeed).epsilon(1e-9));
  scene.reference_point = {0, 0, 7.0};
  CHECK(run(scene).delay.at(0).mean_delay_s.value == relative(-1.0 / kLightSpeed).epsilon(1e-9));
}

TEST_CASE("convex polyhedra, monostatic, against their facet sums") {
  struct Body {
    const char* name;
    MeshPtr mesh;
  };
  const Body bodies[] = {{"sphere 64 x 32", sphere_mesh(64, 32, 1.0)},
                         {"cylinder of 128 sides", prism_mesh(128, 1.0, 3.0)},
                         {"hexagonal prism", prism_mesh(6, 1.0, 1.0)},
                         {"box", box_mesh(1.0, 2.0, 3.0)},
                         {"cone of 96 sides", cone_mesh(96, 1.0, 2.0)}};
  for (const Body& body : bodies)
    for (const clray::Vec3& s : {toward(0.0), toward(0.9, 0.5), toward(kPi / 2, 0.3), toward(2.5, -2.0)}) {
      clray::Scene scene = scene_of(body.mesh, lambert(0.6));
      monostatic(scene, s);
      many_rays(scene, 19);
      const clray::Result result = run(scene);
      const Pulse exact = convex_lambert(*body.mesh, 0.6, s, s);
      const clray::DelayResult& found = result.delay.at(0);
      check_estimate(found.intensity_m2_per_sr, exact.total_m2_per_sr, 5e-4, body.name);
      // Facets that face the light exactly have all their light in one delay: a step of the CDF, whose bin is
      // decided by the last bit. Only tilted views are compared bin by bin.
      if (s.z < 0.99 && std::fabs(s.z) > 1e-3)
        check_bins(found, exact, result.rays, result.replicates, body.mesh->report.area_m2, 0.6 / kPi, body.name);
    }
}

TEST_CASE("convex polyhedra, bistatic, against facets both lit and seen") {
  const MeshPtr meshes[] = {sphere_mesh(64, 32, 1.0), prism_mesh(128, 1.0, 3.0), box_mesh(1.0, 2.0, 3.0)};
  for (const MeshPtr& mesh : meshes)
    for (const clray::Vec3& o : {toward(0.5, 1.5), toward(1.6, -0.4)}) {
      const clray::Vec3 s = toward(0.9, 0.5);
      clray::Scene scene = scene_of(mesh, lambert(0.6));
      bistatic(scene, s, o);
      many_rays(scene, 21);
      const clray::Result result = run(scene);
      const Pulse exact = convex_lambert(*mesh, 0.6, s, o);
      check_estimate(result.delay.at(0).intensity_m2_per_sr, exact.total_m2_per_sr, 5e-4, "bistatic polyhedron");
      check_bins(result.delay.at(0), exact, result.rays, result.replicates, mesh->report.area_m2, 0.6 / kPi,
                 "bistatic polyhedron");
    }
}

TEST_CASE("monostatic light needs no shadow rays: forced ones change no bit") {
  for (const MeshPtr& mesh : {box_mesh(1, 2, 3), merged({box_mesh(1, 1, 1), moved(plate_mesh(4, 1), {0, 0, 0.7})})}) {
    clray::Scene scene = scene_of(mesh, ashikhmin_shirley(0.5, 0.2, 50));
    monostatic(scene, toward(0.9, 0.5));
    const clray::Result plain = run(scene);
    scene.trace.force_bistatic = true;
    const clray::Result forced = run(scene);
    CHECK(plain.digest == forced.digest);
    CHECK(plain.delay.at(0).bin_m2_per_sr == forced.delay.at(0).bin_m2_per_sr);
  }
}

TEST_CASE("shadow: a floor behind a wall is lit, or seen, by the share the wall leaves") {
  const double theta = radians(40.0);
  const clray::Vec3 slant = toward(theta), above{0, 0, 1};
  for (const bool lit_from_above : {false, true}) {
    clray::Scene scene = scene_of(plate_mesh(1, 1), lambert(1.0));
    clray::Component& wall = add(scene, plate_mesh(0.5, 1), lambert(0.0));
    wall.transform.axis = {0, 1, 0};
    wall.transform.angle_rad = radians(90.0);
    wall.transform.translate = {0.5, 0, 0.25};
    lit_from_above ? bistatic(scene, above, slant) : bistatic(scene, slant, above);
    many_rays(scene, 20);
    const double exact = std::cos(theta) / kPi * (1.0 - 0.5 * std::tan(theta));
    check_estimate(run(scene).delay.at(0).intensity_m2_per_sr, exact, 5e-4, "floor behind a wall");
  }
}

TEST_CASE("a window so far away that its bins up to the body cannot be counted leaves all light below it") {
  const double tilt = radians(37.0);
  clray::Scene scene = scene_of(plate_mesh(2.0, 1.0), lambert(0.5));
  monostatic(scene, toward(tilt));
  scene.detectors = {{"delay", "", {{"start_ns", 1e18}, {"stop_ns", 1.0001e18}, {"bins", 1e6}}}};
  scene.trace.method = clray::Method::points;
  const clray::DelayResult found = run(scene).delay.at(0);
  check_estimate(found.intensity_m2_per_sr, lambert_plate(0.5, 2.0, 1.0, tilt).total_m2_per_sr, 5e-4, "plate",
                 1.0 / std::cos(tilt));
  CHECK(found.below_m2_per_sr == relative(found.intensity_m2_per_sr.value).epsilon(1e-9));
}

TEST_CASE("an empty view gives zeros, no error and a warning") {
  clray::Scene scene = scene_of(plate_mesh(1, 1), lambert(1.0));
  monostatic(scene, {1, 0, 0});  // edge-on exactly
  const clray::Result result = run(scene);
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  CHECK(a.value == 0.0);
  CHECK(a.standard_error == 0.0);
  CHECK(!result.warnings.empty());
}
