// SPDX-License-Identifier: Apache-2.0
// Meshes and views that break careless tracers: leaks, slivers, far-off and huge bodies, grazing light.
#include <fmt/format.h>

#include <cmath>

#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;
using clray::Vec3;

namespace {

/// A result that must be exactly zero.
Outcome nothing(const clray::Result& result) {
  Outcome outcome;
  const double a = result.delay.at(0).intensity_m2_per_sr.value;
  outcome.measured = fmt::format("A = {:g} from {} rays", a, result.rays);
  outcome.pass = a == 0.0 && sound(result, &outcome.measured);
  return outcome;
}

Outcome total_is(const clray::Result& result, double exact, double slack) {
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  Outcome outcome = near(a.value, a.standard_error, exact, slack);
  outcome.pass = sound(result, &outcome.measured) && outcome.pass;
  return outcome;
}

const Vec3 kFarOff{148376, 1234, -223423};

/// A black closed sphere around a white one: light that returns has leaked through shared edges.
Outcome leak(int slices, int log2_rays) {
  Scene scene = scene_of(moved(sphere_mesh(slices, slices / 2, 1.0), kFarOff), lambert(0.0));
  add(scene, moved(sphere_mesh(32, 16, 0.9), kFarOff), lambert(1.0));
  monostatic(scene, toward(0.7, 0.4));
  return nothing(run(rays(scene, log2_rays)));
}

/// Light falls into a sphere through a hole on top; from below nothing of it may be seen through the shell.
Outcome leak_inside(int slices, int log2_rays) {
  Scene scene = scene_of(moved(bowl_mesh(slices, slices / 2, 1.0, radians(50.0), kPi), kFarOff), lambert(0.9));
  bistatic(scene, {0, 0, 1}, {0, 0, -1});
  scene.trace.max_bounces = 8;
  return nothing(run(rays(scene, log2_rays)));
}

/// A unit square of strips whose widths halve: the last is 10⁻¹² wide. Every ray must be counted once.
Outcome slivers() {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  constexpr int kStrips = 40;
  for (int i = 0; i <= kStrips + 1; ++i) {
    const double x = i > kStrips ? 1.0 : 1.0 - std::ldexp(1.0, -i);
    mesh->vertices.push_back({x, 0.0, 0.0});
    mesh->vertices.push_back({x, 1.0, 0.0});
  }
  for (std::uint32_t i = 0; i <= kStrips; ++i) {
    mesh->triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    mesh->triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  Scene scene = scene_of(mesh, lambert(1.0));
  monostatic(scene, toward(0.6, 0.3));
  const double mu = std::cos(0.6);
  // The outline of the tilted square does not fill the beam: stratified error applies.
  return total_is(run(rays(scene, 20)), mu * mu / kPi, 1e-10);
}

/// A square of many triangles, seen face-on: every ray hits, exactly once.
Outcome tiling(int cells) {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) mesh->vertices.push_back({1.0 * i / cells, 1.0 * j / cells, 0.0});
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = i * n + j;
      mesh->triangles.push_back({a, a + n, a + n + 1});
      mesh->triangles.push_back({a, a + n + 1, a + 1});
    }
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  Scene scene = scene_of(mesh, lambert(1.0));
  return total_is(run(rays(scene, 20)), 1.0 / kPi, kQuantumOfTotal);
}

Outcome coordinates() {
  Outcome outcome{true, ""};
  for (double scale : {1e8, 1e-8}) {
    const MeshPtr mesh = moved(prism_mesh(64, 1.0, 3.0), {0, 0, 0}, scale);
    const Vec3 s = toward(0.7, 0.4);
    Scene scene = scene_of(mesh, lambert(0.5));
    monostatic(scene, s);
    const Outcome one = total_is(run(rays(scene, 18)), convex_lambert(*mesh, 0.5, s, s).total_m2_per_sr, 1e-10);
    outcome.pass = outcome.pass && one.pass;
    outcome.measured += fmt::format("{}{:g} m: {}", outcome.measured.empty() ? "" : "; ", scale, one.measured);
  }
  return outcome;
}

Outcome far_off() {
  const MeshPtr mesh = moved(prism_mesh(64, 1.0, 3.0), {1e8, -3e7, 2e7});
  const Vec3 s = toward(0.7, 0.4);
  Scene scene = scene_of(mesh, lambert(0.5));
  monostatic(scene, s);
  // Coordinates themselves are rounded to 1.5e-8 m at 1e8 m: normals and areas are off by a few of these.
  return total_is(run(rays(scene, 18)), convex_lambert(*mesh, 0.5, s, s).total_m2_per_sr, 1e-6);
}

Outcome close_plates() {
  Scene scene = scene_of(moved(plate_mesh(1, 1), {0, 0, 10.0}), lambert(0.0));
  add(scene, moved(plate_mesh(1, 1), {0, 0, 10.0 - 1e-6}), lambert(1.0));
  return nothing(run(rays(scene, 20)));
}

Outcome grazing() {
  Outcome outcome{true, ""};
  for (double degrees : {89.9, 89.999, 89.99999}) {
    Scene scene = scene_of(plate_mesh(2.0, 1.0), lambert(0.5));
    const Vec3 s = toward(radians(degrees));
    monostatic(scene, s);
    // s.z is what the tracer is given: its square is exact to rounding, cos² of the angle is not.
    const Outcome one = total_is(run(rays(scene, 16)), 0.5 / kPi * 2.0 * s.z * s.z, kQuantumOfTotal / s.z);
    outcome.pass = outcome.pass && one.pass;
    outcome.measured += fmt::format("{}{}°: {}", outcome.measured.empty() ? "" : "; ", degrees, one.measured);
  }
  return outcome;
}

Outcome edge_on() {
  Scene scene = scene_of(plate_mesh(2.0, 1.0), lambert(1.0));
  monostatic(scene, {1, 0, 0});
  return nothing(run(rays(scene, 16)));
}

Outcome coincident(int copies) {
  auto mesh = std::make_shared<clray::Mesh>(*plate_mesh(1, 1));
  const auto two = mesh->triangles;
  for (int i = 1; i < copies; ++i) mesh->triangles.insert(mesh->triangles.end(), two.begin(), two.end());
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  Scene scene = scene_of(mesh, lambert(1.0));
  monostatic(scene, {0, 0, 1});
  rays(scene, 8);
  const clray::Result result = run(scene);
  Outcome outcome = total_is(result, 1.0 / kPi, kQuantumOfTotal);
  outcome.measured += fmt::format("; BVH {:.2f} s", result.seconds.bvh);
  outcome.pass = outcome.pass && result.seconds.bvh < 60.0;
  return outcome;
}

/// A triangle of 10⁶ times the area of all others, which make up a ball above it. From above it is shaded by the ball
/// (three rays of 2^20 at most meet that), from below it hides the ball, and edge-on the ball alone is seen.
Outcome giant() {
  const MeshPtr ball = moved(sphere_mesh(64, 32, 1.0), {0, 0, 2});
  auto mesh = std::make_shared<clray::Mesh>(*ball);
  const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
  const double across = 100.0, along = 2e6 * ball->report.area_m2 / across, area = 0.5 * across * along;
  for (const Vec3 v :
       {Vec3(-along / 3, -across / 3, 0), Vec3(2 * along / 3, -across / 3, 0), Vec3(-along / 3, 2 * across / 3, 0)})
    mesh->vertices.push_back(v);
  mesh->triangles.push_back({first, first + 1, first + 2});
  mesh->triangle_slot.push_back(0);
  const Vec3 edge_on{1, 0, 0};
  const double whole = 0.5 / kPi * area, round = convex_lambert(*ball, 0.5, edge_on, edge_on).total_m2_per_sr;
  struct View {
    const char* name;
    Vec3 s;
    double exact, slack;
  };
  Outcome outcome{true, ""};
  for (const View& view : {View{"above", {0, 0, 1}, whole, 6e-6}, View{"below", {0, 0, -1}, whole, 1e-10},
                           View{"edge-on", edge_on, round, 1e-10}}) {
    Scene scene = scene_of(mesh, lambert(0.5));
    monostatic(scene, view.s);
    const Outcome one = total_is(run(rays(scene, 20)), view.exact, view.slack);
    outcome.pass = outcome.pass && one.pass;
    outcome.measured += fmt::format("{}{}: {}", outcome.measured.empty() ? "" : "; ", view.name, one.measured);
  }
  return outcome;
}

Outcome many(int slices) {
  const MeshPtr mesh = sphere_mesh(slices, slices / 2, 1.0);
  Scene scene = scene_of(mesh, lambert(0.5));
  const Vec3 s = toward(0.7, 0.4);
  monostatic(scene, s);
  const clray::Result result = run(rays(scene, 20));
  Outcome outcome = total_is(result, convex_lambert(*mesh, 0.5, s, s).total_m2_per_sr, 1e-10);
  outcome.measured += fmt::format("; {} triangles, BVH {:.1f} s", mesh->triangles.size(), result.seconds.bvh);
  return outcome;
}

}  // namespace

std::vector<Case> geometry_cases() {
  const char* const kZero = "exact: zero";
  const char* const kRounding = "4 standard errors + 1e-10: fp64 rounding and the integer unit";
  const char* const kUnit = "2^-37: every weight is the same and may be rounded by half a unit of the sums";
  const auto with = [](auto function, auto... arguments) { return [=] { return function(arguments...); }; };
  return {
      {"geometry", "closed sphere of 10⁶ triangles far off the origin, 2^24 rays", "none gets in", kZero, false,
       with(leak, 1024, 24)},
      {"geometry", "closed sphere of 3·10⁴ triangles far off, 2^20 rays", "none gets in", kZero, true,
       with(leak, 180, 20)},
      {"geometry", "rays from inside a sphere with a hole, 10⁶ triangles, 8 bounces", "none gets out through the shell",
       kZero, false, with(leak_inside, 1024, 20)},
      {"geometry", "rays from inside a sphere with a hole, 10⁴ triangles, 8 bounces", "none gets out through the shell",
       kZero, true, with(leak_inside, 100, 18)},
      {"geometry", "square of strips down to aspect 10¹²", "the square's total", kRounding, true, slivers},
      {"geometry", "square of 2·64² triangles", "every ray counted once", kUnit, true, with(tiling, 64)},
      {"geometry", "square of 2·1000² triangles", "every ray counted once", kUnit, false, with(tiling, 1000)},
      {"geometry", "cylinder with coordinates × 10^±8", "the facets' sum", kRounding, true, coordinates},
      {"geometry", "cylinder 10⁸ m off the origin", "the facets' sum",
       "4 standard errors + 1e-6: ulp(1e8 m)/1 m, two hundred times", true, far_off},
      {"geometry", "plates 1 µm apart at 10 m", "the rear one gets nothing", kZero, true, close_plates},
      {"geometry", "grazing plates to 89.99999°", "rho/π·ab·cos²",
       "1e-11/cos θ: weights lie that far below the bound that sets the unit of the sums (6e-5 at 89.99999°)", true,
       grazing},
      {"geometry", "edge-on plate", "nothing", kZero, true, edge_on},
      {"geometry", "10⁶ coincident triangles", "one plate's total, BVH under 60 s", kUnit, false,
       with(coincident, 500000)},
      {"geometry", "10⁴ coincident triangles", "one plate's total", kUnit, true, with(coincident, 5000)},
      {"geometry", "one triangle 10⁶ times the rest in area", "from above and below its total, edge-on the rest's",
       "4 standard errors + 1e-10; from above 3 rays of 2^20, half of which miss the triangle", true, giant},
      {"geometry", "sphere of 10⁷ triangles", "the facets' sum", kRounding, false, with(many, 3164)},
  };
}

}  // namespace clray_test
