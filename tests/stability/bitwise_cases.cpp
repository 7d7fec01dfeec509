// SPDX-License-Identifier: Apache-2.0
// Changes that must not change a bit of the sums: exact scaling, order, what is never hit, how work is cut.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;

namespace {

const char* const kExact = "exact: digests are equal";

Scene base_scene() {
  Scene scene = scene_of(box_mesh(1.0, 1.0, 2.0), ashikhmin_shirley(0.5, 0.2, 50));
  for (double side : {-1.0, 1.0}) add(scene, moved(plate_mesh(3.0, 1.0), {2.25 * side, 0.0, 0.125}), lambert(0.7));
  monostatic(scene, toward(0.7, 0.4));
  window(scene, -2.5e-8, 2.5e-8, 256);
  return rays(scene, 16);
}

/// Every variant's digest equals the first's.
Outcome all_equal(const std::vector<std::pair<std::string, Scene>>& scenes) {
  Outcome outcome{true, ""};
  std::uint64_t first = 0;
  std::string broken;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const clray::Result result = run(scenes[i].second);
    std::string why;
    if (i == 0) first = result.digest;
    if (result.digest != first || !sound(result, &why)) broken += " " + scenes[i].first + why;
  }
  outcome.pass = broken.empty();
  outcome.measured =
      fmt::format("{} runs, digest {:016x}{}", scenes.size(), first, broken.empty() ? "" : ", differ:" + broken);
  return outcome;
}

Outcome scaled() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (int k : {0, -40, -7, 13, 40}) {
    Scene scene = base_scene();
    const double factor = std::ldexp(1.0, k);
    for (auto& c : scene.components) c.mesh = moved(c.mesh, {0, 0, 0}, factor);
    for (const char* key : {"start_ns", "stop_ns"}) scene.detectors[0].parameters[key] *= factor;
    scenes.emplace_back(fmt::format("2^{}", k), scene);
  }
  return all_equal(scenes);
}

Outcome ranges() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (double range : {0.0, 1e6, 3.6e7}) {
    Scene scene = base_scene();
    if (range > 0.0) {
      scene.station.emplace();
      scene.station->range_m = range;
    }
    scenes.emplace_back(fmt::format("{} m", range), scene);
  }
  return all_equal(scenes);
}

Outcome permuted() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (unsigned seed : {0u, 1u, 2u}) {
    Scene scene = scene_of(sphere_mesh(48, 24, 1.0), lambert(0.5));
    monostatic(scene, toward(0.7, 0.4));
    rays(scene, 16);
    auto mesh = std::make_shared<clray::Mesh>(*scene.components[0].mesh);
    std::mt19937 random(seed);
    if (seed > 0) {
      std::shuffle(mesh->triangles.begin(), mesh->triangles.end(), random);
      for (auto& t : mesh->triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    }
    scene.components[0].mesh = mesh;
    scenes.emplace_back(fmt::format("shuffle {}", seed), scene);
  }
  return all_equal(scenes);
}

Outcome unseen() {
  std::vector<std::pair<std::string, Scene>> scenes;
  scenes.emplace_back("plain", base_scene());
  for (int kind : {0, 1}) {
    Scene scene = base_scene();
    auto mesh = std::make_shared<clray::Mesh>(*scene.components[0].mesh);
    if (kind == 0) {  // zero area: a needle, a point
      mesh->triangles.push_back({0, 1, 1});
      mesh->triangles.push_back({2, 2, 2});
    } else {  // inside the closed box
      const auto n = static_cast<std::uint32_t>(mesh->vertices.size());
      for (double x : {-0.25, 0.0, 0.25}) mesh->vertices.push_back({x, x * x, 0.125});
      mesh->triangles.push_back({n, n + 1, n + 2});
    }
    mesh->triangle_slot.assign(mesh->triangles.size(), 0);
    scene.components[0].mesh = mesh;
    scenes.emplace_back(kind == 0 ? "zero area" : "hidden", scene);
  }
  return all_equal(scenes);
}

Outcome cut() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (std::uint32_t group : {64u, 1u, 7u, 256u}) {
    Scene scene = base_scene();
    scene.trace.work_group_size = group;
    scenes.emplace_back(fmt::format("group {}", group), scene);
  }
  for (std::uint64_t slice : {1ull, 64ull, 1000ull, 4096ull}) {
    Scene scene = base_scene();
    rays(scene, 16);
    scene.trace.slice_points = slice;
    scenes.emplace_back(fmt::format("slice {}", slice), scene);
  }
  Scene generic = base_scene();
  generic.trace.specialise = false;
  scenes.emplace_back("generic", generic);
  Scene shadowed = base_scene();
  shadowed.trace.force_bistatic = true;
  scenes.emplace_back("forced shadow rays", shadowed);
  return all_equal(scenes);
}

Outcome bounced() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (int variant : {0, 1, 2, 3}) {
    Scene scene = base_scene();
    add(scene, "paraboloid", {{"radius", 0.6}, {"depth", 0.2}}, lambert(0.8)).transform.translate = {0, 0, 1.5};
    scene.trace.max_bounces = 8;
    rays(scene, 14);
    if (variant == 1) scene.trace.specialise = false;
    if (variant == 2) scene.trace.work_group_size = 7;
    if (variant == 3) scene.trace.slice_points = 100;
    scenes.emplace_back(fmt::format("variant {}", variant), scene);
  }
  return all_equal(scenes);
}

Outcome cut_short() {
  Scene scene = base_scene();
  scene.trace.rays = 0;
  scene.trace.target_error_percent = 1e-9;
  scene.trace.time_limit_s = 0.5;
  const clray::Result early = run(scene);
  Scene whole = base_scene();
  whole.trace.rays = early.rays;
  const clray::Result full = run(whole);
  return {
      early.digest == full.digest && early.rays > 0,
      fmt::format("{} rays when stopped, digest {:016x}, whole run {:016x}", early.rays, early.digest, full.digest)};
}

Outcome turns() {
  std::vector<std::pair<std::string, Scene>> scenes;
  for (double turn : {0.0, 1.0, 1e9}) {
    Scene scene = base_scene();
    scene.motion.emplace();
    scene.motion->axis = {0, 1, 0};
    scene.motion->period_s = 2.0;
    scene.motion->start_s = 2.0 * turn;
    scene.motion->stop_s = 2.0 * turn + 1.0;
    scene.motion->step_rad = kPi / 4;
    rays(scene, 14);
    scenes.emplace_back(fmt::format("{:g} turns", turn), scene);
  }
  return all_equal(scenes);
}

}  // namespace

std::vector<Case> bitwise_cases() {
  return {
      {"bitwise", "geometry and bins × 2^k", "no bit changes for k = −40 … 40", kExact, true, scaled},
      {"bitwise", "range 0, 10⁶, 3.6·10⁷ m", "range is added analytically: no bit changes", kExact, true, ranges},
      {"bitwise", "permuted triangles and corners", "no bit changes", kExact, true, permuted},
      {"bitwise", "zero-area and hidden triangles added", "no bit changes", kExact, true, unseen},
      {"bitwise", "work-group and slice sizes, generic program, forced shadow rays", "no bit changes", kExact, true,
       cut},
      {"bitwise", "8 bounces: generic program, work-group, slices", "no bit changes", kExact, true, bounced},
      {"bitwise", "cut short at a doubling", "equals --rays of that count", kExact, true, cut_short},
      {"bitwise", "rotation by 10⁹ whole turns", "no bit changes", kExact, true, turns},
  };
}

}  // namespace clray_test
