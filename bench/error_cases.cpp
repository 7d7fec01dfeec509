// SPDX-License-Identifier: Apache-2.0
// See error_cases.hpp.
#include "error_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace clray_bench {

using namespace clray_test;

namespace {

ErrorCase delay_case(const std::string& name, const clray::Scene& scene, const Pulse& pulse, const Cdf& hits) {
  return {name, scene, pulse.total_m2_per_sr, pulse.share, hits, 0.0, 0.0};
}

ErrorCase total_case(const std::string& name, const clray::Scene& scene, double exact, double model_error = 0.0) {
  return {name, scene, exact, {}, {}, model_error, 0.0};
}

/// Convex, Lambert, of one mesh.
ErrorCase facets_case(const std::string& name, const MeshPtr& mesh, double rho, clray::Vec3 s) {
  clray::Scene scene = scene_of(mesh, lambert(rho));
  monostatic(scene, s);
  return delay_case(name, scene, convex_lambert(*mesh, rho, s, s),
                    monostatic_facets(*mesh, s, [](double mu) { return mu; }).share);
}

/// meshes/box_wing.obj as the command line loads it: Ashikhmin-Shirley by its MTL. Box and wings lie apart in x, so
/// that from any s with s.x = 0 none hides another.
ErrorCase box_wing_case(const std::string& name, clray::Vec3 s) {
  const auto start = std::chrono::steady_clock::now();
  clray::Scene scene = clray::load_scene(CLRAY_SOURCE_DIR "/meshes/box_wing.obj");
  const double load_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  monostatic(scene, s);
  const clray::Mesh& mesh = *scene.components.at(0).mesh;
  const auto facet = [](double mu) { return ashikhmin_shirley_facet(0.5, 0.2, 50.0, mu); };
  ErrorCase c = delay_case(name, scene, monostatic_facets(mesh, s, facet),
                           monostatic_facets(mesh, s, [](double mu) { return mu; }).share);
  c.load_s = load_s;
  return c;
}

/// Share of a convex body's outline nearer than a depth.
Cdf sphere_hits(double radius) {
  return two_way([radius](double depth) {
    const double mu = std::clamp(-depth / radius, 0.0, 1.0);
    return 1.0 - mu * mu;
  });
}

Cdf cylinder_side_hits(double radius) {
  return two_way([radius](double depth) {
    const double mu = std::clamp(-depth / radius, 0.0, 1.0);
    return std::sqrt(1.0 - mu * mu);
  });
}

}  // namespace

std::vector<ErrorCase> error_cases() {
  std::vector<ErrorCase> cases;
  clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  cases.push_back(delay_case("sphere", scene, lambert_sphere(0.5, 1.0), sphere_hits(1.0)));

  const clray::Vec3 s = toward(0.7, 0.4);
  cases.push_back(facets_case("plate", plate_mesh(2.0, 1.0), 0.5, s));

  scene = scene_of("cylinder", {{"radius", 1.0}, {"height", 3.0}, {"capped", 1.0}}, lambert(0.5));
  monostatic(scene, {1, 0, 0});
  cases.push_back(
      delay_case("cylinder broadside", scene, lambert_cylinder_side(0.5, 1.0, 3.0), cylinder_side_hits(1.0)));

  scene = scene_of("cone", {{"radius", 1.0}, {"height", 2.0}}, lambert(0.5));
  const Pulse cone = lambert_cone(0.5, 1.0, 2.0);  // one cosine all over: light and hits are shared alike
  cases.push_back(delay_case("cone", scene, cone, cone.share));

  cases.push_back(facets_case("box", box_mesh(1.0, 1.0, 2.0), 0.5, s));
  cases.push_back(box_wing_case("box-wing", {0, 0, 1}));
  cases.push_back(box_wing_case("box-wing tilted 20°", {0, std::sin(radians(20.0)), std::cos(radians(20.0))}));

  for (double n : {50.0, 500.0, 1e5}) {
    scene = scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(0.5, 0.2, n));
    cases.push_back(
        total_case(fmt::format("A-S sphere n = {:g}", n), scene, ashikhmin_shirley_sphere(0.5, 0.2, n, 1.0)));
  }

  const double rho = 0.8;
  scene = scene_of(bowl_mesh(256, 64, 1.0, kPi / 2, kPi), lambert(rho));
  scene.trace.max_bounces = 32;
  cases.push_back(total_case("bowl with bounces", scene, 2.0 * rho / 3.0 + rho * rho / 4.0 / (1.0 - rho / 2.0), 2e-4));

  scene = scene_of("sphere", {{"radius", 1.0}}, lambert(1.0));
  detect(scene, "pressure");
  cases.push_back(total_case("pressure on a sphere", scene, 13.0 / 9.0 * kPi));

  scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  bistatic(scene, toward(0.3), toward(0.3 + radians(60.0)));
  detect(scene, "spectrometer");
  cases.push_back(total_case("light curve point at 60°", scene, lambert_phase(radians(60.0)) / 3.0));
  return cases;
}

}  // namespace clray_bench
