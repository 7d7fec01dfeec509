// SPDX-License-Identifier: Apache-2.0
// See scenes.hpp.
#include "support/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace clray_test {

using clray::Material;
using clray::Mesh;
using clray::Scene;
using clray::Vec3;

namespace {

std::shared_ptr<Mesh> empty_mesh() {
  auto mesh = std::make_shared<Mesh>();
  mesh->material_slots = {""};
  return mesh;
}

std::uint32_t vertex(Mesh& mesh, Vec3 v) {
  mesh.vertices.push_back(v);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void face(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangle_slot.push_back(0);
}

MeshPtr finished(const std::shared_ptr<Mesh>& mesh) {
  mesh->report.faces = mesh->report.triangles = mesh->triangles.size();
  for (const auto& t : mesh->triangles) {
    const Vec3 a = mesh->vertices[t[0]], b = mesh->vertices[t[1]], c = mesh->vertices[t[2]];
    const Vec3 u = b - a, v = c - a;
    const Vec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    mesh->report.area_m2 += 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  }
  return mesh;
}

/// Points of one circle of `sides` at height z.
std::uint32_t ring(Mesh& mesh, int sides, double radius, double z) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < sides; ++i) {
    const double phi = 2.0 * kPi * i / sides;
    vertex(mesh, {radius * std::cos(phi), radius * std::sin(phi), z});
  }
  return first;
}

/// The band between two rings of `sides`, the second above the first, facing away from the axis.
void band(Mesh& mesh, int sides, std::uint32_t low, std::uint32_t high) {
  for (int i = 0; i < sides; ++i) {
    const auto j = static_cast<std::uint32_t>((i + 1) % sides), k = static_cast<std::uint32_t>(i);
    face(mesh, low + k, low + j, high + j);
    face(mesh, low + k, high + j, high + k);
  }
}

/// Triangles from `tip` to every edge of a ring, counter-clockwise seen from the ring's +z side if `up`.
void fan(Mesh& mesh, int sides, std::uint32_t first, std::uint32_t tip, bool up) {
  for (int i = 0; i < sides; ++i) {
    const auto a = first + static_cast<std::uint32_t>(i), b = first + static_cast<std::uint32_t>((i + 1) % sides);
    up ? face(mesh, a, b, tip) : face(mesh, b, a, tip);
  }
}

}  // namespace

std::string device_name() {
  const char* name = std::getenv("CLRAY_TEST_DEVICE");
  return name ? name : "cpu";
}

clray::Device& device() {
  static clray::Device opened(device_name());
  return opened;
}

Material lambert(double rho) {
  Material m;
  m.name = "lambert";
  m.parameters = {{"rho", rho}};
  return m;
}

Material ashikhmin_shirley(double rho, double d, double n) {
  Material m;
  m.name = m.model = "ashikhmin-shirley";
  m.parameters = {{"rho", rho}, {"d", d}, {"n", n}};
  return m;
}

Material mirror(double reflectance) {
  Material m;
  m.name = m.model = "mirror";
  m.parameters = {{"reflectance", reflectance}};
  return m;
}

MeshPtr plate_mesh(double a, double b) {
  auto mesh = empty_mesh();
  for (const Vec3 v : {Vec3(-a / 2, -b / 2, 0), Vec3(a / 2, -b / 2, 0), Vec3(a / 2, b / 2, 0), Vec3(-a / 2, b / 2, 0)})
    vertex(*mesh, v);
  face(*mesh, 0, 1, 2);
  face(*mesh, 0, 2, 3);
  return finished(mesh);
}

MeshPtr box_mesh(double a, double b, double c) {
  auto mesh = empty_mesh();
  for (int i = 0; i < 8; ++i) vertex(*mesh, {(i & 1 ? a : -a) / 2, (i & 2 ? b : -b) / 2, (i & 4 ? c : -c) / 2});
  const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    face(*mesh, q[0], q[1], q[2]);
    face(*mesh, q[0], q[2], q[3]);
  }
  return finished(mesh);
}

MeshPtr prism_mesh(int sides, double radius, double height) {
  auto mesh = empty_mesh();
  const auto low = ring(*mesh, sides, radius, -height / 2), high = ring(*mesh, sides, radius, height / 2);
  band(*mesh, sides, low, high);
  fan(*mesh, sides, low, vertex(*mesh, {0, 0, -height / 2}), false);
  fan(*mesh, sides, high, vertex(*mesh, {0, 0, height / 2}), true);
  return finished(mesh);
}

MeshPtr cone_mesh(int sides, double radius, double height) {
  auto mesh = empty_mesh();
  const auto base = ring(*mesh, sides, radius, 0);
  fan(*mesh, sides, base, vertex(*mesh, {0, 0, height}), true);
  fan(*mesh, sides, base, vertex(*mesh, {0, 0, 0}), false);
  return finished(mesh);
}

MeshPtr sphere_mesh(int slices, int stacks, double radius) {
  auto mesh = empty_mesh();
  std::uint32_t below = 0;
  for (int k = 1; k < stacks; ++k) {  // from the south pole up
    const double theta = kPi * (1.0 - static_cast<double>(k) / stacks);
    const auto here = ring(*mesh, slices, radius * std::sin(theta), radius * std::cos(theta));
    if (k == 1) fan(*mesh, slices, here, vertex(*mesh, {0, 0, -radius}), false);
    if (k > 1) band(*mesh, slices, below, here);
    if (k == stacks - 1) fan(*mesh, slices, here, vertex(*mesh, {0, 0, radius}), true);
    below = here;
  }
  return finished(mesh);
}

MeshPtr bowl_mesh(int slices, int stacks, double radius, double low, double high) {
  auto mesh = empty_mesh();
  const auto at = [&](int k) { return low + (high - low) * k / stacks; };
  std::uint32_t below = 0;
  for (int k = stacks; k >= 0; --k) {
    if (k == stacks && high > kPi - 1e-9) continue;  // the pole itself is a fan's tip
    const auto here = ring(*mesh, slices, radius * std::sin(at(k)), radius * std::cos(at(k)));
    const bool first = k == stacks || (k == stacks - 1 && high > kPi - 1e-9);
    if (first && k == stacks - 1) fan(*mesh, slices, here, vertex(*mesh, {0, 0, -radius}), false);
    if (!first) band(*mesh, slices, below, here);
    below = here;
  }
  for (auto& t : mesh->triangles) std::swap(t[1], t[2]);  // seen from inside
  return finished(mesh);
}

MeshPtr moved(const MeshPtr& mesh, Vec3 by, double scale) {
  auto copy = std::make_shared<Mesh>(*mesh);
  for (Vec3& v : copy->vertices) v = scale * v + by;
  copy->report.area_m2 *= scale * scale;
  return copy;
}

MeshPtr merged(const std::vector<MeshPtr>& parts) {
  auto mesh = empty_mesh();
  for (const MeshPtr& part : parts) {
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), part->vertices.begin(), part->vertices.end());
    for (const auto& t : part->triangles) face(*mesh, first + t[0], first + t[1], first + t[2]);
  }
  return finished(mesh);
}

Vec3 toward(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

clray::Component& add(Scene& scene, const MeshPtr& mesh, const Material& material) {
  clray::Component component;
  component.name = "part" + std::to_string(scene.components.size());
  component.mesh = mesh;
  component.materials = {static_cast<std::uint32_t>(scene.materials.size())};
  scene.materials.push_back(material);
  scene.materials.back().name += std::to_string(scene.components.size());
  scene.components.push_back(component);
  return scene.components.back();
}

clray::Component& add(Scene& scene, const std::string& shape, const std::map<std::string, double>& keys,
                      const Material& material) {
  clray::Component& component = add(scene, nullptr, material);
  component.shape = shape;
  component.parameters = keys;
  return component;
}

namespace {

Scene bare_scene() {
  Scene scene;
  scene.name = "test";
  scene.trace.method = clray::Method::points;  // even with a target: who wants exact numbers says so
  scene.observers.resize(1);
  scene.detectors.resize(1);
  scene.detectors[0].name = "delay";
  return rays(scene, 18);
}

}  // namespace

Scene scene_of(const MeshPtr& mesh, const Material& material) {
  Scene scene = bare_scene();
  add(scene, mesh, material);
  return scene;
}

Scene scene_of(const std::string& shape, const std::map<std::string, double>& keys, const Material& material) {
  Scene scene = bare_scene();
  add(scene, shape, keys, material);
  return scene;
}

Scene& monostatic(Scene& scene, Vec3 s) {
  scene.source.direction = s;
  scene.observers.assign(1, clray::Observer{});
  scene.observers[0].direction = s;
  return scene;
}

Scene& bistatic(Scene& scene, Vec3 s, Vec3 o) {
  scene.source.direction = s;
  scene.observers.assign(1, clray::Observer{});
  scene.observers[0].direction = o;
  scene.observers[0].monostatic = false;
  return scene;
}

Scene& detect(Scene& scene, const std::string& kind, const std::map<std::string, double>& keys) {
  scene.detectors.assign(1, clray::DetectorSpec{kind, kind, keys});
  return scene;
}

Scene& window(Scene& scene, double first_s, double last_s, int bins) {
  return detect(scene, "delay",
                {{"start_ns", first_s * 1e9}, {"stop_ns", last_s * 1e9}, {"bins", static_cast<double>(bins)}});
}

Scene& rays(Scene& scene, int log2_rays, std::uint64_t seed) {
  return many_rays(scene, long_tests() ? log2_rays : std::min(log2_rays, 15), seed);
}

Scene& many_rays(Scene& scene, int log2_rays, std::uint64_t seed) {
  scene.trace.rays = 1ull << log2_rays;
  scene.trace.seed = seed;
  return scene;
}

clray::Result run(const Scene& scene) {
  return clray::trace(scene, device());
}

bool long_tests() {
  const char* asked = std::getenv("CLRAY_LONG_TESTS");
  return asked != nullptr && std::string(asked) == "1";
}

}  // namespace clray_test
