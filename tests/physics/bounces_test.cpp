// SPDX-License-Identifier: Apache-2.0
// Multiple scattering against closed forms: the hemispherical bowl, the cavity with a hole, the mirror dihedral, and
// the energy books. Inside a sphere every patch sends the same share of its light to every other (form factor
// dA/4πR²), which makes all orders of scattering a geometric series.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"
#include "support/some.hpp"

using namespace clray_test;

namespace {

/// An inscribed mesh with steps of 2 pi/256 misses the sphere's areas by about h²/6 = 10⁻⁴; twice that is allowed.
constexpr double kFacets = 2e-4;

void check_near(const clray::Estimate& found, double exact, double bound, const char* what) {
  INFO(what, ": found ", found.value, " +- ", found.standard_error, ", exact ", exact);
  CHECK(std::fabs(found.value - exact) <= 4.0 * found.standard_error + kFacets * exact);
  CHECK(std::fabs(found.value - exact) <= bound * exact);
}

clray::Scene bowl(double rho, int bounces, int log2_rays) {
  clray::Scene scene = scene_of(bowl_mesh(256, 64, 1.0, kPi / 2, kPi), lambert(rho));
  scene.trace.max_bounces = bounces;
  return many_rays(scene, log2_rays);
}

void check_books(const clray::Result& result) {
  const clray::PathCounts& paths = result.paths;
  CHECK(paths.started == paths.escaped + paths.killed + paths.capped);
  CHECK(paths.started > 0);
  const clray::EnergyBooks& e = result.energy.at(0);
  const double out = e.absorbed_m2.value + e.reflected_m2.value + e.truncated_m2.value - e.roulette_m2.value;
  const double error = e.incident_m2.standard_error + e.absorbed_m2.standard_error + e.reflected_m2.standard_error +
                       e.truncated_m2.standard_error + e.roulette_m2.standard_error;
  INFO("incident ", e.incident_m2.value, ", accounted for ", out, " +- ", error);
  CHECK(e.incident_m2.value > 0.0);
  CHECK(std::fabs(e.incident_m2.value - out) <= 4.0 * error + 1e-9 * e.incident_m2.value);
  CHECK(result.diagnostics.non_finite == 0);
  CHECK(result.diagnostics.stack_overflow == 0);
  CHECK(result.diagnostics.accumulator_overflow == 0);
}

}  // namespace

TEST_CASE("Lambert bowl: intensity back to the station, one bounce, two, and all") {
  const double rho = 0.8;
  // Direct: as a sphere, 2 rho/3. Bounced light is even over the bowl: rho²/4 after one more bounce, each further
  // one rho/2 of the last.
  check_near(run(bowl(rho, 1, 18)).delay.at(0).intensity_m2_per_sr, 2.0 * rho / 3.0, 5e-4, "first bounce");
  check_near(run(bowl(rho, 2, 20)).delay.at(0).intensity_m2_per_sr, 2.0 * rho / 3.0 + rho * rho / 4.0, 1e-3,
             "two bounces");
  check_near(run(bowl(rho, 64, 20)).delay.at(0).intensity_m2_per_sr,
             2.0 * rho / 3.0 + rho * rho / 4.0 / (1.0 - rho / 2.0), 1e-3, "all bounces");
}

TEST_CASE("Lambert bowl: rho/2 of the light leaves at the first bounce, rho/(2 - rho) in all") {
  for (double rho : some(1, {0.8, 0.3, 1.0})) {
    CAPTURE(rho);
    const clray::Result two = run(bowl(rho, 2, 20));
    const double in = two.energy.at(0).incident_m2.value;
    CHECK(in == relative(kPi).epsilon(5e-4));
    check_near(two.energy.at(0).reflected_m2, in * (rho / 2.0 + rho * rho / 4.0), 1e-3, "reflected in two bounces");
    check_near(two.energy.at(0).truncated_m2, in * rho * rho / 4.0, 2e-3, "cut off after two bounces");
    CHECK(two.diagnostics.truncated_energy_fraction == relative(rho * rho / 4.0).epsilon(2e-3));
    check_books(two);
    const clray::Result all = run(bowl(rho, 64, 20));
    check_near(all.energy.at(0).reflected_m2, in * rho / (2.0 - rho), 1e-3, "reflected in all");
    check_books(all);
  }
}

TEST_CASE("Lambert cavity with a hole of share f: rho f/(1 - rho (1 - f)) comes out") {
  const double opening = radians(60.0), f = 0.5 * (1.0 - std::cos(opening));
  for (double rho : some(1, {0.9, 0.5})) {
    CAPTURE(rho);
    clray::Material inside = lambert(rho);
    inside.two_sided = false;  // the outside is black
    clray::Scene scene = scene_of(bowl_mesh(256, 128, 1.0, opening, kPi), inside);
    scene.trace.max_bounces = 64;
    many_rays(scene, 20);
    const clray::Result result = run(scene);
    const double enters = kPi * std::sin(opening) * std::sin(opening);
    check_near(result.energy.at(0).reflected_m2, enters * rho * f / (1.0 - rho * (1.0 - f)), 2e-3, "cavity");
    check_books(result);
  }
}

TEST_CASE("mirror dihedral of 90 degrees: all light comes back to the station, with one delay") {
  auto mesh = std::make_shared<clray::Mesh>();
  const double h = std::sqrt(0.5);
  for (double y : {-0.5, 0.5})
    for (const clray::Vec3& v : {clray::Vec3(-h, y, h), clray::Vec3(0, y, 0), clray::Vec3(h, y, h)})
      mesh->vertices.push_back(v);
  mesh->triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  mesh->triangle_slot = {0, 0, 0, 0};
  mesh->material_slots = {""};
  clray::Scene scene = scene_of(mesh, mirror(0.9));
  window(scene, -1.1e-9, 1.0e-9, 20);  // zero delay is inside bin 10
  scene.trace.max_bounces = 2;
  many_rays(scene, 18);
  const double half_angle = 0.01;
  scene.observers[0].acceptance_rad = half_angle;
  const clray::Result result = run(scene);
  const double solid_angle = 4.0 * kPi * std::pow(std::sin(half_angle / 2.0), 2);
  const clray::DelayResult& found = result.delay.at(0);
  check_estimate(found.intensity_m2_per_sr, 0.81 * 2.0 * h / solid_angle, 1e-6, "dihedral");
  CHECK(found.bin_m2_per_sr.at(10) == relative(found.intensity_m2_per_sr.value).epsilon(1e-9));
  CHECK(std::fabs(found.mean_delay_s.value) <= 1e-9 * 2.0 * h / kLightSpeed);
  // Without a cone the same power is reported, not lost.
  scene.observers[0].acceptance_rad = 0.0;
  const clray::Result blind = run(scene);
  CHECK(blind.delay.at(0).intensity_m2_per_sr.value == 0.0);
  CHECK(blind.energy.at(0).unconnected_specular_m2.value == relative(0.81 * 2.0 * h).epsilon(1e-6));
  CHECK(!blind.warnings.empty());
}

TEST_CASE("energy books of concave bodies with every surface, grazing narrow peaks included") {
  for (double n : {50.0, 1e6}) {
    clray::Scene scene = scene_of(box_mesh(1, 1, 2), ashikhmin_shirley(0.5, 0.2, n));
    add(scene, moved(plate_mesh(3, 1), {2.2, 0, 0.1}), ashikhmin_shirley(0.9, 0.1, n));
    add(scene, moved(bowl_mesh(48, 12, 1.0, kPi / 2, kPi), {0, 0, 3}), lambert(0.9));
    for (double degrees : {40.0, 89.0}) {
      CAPTURE(n);
      CAPTURE(degrees);
      monostatic(scene, toward(radians(degrees), 0.3));
      scene.trace.max_bounces = 8;
      many_rays(scene, 19);
      check_books(run(scene));
    }
  }
}

TEST_CASE("where every ray counts alike and all replicates agree, the claim leaves open a share of one ray each") {
  // A floor and a Lambert wall on its edge at 45°: the beam's edges are theirs, so that each replicate has as many rays
  // on the wall as the others, while the strata reach past the body by some 1e-8 of it.
  for (const bool mirrored : {false, true}) {
    clray::Scene scene = scene_of(plate_mesh(2, 2), mirrored ? mirror(1.0) : lambert(0.0));
    add(scene, plate_mesh(2, 2), lambert(0.5)).transform = {{-1, 0, 1}, {0, 1, 0}, kPi / 2.0, 1.0};
    const clray::Vec3 s = toward(kPi / 4.0);
    bistatic(scene, s, {0.8, -0.6, 0.0});
    scene.trace.max_bounces = 2;
    detect(scene, "spectrometer");
    for (const int log2_rays : {14, 18}) {
      const clray::Estimate a = run(many_rays(scene, log2_rays)).spectrometer.at(0).intensity_m2_per_sr;
      const double exact = 0.5 / kPi * s.x * 0.8 * (mirrored ? 8.0 : 4.0);
      INFO(a.value, " +- ", a.standard_error, ", exact ", exact);
      CHECK(std::fabs(a.value - exact) <= 4.0 * a.standard_error);
      CHECK(a.low < exact);
      CHECK(a.high > exact);
      // Not more than one ray of each replicate.
      CHECK(a.standard_error <= a.value * 16.0 / std::pow(2.0, log2_rays));
    }
  }
}

TEST_CASE("rays that all miss leave open a peak of one ray: the interval of 0 holds two beads a kilometre apart") {
  clray::Scene scene = scene_of("sphere", {{"radius", 1e-3}}, lambert(0.5));
  add(scene, "sphere", {{"radius", 1e-3}}, lambert(0.5)).transform.translate = {1000.0, 0.0, 0.0};
  for (const char* kind : {"delay", "spectrometer"}) {
    CAPTURE(kind);
    scene.detectors.clear();
    detect(scene, kind);
    scene.trace.method = clray::Method::points;
    scene.trace.sampler = clray::SamplerKind::sobol;
    const clray::Result result = run(rays(scene, 10));
    const clray::Estimate a =
        result.delay.empty() ? result.spectrometer.at(0).intensity_m2_per_sr : result.delay.at(0).intensity_m2_per_sr;
    REQUIRE(a.value == 0.0);
    // 3/16 of a ray of 64 at 95 %, of a beam of 1000.002 m by 2 mm, each as bright as a Lambert plate face-on.
    const double most = 3.0 / 16.0 / 64.0 * 1000.002 * 0.002 * 0.5 / kPi;
    CHECK(a.high == relative(most).epsilon(1e-4));  // the beam has a margin
    CHECK(a.standard_error == relative(most / 2.1314495).epsilon(1e-4));
    CHECK(a.high > 2.0 * 2.0 / 3.0 * 0.5 * 1e-6);
    CHECK(warns(result, "rays found nothing that is lit and seen"));
    if (!result.delay.empty()) CHECK(result.delay[0].bin_upper_bound.at(0) == relative(most).epsilon(1e-4));
  }
}

TEST_CASE("rays that all miss leave open a push of one ray: the intervals of 0 hold those on two beads") {
  clray::Scene scene = scene_of("sphere", {{"radius", 1e-3}}, lambert(0.5));
  add(scene, "sphere", {{"radius", 1e-3}}, lambert(0.5)).transform.translate = {1000.0, 0.0, 0.0};
  detect(scene, "pressure");
  scene.trace.method = clray::Method::points;
  scene.trace.sampler = clray::SamplerKind::sobol;
  const clray::Result result = run(rays(scene, 10));
  const clray::PressureResult& pressure = result.pressure.at(0);
  // 3/16 of a ray of 64 at 95 %, of a beam of 1000.002 m by 2 mm, which hands over twice its momentum.
  const double most = 2.0 * 3.0 / 16.0 / 64.0 * 1000.002 * 0.002 / 2.1314495;
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(pressure.coefficient_m2.value[axis] == 0.0);
    CHECK(pressure.coefficient_m2.standard_error[axis] == relative(most).epsilon(1e-4));  // the beam has a margin
    CHECK(pressure.component_m2.at(1).standard_error[axis] == relative(most).epsilon(1e-4));
    // Levers reach 1000 m at least, and are rounded up to a power of two.
    CHECK(pressure.torque_coefficient_m3.standard_error[axis] > 500.0 * most);
  }
  CHECK(pressure.absorbed_m2.standard_error == relative(0.5 * most).epsilon(1e-4));
  for (const clray::Estimate& e :
       {result.energy.at(0).incident_m2, result.energy[0].reflected_m2, result.energy[0].absorbed_m2})
    CHECK(e.standard_error == relative(0.5 * most).epsilon(1e-4));
  // What is there: 13/9 of two cross-sections of a sphere of Lambert albedo 1, at most.
  CHECK(2.1314495 * most > 2.0 * 13.0 / 9.0 * kPi * 1e-6);
  CHECK(warns(result, "rays found no light on the body"));
}

TEST_CASE("a black plate across the beam is pushed as it must be, and the claim is that of the rays there were") {
  clray::Scene scene = scene_of(plate_mesh(1, 1), lambert(0.0));
  detect(scene, "pressure");
  const clray::VectorEstimate c = run(many_rays(scene, 18)).pressure.at(0).coefficient_m2;
  CHECK(c.value.z == relative(-1.0).epsilon(1e-9));
  // 3/16 of a ray of 2^14 at 95 %: over t95 of 15 degrees of freedom, 2.1314.
  CHECK(c.standard_error.z == relative(3.0 / 16.0 / 2.1314495 / 16384.0).epsilon(1e-6));
  CHECK(c.standard_error.x == 0.0);
}
