// SPDX-License-Identifier: Apache-2.0
// See end_bodies.hpp. The assembly stands for a satellite's full model: panels that carry cell strings as slivers, rods
// behind them, and equipment of all sizes on six sides of a box, much of it hidden.
#include "end_bodies.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>

namespace clray_bench {

using clray::Vec3;
using clray_test::kPi;
using clray_test::MeshPtr;

namespace {

double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 unit(const Vec3& a) {
  return (1.0 / std::sqrt(dot(a, a))) * a;
}

class Builder {
 public:
  std::size_t triangles() const { return mesh_->triangles.size(); }

  std::uint32_t corner(const Vec3& p) {
    mesh_->vertices.push_back(p);
    return static_cast<std::uint32_t>(mesh_->vertices.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_->triangles.push_back({a, b, c}); }

  /// A box by its centre and half of its edges.
  void box(const Vec3& centre, const Vec3& x, const Vec3& y, const Vec3& z) {
    constexpr std::uint32_t kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const auto sign = [](bool plus) { return plus ? 1.0 : -1.0; };
    const auto first = static_cast<std::uint32_t>(mesh_->vertices.size());
    for (int k = 0; k < 8; ++k) corner(centre + sign(k & 1) * x + sign(k & 2) * y + sign(k & 4) * z);
    for (const auto& f : kFaces) triangle(first + f[0], first + f[1], first + f[2]);
  }

  /// A closed prism about an axis: 4·sides triangles.
  void prism(const Vec3& centre, const Vec3& axis, double radius, double half_length, std::uint32_t sides) {
    const Vec3 w = unit(axis), u = across(w), v = cross(w, u);
    const auto first = static_cast<std::uint32_t>(mesh_->vertices.size());
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2.0 * kPi * k / sides;
      const Vec3 p = centre + radius * std::cos(angle) * u + radius * std::sin(angle) * v;
      corner(p - half_length * w);
      corner(p + half_length * w);
    }
    const std::uint32_t low = corner(centre - half_length * w), high = corner(centre + half_length * w);
    for (std::uint32_t k = 0; k < sides; ++k) {
      const std::uint32_t p = first + 2 * k, q = first + 2 * ((k + 1) % sides);
      triangle(p, q, p + 1);
      triangle(q, q + 1, p + 1);
      triangle(low, q, p);
      triangle(high, p + 1, q + 1);
    }
  }

  static Vec3 across(const Vec3& w) {
    return unit(cross(w, std::fabs(w.x) > 0.7 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0)));
  }

  MeshPtr done() {
    mesh_->material_slots = {""};
    mesh_->triangle_slot.assign(mesh_->triangles.size(), 0);
    return std::move(mesh_);
  }

 private:
  std::shared_ptr<clray::Mesh> mesh_ = std::make_shared<clray::Mesh>();
};

MeshPtr box_wing() {
  Builder b;
  b.box({0, 0, 0}, {0.5, 0, 0}, {0, 0.6, 0}, {0, 0, 0.8});
  const double c = std::cos(0.35), s = std::sin(0.35);
  for (const double y : {2.3, -2.3}) b.box({0, y, 0}, {0, 1.5, 0}, {0.4 * c, 0, 0.4 * s}, {-0.005 * s, 0, 0.005 * c});
  return b.done();
}

class Random {
 public:
  double between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  Vec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 engine_{12345};
};

/// A wing panel of 1.8 m x 2 m with 240 cell strings of 4 mm on its front and 24 rods behind it.
void add_panel(Builder* b, double side, double inner_y) {
  b->box({0, inner_y + side, 0}, {0.9, 0, 0}, {0, 1, 0}, {0, 0, 0.01});
  for (int k = 0; k < 240; ++k)
    b->box({0, inner_y + side * (0.01 + 1.98 * k / 240), 0.0125}, {0.89, 0, 0}, {0, 0.002, 0}, {0, 0, 0.0015});
  for (int k = 0; k < 24; ++k) b->prism({-0.85 + 1.7 * k / 24, inner_y + side, -0.02}, {0, 1, 0}, 0.003, 1, 6);
}

/// One piece of equipment on a random side of the box: a box, a drum, a thin sheet or a rod.
void add_equipment(Builder* b, Random* random) {
  const int side = static_cast<int>(random->between(0, 6));
  double at[3] = {random->between(-1, 1), random->between(-1, 1), random->between(-1.5, 1.5)};
  double outward[3] = {0, 0, 0};
  const double sign = side % 2 == 0 ? 1.0 : -1.0;
  at[side / 2] = sign * (side / 2 == 2 ? 1.5 : 1.0);
  outward[side / 2] = sign;
  const Vec3 n(outward[0], outward[1], outward[2]), u = Builder::across(n), v = cross(n, u);
  const double size = 0.01 * std::pow(random->between(0.0005, 1), -0.45), kind = random->between(0, 1);
  const Vec3 centre = Vec3(at[0], at[1], at[2]) + random->between(0, 0.25) * n;
  if (kind < 0.45) {
    const double x = random->between(0.3, 1), y = random->between(0.3, 1), z = random->between(0.2, 1);
    b->box(centre, size * x * u, size * y * v, size * z * n);
  } else if (kind < 0.7) {
    const Vec3 axis = random->between(0, 1) < 0.5 ? n : random->direction();
    const double radius = size * random->between(0.2, 0.6), length = size * random->between(0.5, 1.5);
    b->prism(centre, axis, radius, length, 12 + 4 * static_cast<std::uint32_t>(random->between(0, 8)));
  } else if (kind < 0.85) {
    const Vec3 w = random->direction(), a = Builder::across(w);
    b->box(centre, 1.5 * size * a, size * cross(w, a), 0.0005 * w);
  } else {
    const Vec3 w = random->direction();
    b->prism(centre + 4 * size * w, w, 0.0015, std::min(8 * size, 1.5), 6);
  }
}

MeshPtr assembly() {
  constexpr std::size_t kTriangles = 201028, kMostOfOne = 4 * 44;
  Builder b;
  Random random;
  b.box({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.5});
  for (const double side : {-1.0, 1.0}) {
    for (int panel = 0; panel < 4; ++panel) add_panel(&b, side, side * (1.6 + 2.1 * panel));
  }
  while (b.triangles() + kMostOfOne + 1024 < kTriangles) add_equipment(&b, &random);
  // A drum on top has the triangles that are left.
  b.prism({0, 0, 2.2}, {0, 0, 1}, 0.8, 0.05, static_cast<std::uint32_t>((kTriangles - b.triangles()) / 4));
  return b.done();
}

/// Smooth noise: random numbers at the points of a lattice, -1 to 1, blended between them.
double noise(const Vec3& p) {
  const auto at = [](int x, int y, int z) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                      static_cast<std::uint32_t>(z) * 83492791u;
    h = (h ^ h >> 16) * 0x7feb352du;
    h = (h ^ h >> 15) * 0x846ca68bu;
    return (h ^ h >> 16) * (2.0 / 4294967295.0) - 1.0;
  };
  const double c[3] = {p.x, p.y, p.z};
  int low[3];
  double blend[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::floor(c[k]));
    const double t = c[k] - low[k];
    blend[k] = t * t * (3 - 2 * t);
  }
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    double w = 1;
    for (int axis = 0; axis < 3; ++axis) w *= k >> axis & 1 ? blend[axis] : 1 - blend[axis];
    sum += w * at(low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2));
  }
  return sum;
}

/// A cube's faces blown up to a sphere of 1 m with bumps of up to 0.16 m in five octaves.
MeshPtr bumpy_sphere() {
  constexpr std::uint32_t kCells = 289;  // along an edge of the cube: 12·289² triangles
  Builder b;
  for (int face = 0; face < 6; ++face) {
    const double side = face % 2 == 0 ? 1.0 : -1.0;
    const int axis = face / 2;
    const std::uint32_t first = static_cast<std::uint32_t>(face) * (kCells + 1) * (kCells + 1);
    for (std::uint32_t j = 0; j <= kCells; ++j) {
      for (std::uint32_t i = 0; i <= kCells; ++i) {
        double c[3];
        c[axis] = side;
        c[(axis + 1) % 3] = side * std::tan((2.0 * i / kCells - 1) * kPi / 4);
        c[(axis + 2) % 3] = std::tan((2.0 * j / kCells - 1) * kPi / 4);
        const Vec3 p = unit(Vec3(c[0], c[1], c[2]));
        double height = 0, amplitude = 0.08, frequency = 5;
        for (int octave = 0; octave < 5; ++octave, amplitude *= 0.5, frequency *= 2.1)
          height += amplitude * noise(frequency * p);
        b.corner((1 + height) * p);
      }
    }
    for (std::uint32_t j = 0; j < kCells; ++j) {
      for (std::uint32_t i = 0; i < kCells; ++i) {
        const std::uint32_t q = first + j * (kCells + 1) + i;
        b.triangle(q, q + 1, q + kCells + 2);
        b.triangle(q, q + kCells + 2, q + kCells + 1);
      }
    }
  }
  return b.done();
}

/// The mesh of a file, all of one material.
MeshPtr mesh_of_file(const std::string& path) {
  const clray::Scene scene = clray::load_scene(path);
  if (scene.components.size() != 1 || !scene.components[0].mesh) throw std::runtime_error(path + ": expected one mesh");
  auto mesh = std::make_shared<clray::Mesh>(*scene.components[0].mesh);
  mesh->material_slots = {""};
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  return mesh;
}

}  // namespace

std::vector<EndBody> end_bodies(const Options& options) {
  std::vector<EndBody> bodies = {{"box-wing", box_wing}};
  for (const std::string& path : options.meshes)
    bodies.push_back({std::filesystem::path(path).stem(), [path] { return mesh_of_file(path); }});
  bodies.push_back({"assembly", assembly});
  bodies.push_back({"bumpy sphere", bumpy_sphere});
  return bodies;
}

}  // namespace clray_bench
