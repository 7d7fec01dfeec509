// SPDX-License-Identifier: Apache-2.0
// From components to packed primitives: canonical order, and exact extents of every shape against dense sampling of its
// surface. Expected values are worked out here in long double.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "body/geometry.hpp"
#include "kernels/shape_model.hpp"
#include "scene/tables.hpp"
#include "unit/pipeline_support.hpp"

using namespace clray;
using namespace pipeline_test;

namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_geometry(const Geometry& a, const Geometry& b) {
  return same_bytes(a.primitives, b.primitives) && same_bytes(a.shapes, b.shapes) && same_bytes(a.nodes, b.nodes);
}

/// `count` random triangles of vertices on a coarse lattice: shared corners, copies and zero areas occur.
Mesh lattice_mesh(int count, std::uint64_t seed, int slots) {
  std::mt19937_64 random(seed);
  Mesh mesh;
  for (int i = 0; i < 27; ++i) mesh.vertices.emplace_back(i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0);
  for (int t = 0; t < count; ++t) {
    const auto pick = [&] { return static_cast<std::uint32_t>(random() % 27); };
    mesh.triangles.push_back({pick(), pick(), pick()});
    mesh.triangle_slot.push_back(static_cast<std::uint32_t>(random() % static_cast<unsigned>(slots)));
  }
  mesh.material_slots.assign(static_cast<std::size_t>(slots), "");
  return mesh;
}

/// The same triangles in another order, from other first corners, of vertices in another order (and -0 for 0).
Mesh shuffled(const Mesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Mesh out = mesh;
  std::vector<std::uint32_t> vertex(mesh.vertices.size()), triangle(mesh.triangles.size());
  for (std::uint32_t k = 0; k < vertex.size(); ++k) vertex[k] = k;
  for (std::uint32_t k = 0; k < triangle.size(); ++k) triangle[k] = k;
  std::shuffle(vertex.begin(), vertex.end(), random);
  std::shuffle(triangle.begin(), triangle.end(), random);
  for (std::uint32_t k = 0; k < vertex.size(); ++k) {
    Vec3 v = mesh.vertices[k];
    for (int axis = 0; axis < 3; ++axis)
      if (v[axis] == 0.0 && random() % 2) v[axis] = -0.0;
    out.vertices[vertex[k]] = v;
  }
  for (std::size_t k = 0; k < triangle.size(); ++k) {
    auto t = mesh.triangles[triangle[k]];
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random() % 3), t.end());
    out.triangles[k] = {vertex[t[0]], vertex[t[1]], vertex[t[2]]};
    out.triangle_slot[k] = mesh.triangle_slot[triangle[k]];
  }
  return out;
}

double extent_high(const Geometry& g, const Vec3& u, double* low = nullptr) {
  double a, b;
  body_extent(g, std::vector<RigidMotion>(g.parts.size()), {{u.x, u.y, u.z}}, &a, &b);
  if (low) *low = a;
  return b;
}

/// max of u·x over a case's surface: a grid over each face, then ever finer grids about the best point.
long double sampled_support(const shape_model::Case& c, const Transform& t, const LPoint& u) {
  long double best = -1e300L;
  for (int face = 0; face < shape_model::faces(c); ++face) {
    double cu = 0.5, cv = 0.5, width = 0.5;
    long double face_best = -1e300L;
    for (int pass = 0; pass < 12; ++pass, width /= 5) {
      const int n = 24;
      double bu = cu, bv = cv;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          const double x = std::clamp(cu + width * (2.0 * i / n - 1.0), 0.0, 1.0);
          const double y = cv + width * (2.0 * j / n - 1.0);
          if (c.row == shape_kernels::CLRAY_SHAPE_box || c.row == shape_kernels::CLRAY_SHAPE_rectangle) {
            if (y < 0.0 || y > 1.0) continue;
          }
          const vec3 p = shape_model::surface_at(c, face, x, y);
          const long double h = dot(u, placed(t, {p.x, p.y, p.z}));
          if (h > face_best) {
            face_best = h;
            bu = x;
            bv = y;
          }
        }
      cu = bu;
      cv = bv;
    }
    best = std::max(best, face_best);
  }
  return best;
}

std::map<std::string, double> keys_of(const shape_model::Case& c) {
  std::map<std::string, double> keys;
  const TableRow& row = table("shape")[c.row];
  for (std::size_t k = 0; k < c.p.size(); ++k) keys[row.keys[k].name] = c.p[k];
  return keys;
}

}  // namespace

TEST_CASE("any order of triangles, vertices and first corners packs to the same bytes") {
  const Mesh mesh = lattice_mesh(400, 1, 3);
  Scene scene = empty_scene(3);
  add_mesh(scene, mesh, {0, 1, 2});
  const Geometry reference = build_geometry(scene);
  CHECK(reference.primitives.size() > 300);
  CHECK(reference.primitives.size() < 400);  // copies and zero areas are gone
  std::set<std::uint32_t> ids;
  for (const ClrayPrimitive& p : reference.primitives) ids.insert(p.id);
  CHECK(ids.size() == reference.primitives.size());
  CHECK(*ids.rbegin() == reference.primitives.size() - 1);
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    Scene other = empty_scene(3);
    add_mesh(other, shuffled(mesh, seed), {0, 1, 2});
    CHECK(same_geometry(build_geometry(other), reference));
  }
  // Not only the same: a flipped triangle is another body.
  Mesh changed = mesh;
  for (auto& t : changed.triangles) std::swap(t[1], t[2]);
  Scene other = empty_scene(3);
  add_mesh(other, changed, {0, 1, 2});
  CHECK(!same_geometry(build_geometry(other), reference));
}

TEST_CASE("the ids rank triangles by their numbers, each begun at its smallest vertex with its winding kept") {
  Scene scene = empty_scene();
  const Mesh mesh = lattice_mesh(200, 5, 1);
  add_mesh(scene, mesh);
  const Geometry g = build_geometry(scene);
  std::vector<const double*> by_id(g.primitives.size());
  for (const ClrayPrimitive& p : g.primitives) by_id[p.id] = g.shapes.data() + p.data;
  std::set<std::array<double, 9>> given;
  for (const auto& t : mesh.triangles)
    for (int first = 0; first < 3; ++first) {
      std::array<double, 9> x;
      for (int k = 0; k < 9; ++k) x[k] = mesh.vertices[t[(first + k / 3) % 3]][k % 3];
      given.insert(x);
    }
  for (std::size_t k = 0; k < by_id.size(); ++k) {
    std::array<double, 9> x;
    std::copy(by_id[k], by_id[k] + 9, x.begin());
    CHECK(given.count(x) == 1);  // winding kept: one of the three turns of a triangle of the file
    const Point a{{x[0], x[1], x[2]}}, b{{x[3], x[4], x[5]}}, c{{x[6], x[7], x[8]}};
    CHECK(a < b);
    CHECK(a < c);
    if (k > 0) CHECK(std::lexicographical_compare(by_id[k - 1], by_id[k - 1] + 9, by_id[k], by_id[k] + 9));
  }
}

TEST_CASE(
    "numbers of triangles follow one another, shared planes behind them: kernels read no record for their place") {
  Scene scene = empty_scene(3);
  add_mesh(scene, lattice_mesh(400, 1, 3), {0, 1, 2});  // many overlap in one plane
  const Geometry body = build_geometry(scene);
  REQUIRE(body.shared_planes);
  std::size_t planes = 0;
  for (std::size_t k = 0; k < body.primitives.size(); ++k) {
    CHECK(body.primitives[k].data == 9 * k);
    if (body.primitives[k].planes == CLRAY_NO_PLANES) continue;
    CHECK(body.primitives[k].planes >= 9 * body.primitives.size());
    ++planes;
  }
  CHECK(planes > 100);
}

TEST_CASE("of coincident triangles the same one is kept in any order: by material, then by component") {
  const Mesh mesh = lattice_mesh(300, 9, 2);
  Mesh copies = mesh;  // all of it again, with the slots exchanged
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    copies.triangles.push_back(mesh.triangles[t]);
    copies.triangle_slot.push_back(1 - mesh.triangle_slot[t]);
  }
  Scene scene = empty_scene(2);
  add_mesh(scene, copies, {0, 1});
  const Geometry reference = build_geometry(scene);
  for (std::uint64_t seed = 20; seed < 24; ++seed) {
    Scene other = empty_scene(2);
    add_mesh(other, shuffled(copies, seed), {0, 1});
    CHECK(same_geometry(build_geometry(other), reference));
  }
  Scene two = empty_scene(1);
  add_mesh(two, mesh, {0, 0});
  add_mesh(two, mesh, {0, 0});
  const Geometry both = build_geometry(two);
  for (const ClrayPrimitive& p : both.primitives) CHECK(p.component == 0);
  for (std::uint64_t seed = 30; seed < 34; ++seed) {
    Scene other = empty_scene(1);
    add_mesh(other, shuffled(mesh, seed), {0, 0});
    add_mesh(other, shuffled(mesh, seed + 100), {0, 0});
    CHECK(same_geometry(build_geometry(other), both));
  }
}

TEST_CASE("the extent of every shape is that of its points, however it is placed") {
  std::set<u32> rows;
  std::mt19937_64 random(11);
  for (const shape_model::Case& c : shape_model::cases()) {
    CAPTURE(c.name);
    rows.insert(c.row);
    for (int k = 0; k < 12; ++k) {
      Scene scene = empty_scene();
      Component& component = add_shape(scene, table("shape")[c.row].name, keys_of(c));
      if (k > 0) component.transform = random_transform(random);
      const Transform t = component.transform;
      const Geometry g = build_geometry(scene);
      Vec3 u = random_direction(random);
      if (k < 4) u = {k == 1, k == 2, k == 0 || k == 3};
      double low;
      const double high = extent_high(g, u, &low);
      const double size = c.size * t.scale + 4.0;
      // From below up to rounding, and reached: the last grid is 2e-9 wide and the surface smooth or cornered there,
      // the parameter's ends (rims, edges) are among its points.
      const LPoint up = point_of(u), down{-up[0], -up[1], -up[2]};
      const auto above = static_cast<double>(sampled_support(c, t, up) - high);
      const auto below = static_cast<double>(sampled_support(c, t, down) + low);
      CHECK(above < 64 * kEps * size);
      CHECK(above > -1e-9 * size);
      CHECK(below < 64 * kEps * size);
      CHECK(below > -1e-9 * size);
      for (int axis = 0; axis < 3; ++axis) {  // the part's box holds the same points
        Vec3 e(0.0);
        e[axis] = 1.0;
        double axis_low;
        const double axis_high = extent_high(g, e, &axis_low);
        CHECK(g.parts[0].box.high[axis] >= axis_high - 8 * kEps * size);
        CHECK(g.parts[0].box.high[axis] < axis_high + 64 * kEps * size);
        CHECK(g.parts[0].box.low[axis] <= axis_low + 8 * kEps * size);
        CHECK(g.parts[0].box.low[axis] > axis_low - 64 * kEps * size);
      }
    }
  }
  CHECK(rows.size() == table("shape").size() - 1);  // every row but the mesh
}

TEST_CASE("the extent of a hinged part follows its hinge") {
  // A plate 2 × 1 in z = 0, turned by 0.7 rad about the line through (0, 0.5, 0) along x: heights ±... in closed form.
  Scene scene = empty_scene();
  Component& plate = add_shape(scene, "rectangle", {{"size_x", 2.0}, {"size_y", 1.0}});
  plate.hinge = Hinge();
  plate.hinge->point = {0.0, 0.5, 0.0};
  plate.hinge->angle_rad = 0.7;
  const Geometry g = build_geometry(scene);
  REQUIRE(g.parts.size() == 1);
  const std::vector<RigidMotion> motions{part_motion(scene, g.parts[0], {0, 0, 1}, {0, 0, 1})};
  double low, high;
  body_extent(g, motions, {{0, 0, 1}}, &low, &high);
  CHECK(high == doctest::Approx(0.0).epsilon(1e-15));
  CHECK(low == doctest::Approx(-std::sin(0.7)).epsilon(4 * kEps));
  body_extent(g, motions, {{0, 1, 0}}, &low, &high);
  CHECK(high == doctest::Approx(0.5).epsilon(4 * kEps));
  CHECK(low == doctest::Approx(0.5 - std::cos(0.7)).epsilon(8 * kEps));
  body_extent(g, motions, {{1, 0, 0}}, &low, &high);
  CHECK(high == doctest::Approx(1.0).epsilon(2 * kEps));
  // The sphere about the body holds the plate at any angle: its far edge swings 1 about the hinge.
  CHECK(g.radius >= 1.0);
}
