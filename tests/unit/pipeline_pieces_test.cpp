// SPDX-License-Identifier: Apache-2.0
// Rays through a tree of pieces of faces against rays through a tree of whole faces: the same sums and events, on
// bodies whose long faces lie askew through each other, one ray at a time and in packets, with bounces and shadows.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "body/geometry.hpp"
#include "device/platforms.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/host_pass.hpp"
#include "pipeline/plan.hpp"
#include "unit/device_support.hpp"

using namespace clray;
using clray::test::opened_cpu;

namespace {

/// Slivers and blades through a cube, and triangles that share edges with them.
std::shared_ptr<const Mesh> blades(int count, double size, Vec3 place) {
  std::mt19937_64 random(5);
  const auto next = [&] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  auto mesh = std::make_shared<Mesh>();
  mesh->material_slots = {""};
  for (int t = 0; t < count; ++t) {
    const Vec3 a(next(), next(), next()), b(next(), next(), next());
    const double width = t % 3 == 0 ? 0.3 : 0.01;
    const Vec3 c = a + 0.4 * (b - a) + width * Vec3(next(), next(), next());
    const Vec3 d = a + 0.7 * (b - a) + width * Vec3(next(), next(), next());
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    for (const Vec3& corner : {a, b, c, d}) mesh->vertices.push_back(place + size * corner);
    for (const auto& face : {std::array{first, first + 1, first + 2}, std::array{first + 1, first, first + 3}}) {
      mesh->triangles.push_back({face[0], face[1], face[2]});
      mesh->triangle_slot.push_back(0);
    }
  }
  return mesh;
}

Scene scene_of(const std::shared_ptr<const Mesh>& mesh, const std::string& walk) {
  Scene scene;
  Material material;
  material.name = "surface";
  material.model = "lambert";
  material.spectra["rho"] = Spectrum{{532.0}, {0.6}};
  scene.materials = {material};
  Component component;
  component.name = "body";
  component.mesh = mesh;
  component.materials = {0};
  scene.components = {component};
  scene.source.direction = glm::normalize(Vec3(0.3, 0.5, 0.81));
  scene.source.wavelength_nm = 532.0;
  Observer source, elsewhere;
  source.name = "source";
  source.monostatic = true;
  elsewhere.name = "elsewhere";
  elsewhere.direction = glm::normalize(Vec3(-0.6, 0.2, 0.5));
  scene.observers = {source, elsewhere};
  scene.detectors = {{"delay", "delay", {{"bins", 64}}}};
  scene.trace.max_bounces = 3;
  scene.trace.rays = 65536;
  scene.trace.replicates = 16;
  scene.trace.method = Method::points;
  scene.trace.walk = walk;
  return scene;
}

Sums traced(OpenedDevice& opened, const Scene& scene, TreeFaces faces, bool* pieces) {
  const Geometry geometry = build_geometry(scene, faces);
  *pieces = !geometry.leaves.empty();
  const PassPlan plan = plan_passes(scene, geometry).front();
  DevicePass device(opened, plan, geometry, embedded_kernels());
  constexpr std::uint32_t kPoints = 4096;
  const std::uint32_t chunk = chunk_of(plan);
  const auto items = static_cast<std::uint32_t>(items_of(plan, plan.beams.views.size(), kPoints, chunk));
  device.launch_items(0, items, {0, kPoints, chunk}, in_packets(plan) ? 1 : 64);
  Sums found(plan.layout);
  device.drain(&found);
  return found;
}

}  // namespace

TEST_CASE("rays find through pieces of faces what they find through whole ones") {
  OpenedDevice opened = opened_cpu();
  for (const std::string walk : {"plain", "packet", "placed"}) {
    for (const auto& where : {std::pair(1.0, Vec3(0.0)), std::pair(1e-3, Vec3(7.0, -2.0, 0.5))}) {
      const double size = where.first;
      CAPTURE(walk);
      CAPTURE(size);
      const Scene scene = scene_of(blades(300, size, where.second), walk);
      bool pieces = false, none = true;
      const Sums found = traced(opened, scene, TreeFaces::pieces, &pieces);
      const Sums right = traced(opened, scene, TreeFaces::whole, &none);
      REQUIRE(pieces);
      REQUIRE_FALSE(none);
      int different = 0, filled = 0;
      for (std::size_t k = 0; k < right.values.size(); ++k) {
        different += found.values[k] != right.values[k];
        filled += right.values[k] != 0;
      }
      for (std::size_t k = 0; k < right.counts.size(); ++k) different += found.counts[k] != right.counts[k];
      CHECK(different == 0);
      CHECK(filled > 100);
      CHECK(found.events == right.events);
    }
  }
}
