// SPDX-License-Identifier: Apache-2.0
// See corner.hpp.
#include "support/corner.hpp"

#include <cmath>
#include <vector>

namespace clray_test {
namespace {

MeshPtr quad(const std::vector<clray::Vec3>& corners) {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->vertices = corners;
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh->triangle_slot = {0, 0};
  mesh->material_slots = {""};
  return mesh;
}

}  // namespace

MeshPtr floor_mesh() {
  const double y = 0.5 * kEdge;
  return quad({{0, -y, 0}, {kFloor, -y, 0}, {kFloor, y, 0}, {0, y, 0}});
}
MeshPtr wall_mesh() {
  const double y = 0.5 * kEdge;
  return quad({{0, -y, 0}, {0, y, 0}, {0, y, kWall}, {0, -y, kWall}});
}

clray::Scene corner(const clray::Material& floor, const clray::Material& wall, const clray::Vec3& s, int bounces,
                    int log2_rays) {
  clray::Scene scene = scene_of(floor_mesh(), floor);
  add(scene, wall_mesh(), wall);
  monostatic(scene, s);
  scene.trace.max_bounces = bounces;
  scene.trace.method = clray::Method::exact;
  return rays(scene, log2_rays);
}

double form_factor() {
  const double h = kWall / kEdge, w = kFloor / kEdge, h2 = h * h, w2 = w * w, d = std::sqrt(h2 + w2);
  const double logs = std::log((1 + w2) * (1 + h2) / (1 + w2 + h2)) +
                      w2 * std::log(w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2))) +
                      h2 * std::log(h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2)));
  return (w * std::atan(1 / w) + h * std::atan(1 / h) - d * std::atan(1 / d) + 0.25 * logs) / (kPi * w);
}

CornerLight corner_light(double floor_rho, double wall_rho, const clray::Vec3& s, const clray::Vec3& o) {
  const double first = (floor_rho * s.z * o.z * kFloor + wall_rho * s.x * o.x * kWall) * kEdge / kPi;
  // From the floor to the wall, and the other way: the same areas and the same share.
  const double exchanged = floor_rho * wall_rho * kFloor * kEdge * form_factor() / kPi;
  return {first, exchanged * (s.z * o.x + s.x * o.z)};
}

}  // namespace clray_test
