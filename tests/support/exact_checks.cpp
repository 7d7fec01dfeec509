// SPDX-License-Identifier: Apache-2.0
// See exact_checks.hpp.
#include "support/exact_checks.hpp"

#include <cmath>
#include <random>

namespace clray_test {

clray::Scene lambert_scene(const MeshPtr& mesh, clray::Vec3 s, double rho) {
  clray::Scene scene = scene_of(mesh, lambert(rho));
  monostatic(scene, s);
  return scene;
}

clray::Result solve(clray::Scene scene) {
  scene.trace.method = clray::Method::exact;
  scene.trace.rays = 0;
  return run(scene);
}

const clray::Estimate& total(const clray::Result& result) {
  return result.delay.at(0).intensity_m2_per_sr;
}

void check_exact(const clray::Result& result, double expected) {
  const clray::DelayResult& d = result.delay.at(0);
  CHECK(total(result).value == relative(expected).epsilon(kExact));
  CHECK(total(result).standard_error == 0.0);
  CHECK(total(result).low == total(result).high);
  CHECK(total(result).rounding_bound >= std::fabs(total(result).value - expected) * (1.0 - 1e-3));
  CHECK(total(result).rounding_bound < 1e-10 * expected);
  double sum = d.below_m2_per_sr + d.above_m2_per_sr;
  for (const double bin : d.bin_m2_per_sr) sum += bin;
  CHECK(sum == relative(total(result).value).epsilon(kExact));
  CHECK(d.hits.empty());
  CHECK(result.rays == 0);
}

void check_exact_bins(const clray::Result& result, const Pulse& exact) {
  const clray::DelayResult& d = result.delay.at(0);
  for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
    const double start = d.first_bin_start_s + static_cast<double>(b) * d.bin_width_s;
    const double expected = exact.total_m2_per_sr * (exact.share(start + d.bin_width_s) - exact.share(start));
    CAPTURE(b);
    // A border is placed to some 1e-16 of the path over the width of a bin.
    CHECK(std::fabs(d.bin_m2_per_sr[b] - expected) <= 1e-11 * exact.total_m2_per_sr);
  }
  const double end = d.first_bin_start_s + static_cast<double>(d.bin_m2_per_sr.size()) * d.bin_width_s;
  const double below = exact.total_m2_per_sr * exact.share(d.first_bin_start_s);
  const double above = exact.total_m2_per_sr * (1.0 - exact.share(end));
  CHECK(std::fabs(d.below_m2_per_sr - below) <= 1e-11 * exact.total_m2_per_sr);
  CHECK(std::fabs(d.above_m2_per_sr - above) <= 1e-11 * exact.total_m2_per_sr);
}

MeshPtr mesh_of(const Triangles& triangles) {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  for (const auto& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), t.begin(), t.end());
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangle_slot.push_back(0);
  }
  return mesh;
}

void add_quad(Triangles* triangles, clray::Vec3 a, clray::Vec3 b, clray::Vec3 c, clray::Vec3 d) {
  triangles->push_back({a, b, c});
  triangles->push_back({a, c, d});
}

Triangles soup(std::uint64_t seed, int count, double size) {
  std::mt19937_64 random(seed);
  const auto number = [&] { return 2.0 * std::ldexp(static_cast<double>(random() >> 11), -53) - 1.0; };
  Triangles triangles;
  for (int k = 0; k < count; ++k) {
    // Each number has a statement of its own: the order in which arguments are evaluated is not fixed.
    const auto point = [&] {
      const double x = number(), y = number(), z = number();
      return clray::Vec3(x, y, z);
    };
    const clray::Vec3 p = point();
    std::array<clray::Vec3, 3> t;
    for (auto& corner : t) corner = p + size * point();
    triangles.push_back(t);
  }
  return triangles;
}

}  // namespace clray_test
