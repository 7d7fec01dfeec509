// SPDX-License-Identifier: Apache-2.0
// See error_cases.hpp.
#include "error_cases.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clray_bench {

using namespace clray_test;

namespace {

Found delay_total(const clray::Result& r) {
  const clray::Estimate& a = r.delay.at(0).intensity_m2_per_sr;
  return {a.value, a.standard_error};
}

ErrorCase delay_case(const std::string& name, const clray::Scene& scene, const Pulse& pulse, bool bins) {
  return {name, scene, pulse.total_m2_per_sr, delay_total, bins ? pulse.share : Cdf{}, 0.0};
}

}  // namespace

std::vector<ErrorCase> error_cases() {
  std::vector<ErrorCase> cases;
  clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  cases.push_back(delay_case("sphere", scene, lambert_sphere(0.5, 1.0), true));

  scene = scene_of(plate_mesh(2.0, 1.0), lambert(0.5));
  const clray::Vec3 s = toward(0.7, 0.4);
  monostatic(scene, s);
  cases.push_back(delay_case("plate", scene, convex_lambert(*scene.components[0].mesh, 0.5, s, s), true));
  // A plate shows one face from either side; the facet sum is of the side that s sees.

  scene = scene_of("cylinder", {{"radius", 1.0}, {"height", 3.0}, {"capped", 1.0}}, lambert(0.5));
  monostatic(scene, {1, 0, 0});
  cases.push_back(delay_case("cylinder broadside", scene, lambert_cylinder_side(0.5, 1.0, 3.0), true));

  scene = scene_of("cone", {{"radius", 1.0}, {"height", 2.0}}, lambert(0.5));
  cases.push_back(delay_case("cone", scene, lambert_cone(0.5, 1.0, 2.0), true));

  scene = scene_of(box_mesh(1.0, 1.0, 2.0), lambert(0.5));
  monostatic(scene, s);
  cases.push_back(delay_case("box", scene, convex_lambert(*scene.components[0].mesh, 0.5, s, s), true));

  for (double n : {50.0, 500.0, 1e5}) {
    scene = scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(0.5, 0.2, n));
    cases.push_back({fmt::format("A-S sphere n = {:g}", n),
                     scene,
                     ashikhmin_shirley_sphere(0.5, 0.2, n, 1.0),
                     delay_total,
                     {},
                     0.0});
  }

  const double rho = 0.8;
  scene = scene_of(bowl_mesh(256, 64, 1.0, kPi / 2, kPi), lambert(rho));
  scene.trace.max_bounces = 32;
  cases.push_back(
      {"bowl with bounces", scene, 2.0 * rho / 3.0 + rho * rho / 4.0 / (1.0 - rho / 2.0), delay_total, {}, 2e-4});

  scene = scene_of("sphere", {{"radius", 1.0}}, lambert(1.0));
  detect(scene, "pressure");
  cases.push_back({"pressure on a sphere",
                   scene,
                   13.0 / 9.0 * kPi,
                   [](const clray::Result& r) {
                     const clray::VectorEstimate& c = r.pressure.at(0).coefficient_m2;
                     return Found{-c.value.z, c.standard_error.z};
                   },
                   {},
                   0.0});

  scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  bistatic(scene, toward(0.3), toward(0.3 + radians(60.0)));
  detect(scene, "spectrometer");
  cases.push_back({"light curve point at 60°",
                   scene,
                   lambert_phase(radians(60.0)) / 3.0,
                   [](const clray::Result& r) {
                     const clray::Estimate& a = r.spectrometer.at(0).intensity_m2_per_sr;
                     return Found{a.value, a.standard_error};
                   },
                   {},
                   0.0});
  return cases;
}

}  // namespace clray_bench
