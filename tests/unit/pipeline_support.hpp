// SPDX-License-Identifier: Apache-2.0
// What the unit tests of packing and of views share: scenes by hand, and placing a point in long double by Rodrigues's
// formula in vector form, which host/pipeline writes as a matrix. Body frame, m, rad.
#ifndef CLRAY_TESTS_PIPELINE_SUPPORT_HPP
#define CLRAY_TESTS_PIPELINE_SUPPORT_HPP

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "clray/scene.hpp"

namespace pipeline_test {

using namespace clray;

using LPoint = std::array<long double, 3>;
constexpr double kEps = 0x1p-53;

inline LPoint point_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}
inline long double dot(const LPoint& a, const LPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Rotation by Rodrigues's formula in vector form: v cos + (k × v) sin + k (k·v)(1 - cos).
inline LPoint turn(const LPoint& axis, long double angle, const LPoint& v) {
  const long double l = std::sqrt(dot(axis, axis)), c = std::cos(angle), s = std::sin(angle);
  const LPoint k{axis[0] / l, axis[1] / l, axis[2] / l};
  const LPoint cross{k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]};
  const long double along = dot(k, v) * (1 - c);
  return {v[0] * c + cross[0] * s + k[0] * along, v[1] * c + cross[1] * s + k[1] * along,
          v[2] * c + cross[2] * s + k[2] * along};
}

inline LPoint placed(const Transform& t, LPoint v) {
  for (auto& x : v) x *= t.scale;
  v = turn(point_of(t.axis), t.angle_rad, v);
  return {v[0] + t.translate.x, v[1] + t.translate.y, v[2] + t.translate.z};
}

inline Scene empty_scene(int materials = 1) {
  Scene scene;
  for (int k = 0; k < materials; ++k) {
    Material m;
    m.name = "m" + std::to_string(k);
    m.parameters = {{"rho", 0.5 + 0.01 * k}};
    scene.materials.push_back(m);
  }
  scene.observers.emplace_back();
  scene.detectors.emplace_back();
  return scene;
}

inline Component& add_shape(Scene& scene, const std::string& shape, const std::map<std::string, double>& keys) {
  Component c;
  c.name = c.shape = shape;
  c.parameters = keys;
  c.materials = {0};
  scene.components.push_back(c);
  return scene.components.back();
}

inline Component& add_mesh(Scene& scene, const Mesh& mesh, std::vector<std::uint32_t> materials = {0}) {
  Component c;
  c.mesh = std::make_shared<Mesh>(mesh);
  c.materials = std::move(materials);
  scene.components.push_back(c);
  return scene.components.back();
}

inline Transform random_transform(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Transform t;
  t.translate = {2 * u(random), 2 * u(random), 2 * u(random)};
  t.axis = {u(random), u(random), u(random)};
  t.angle_rad = 3.0 * u(random);
  t.scale = std::exp2(3 * u(random));
  return t;
}

inline Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Vec3 v(normal(random), normal(random), normal(random));
  const double l = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / l, v.y / l, v.z / l};
}

}  // namespace pipeline_test

#endif
