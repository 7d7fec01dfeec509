// SPDX-License-Identifier: Apache-2.0
// The half-edge view: parts, closedness, convexity, polygons and preview of bodies whose answers are known by hand, and
// the exact predicates against integers of 128 bits (over 400 lines: one view, its bodies and its references together).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <random>

#include "body/mesh_exact.hpp"
#include "body/mesh_half_edges.hpp"
#include "scene_mesh_files.hpp"
#include "unit/patience.hpp"

using namespace mesh_test;
using clray::HalfEdges;
using clray::MeshPart;
using clray::MeshPolygon;
using clray::Vec3;

namespace {

std::string moved_box(double x, double y, double z, int first) {
  std::string text;
  for (const auto& p : {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 3, 0), Vec3(0, 3, 0), Vec3(0, 0, 4), Vec3(2, 0, 4),
                        Vec3(2, 3, 4), Vec3(0, 3, 4)})
    text += "v " + std::to_string(p.x + x) + " " + std::to_string(p.y + y) + " " + std::to_string(p.z + z) + "\n";
  const int quads[6][4] = {{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5}, {3, 4, 8, 7}, {2, 3, 7, 6}, {1, 5, 8, 4}};
  for (const auto& q : quads) {
    text += "f";
    for (const int corner : q) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

/// Each triangle with points of its own, as in an STL file.
clray::Mesh torn(const clray::Mesh& mesh) {
  clray::Mesh out;
  for (const auto& t : mesh.triangles) {
    const auto n = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::uint32_t v : t) out.vertices.push_back(mesh.vertices[v]);
    out.triangles.push_back({n, n + 1, n + 2});
  }
  out.triangle_slot = mesh.triangle_slot;
  out.material_slots = mesh.material_slots;
  return out;
}

/// Area within the loops of a polygon, holes off, and the normal that they turn about.
Vec3 area_vector(const MeshPolygon& polygon, const std::vector<Vec3>& points) {
  Vec3 sum(0.0);
  for (const auto& loop : polygon.loops) {
    for (std::size_t k = 0; k < loop.size(); ++k)
      sum += 0.5 * glm::cross(points[loop[k]] - points[loop[0]], points[loop[(k + 1) % loop.size()]] - points[loop[0]]);
  }
  return sum;
}

void check_closed_box(const HalfEdges& view, const std::vector<Vec3>& points) {
  const std::vector<MeshPart> parts = view.parts();
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].triangles == 12);
  CHECK(parts[0].closed);
  CHECK(parts[0].convex);
  CHECK(view.refused().empty());
  CHECK(view.collapsed().empty());
  const std::vector<MeshPolygon> polygons = view.polygons();
  REQUIRE(polygons.size() == 6);
  double area = 0.0;
  Vec3 sum(0.0);
  for (const MeshPolygon& polygon : polygons) {
    CHECK(polygon.triangles.size() == 2);
    REQUIRE(polygon.loops.size() == 1);
    CHECK(polygon.loops[0].size() == 4);
    const Vec3 a = area_vector(polygon, points);
    area += glm::length(a);
    sum += a;
  }
  CHECK(area == 52.0);
  CHECK(sum == Vec3(0.0));
}

/// A grid of cells in z = 0, those for which `keep` is true, each of two triangles.
clray::Mesh plate(int n, const std::function<bool(int, int)>& keep) {
  clray::Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, j, 0.0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if (!keep(i, j)) continue;
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), up = static_cast<std::uint32_t>(n + 1);
      mesh.triangles.push_back({a, a + 1, a + up + 1});
      mesh.triangles.push_back({a, a + up + 1, a + up});
    }
  }
  mesh.triangle_slot.assign(mesh.triangles.size(), 0);
  mesh.material_slots = {""};
  return mesh;
}

/// n × m quads round a torus of radii 2 and 1, or twisted by half a turn (then they have one side).
clray::Mesh ring(int n, int m, bool moebius) {
  clray::Mesh mesh;
  const double pi = std::acos(-1.0);
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * i / n;
    for (int j = 0; j < m; ++j) {
      const double b = 2 * pi * j / m, s = moebius ? j - 0.5 : 0.0;
      const double r = moebius ? 2 + s * std::cos(a / 2) : 2 + std::cos(b);
      mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), moebius ? s * std::sin(a / 2) : std::sin(b));
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < (moebius ? m - 1 : m); ++j) {
      const bool turn = moebius && i + 1 == n;  // the far side meets the near one upside down
      const auto at = [&](int di, int dj) {
        const int row = turn && di == 1 ? m - 1 - (j + dj) : (j + dj) % m;
        return static_cast<std::uint32_t>((i + di) % n * m + row);
      };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  mesh.triangle_slot.assign(mesh.triangles.size(), 0);
  return mesh;
}

}  // namespace

TEST_CASE("a box: one part, closed, convex, six polygons, whether its triangles share vertices or not") {
  const auto box = load_text(kBox);
  check_closed_box(HalfEdges(*box), box->vertices);
  const clray::Mesh soup = torn(*box);
  check_closed_box(HalfEdges(soup), soup.vertices);
}

TEST_CASE("a box turned by a rational rotation has six polygons exactly") {
  // Columns of the rotation times 9: (1,8,4), (4,-4,7), (8,1,-4) are orthogonal, each of length 9.
  const auto box = load_text(kBox);
  std::vector<Vec3> points;
  for (const Vec3& p : box->vertices)
    points.push_back(p.x * Vec3(1, 8, 4) + p.y * Vec3(4, -4, 7) + p.z * Vec3(8, 1, -4));
  const HalfEdges view(points, box->triangles);
  CHECK(view.polygons().size() == 6);
  CHECK(view.parts()[0].closed);
  // One corner moved by one unit in the last place: the three faces that meet there break, whatever the scale.
  points[6].x = std::nextafter(points[6].x, 1e9);
  CHECK(HalfEdges(points, box->triangles).polygons().size() == 9);
}

TEST_CASE("two boxes, apart, at one corner, along one edge") {
  const auto apart = load_text(moved_box(0, 0, 0, 0) + moved_box(5, 0, 0, 8));
  std::vector<std::uint32_t> part_of;
  std::vector<MeshPart> parts = HalfEdges(*apart).parts(&part_of);
  REQUIRE(parts.size() == 2);
  CHECK((parts[0].convex && parts[1].convex));
  CHECK(std::count(part_of.begin(), part_of.end(), 0u) == 12);
  CHECK(part_of[0] == 0);
  CHECK(part_of[23] == 1);
  const auto corner = load_text(moved_box(0, 0, 0, 0) + moved_box(2, 3, 4, 8));
  parts = HalfEdges(*corner).parts();
  REQUIRE(parts.size() == 2);
  CHECK((parts[0].closed && parts[1].closed));
  // An edge of four faces: each half-edge there finds a partner that goes back, so nothing is refused for direction
  // alone, but two of the four go each way.
  const auto edge = load_text(moved_box(0, 0, 0, 0) + moved_box(2, 3, 0, 8));
  const HalfEdges view(*edge);
  CHECK(view.refused().size() == 2);
  parts = view.parts();
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].triangles == 24);
  CHECK(!parts[0].closed);
  CHECK(!parts[0].convex);
}

TEST_CASE("open, one-sided and non-manifold surfaces") {
  const auto torus = ring(24, 12, false);
  std::vector<MeshPart> parts = HalfEdges(torus).parts();
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].closed);
  CHECK(!parts[0].convex);
  const HalfEdges strip(ring(20, 3, true));
  parts = strip.parts();
  REQUIRE(parts.size() == 1);
  CHECK(!parts[0].closed);
  CHECK(strip.refused().size() == 2);  // of each of two rows the one triangle that closes it
  // Three wings on one directed edge: one finds room.
  const auto fan = load_text("v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
  const HalfEdges wings(*fan);
  CHECK(wings.refused() == std::vector<std::uint32_t>{1, 2});
  CHECK(wings.parts().size() == 1);
  CHECK(wings.polygons().size() == 3);
  // Two triangles at one vertex hang together by no edge.
  const auto bow = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 -1 0\nf 1 2 3\nf 1 4 5\n");
  CHECK(HalfEdges(*bow).parts().size() == 2);
  CHECK(HalfEdges(*bow).refused().empty());
  // The same face twice, and a face of coinciding corners.
  const auto twice = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 1 0\nf 1 2 3\nf 1 2 3\nf 2 3 4\n");
  const HalfEdges pair(*twice);
  CHECK(pair.refused() == std::vector<std::uint32_t>{1});
  CHECK(pair.collapsed() == std::vector<std::uint32_t>{2});
  std::vector<std::uint32_t> part_of;
  CHECK(pair.parts(&part_of).size() == 1);
  CHECK(part_of == std::vector<std::uint32_t>{0, 0, HalfEdges::kNone});
}

TEST_CASE("an open box is not closed; a box inside out is closed and not convex") {
  auto box = *load_text(kBox);
  for (auto& t : box.triangles) std::swap(t[1], t[2]);
  std::vector<MeshPart> parts = HalfEdges(box).parts();
  CHECK(parts[0].closed);
  CHECK(!parts[0].convex);
  box = *load_text(kBox);
  box.triangles.pop_back();
  parts = HalfEdges(box).parts();
  REQUIRE(parts.size() == 1);
  CHECK(!parts[0].closed);
}

TEST_CASE("walls that go twice round a star turn left at every edge and are not convex") {
  for (const int times : {1, 2, 3}) {
    clray::Mesh star;
    const std::uint32_t n = 7;
    for (std::uint32_t k = 0; k < n; ++k) {
      const double a = 2 * std::acos(-1.0) * times * k / n;
      for (const double z : {0.0, 1.0}) star.vertices.emplace_back(std::cos(a), std::sin(a), z);
    }
    star.vertices.emplace_back(0, 0, 0);
    star.vertices.emplace_back(0, 0, 1);
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % n);
      star.triangles.insert(star.triangles.end(),
                            {{a, b, b + 1}, {a, b + 1, a + 1}, {b, a, 2 * n}, {a + 1, b + 1, 2 * n + 1}});
    }
    const std::vector<MeshPart> parts = HalfEdges(star).parts();
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].closed);
    CHECK(parts[0].convex == (times == 1));
  }
}

TEST_CASE("a plate of many triangles is one polygon; holes are loops of their own") {
  const auto whole = plate(12, [](int, int) { return true; });
  std::vector<MeshPolygon> polygons = HalfEdges(whole).polygons();
  REQUIRE(polygons.size() == 1);
  CHECK(polygons[0].triangles.size() == 288);
  REQUIRE(polygons[0].loops.size() == 1);
  CHECK(polygons[0].loops[0].size() == 48);
  CHECK(area_vector(polygons[0], whole.vertices) == Vec3(0, 0, 144));
  const auto holes = plate(12, [](int i, int j) { return !(i > 1 && i < 4 && j > 1 && j < 5) && !(i == 8 && j == 8); });
  polygons = HalfEdges(holes).polygons();
  REQUIRE(polygons.size() == 1);
  REQUIRE(polygons[0].loops.size() == 3);
  CHECK(polygons[0].loops[0].size() == 48);  // the outline first
  CHECK(area_vector(polygons[0], holes.vertices) == Vec3(0, 0, 144 - 6 - 1));
  // Two islands are two polygons; a chessboard's fields meet at corners only.
  CHECK(HalfEdges(plate(4, [](int i, int) { return i != 2; })).polygons().size() == 2);
  CHECK(HalfEdges(plate(4, [](int i, int j) { return (i + j) % 2 == 0; })).polygons().size() == 8);
}

TEST_CASE("polygons keep to one material, one plane and one side, and leave out what has no area") {
  auto two = plate(6, [](int, int) { return true; });
  for (std::size_t t = 0; t < two.triangles.size() / 2; ++t) two.triangle_slot[t] = 1;
  CHECK(HalfEdges(two).polygons().size() == 2);
  const HalfEdges components(two.vertices, two.triangles, std::vector<clray::FaceLabel>(72, {0, 5}));
  CHECK(components.polygons().size() == 1);
  auto bent = plate(6, [](int, int) { return true; });
  for (Vec3& v : bent.vertices) v.z = v.x > 3 ? (v.x - 3) * 0x1p-60 : 0.0;
  CHECK(HalfEdges(bent).polygons().size() == 2);
  const auto folded = load_text("v 0 0 0\nv 2 0 0\nv 1 2 0\nv 1 1 0\nf 1 2 3\nf 2 1 4\n");
  CHECK(HalfEdges(*folded).polygons().size() == 2);
  const auto line = load_text("v 0 0 0\nv 1 1 1\nv 2 2 2\nv 1 1 5\nv 1 1 -5\nf 1 2 4\nf 1 3 2\nf 1 5 3\n");
  const std::vector<MeshPolygon> polygons = HalfEdges(*line).polygons();
  REQUIRE(polygons.size() == 2);
  CHECK(polygons[0].triangles == std::vector<std::uint32_t>{0});
  CHECK(polygons[1].triangles == std::vector<std::uint32_t>{2});
}

TEST_CASE("the project's meshes: prism 8 polygons, cylinder 258, box-wing 6 and two wings") {
  const auto load = [](const std::string& name) {
    return clray::load_mesh(std::string(CLRAY_SOURCE_DIR) + "/meshes/" + name);
  };
  const auto prism = load("hexprism.obj"), cylinder = load("cylinder.obj"), wings = load("box_wing.obj");
  CHECK(HalfEdges(*prism).polygons().size() == 8);
  CHECK(HalfEdges(*prism).parts()[0].convex);
  CHECK(HalfEdges(*cylinder).polygons().size() == 258);
  CHECK(HalfEdges(*cylinder).parts()[0].convex);
  const std::vector<MeshPart> parts = HalfEdges(*wings).parts();
  REQUIRE(parts.size() == 3);
  CHECK(std::count_if(parts.begin(), parts.end(), [](const MeshPart& p) { return p.closed; }) == 1);
}

TEST_CASE("a cone of 200,000 triangles round two vertices, closed and convex, takes seconds at most") {
  const auto start = std::chrono::steady_clock::now();
  const std::uint32_t n = 100000;
  clray::Mesh cone;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::acos(-1.0) * i / n;
    cone.vertices.emplace_back(std::cos(a), std::sin(a), 0.0);
  }
  cone.vertices.emplace_back(0, 0, 1);
  cone.vertices.emplace_back(0, 0, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    cone.triangles.push_back({i, (i + 1) % n, n});
    cone.triangles.push_back({(i + 1) % n, i, n + 1});
  }
  const HalfEdges view(cone);
  const std::vector<MeshPart> parts = view.parts();
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].closed);
  CHECK(view.polygons().size() == n + 1);
  // A second at most when optimised; walking round the vertices would take hours.
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() <
        30.0 * clray::test::kPatience);
}

TEST_CASE("a preview of a finely divided box is the box; of a sphere an inscribed closed body") {
  // Six faces of 8 × 8 cells.
  clray::Mesh box;
  box.material_slots = {"a", "b"};
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const clray::Mesh face = plate(8, [](int, int) { return true; });
      const auto first = static_cast<std::uint32_t>(box.vertices.size());
      for (const Vec3& v : face.vertices) {
        Vec3 p;
        p[(axis + 1) % 3] = side ? v.x / 8 : v.y / 8;
        p[(axis + 2) % 3] = side ? v.y / 8 : v.x / 8;
        p[axis] = side;
        box.vertices.push_back(p);
      }
      for (const auto& t : face.triangles) {
        box.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        box.triangle_slot.push_back(static_cast<std::uint32_t>(side));
      }
    }
  }
  CHECK(volume(box) == 1.0);
  const clray::Mesh coarse = HalfEdges(box).preview(12);
  CHECK(coarse.triangles.size() == 12);
  CHECK(volume(coarse) == 1.0);
  CHECK(HalfEdges(coarse).parts()[0].convex);
  CHECK(HalfEdges(coarse).polygons().size() == 6);
  CHECK(coarse.material_slots == box.material_slots);
  CHECK(std::count(coarse.triangle_slot.begin(), coarse.triangle_slot.end(), 1u) == 6);
  CHECK(HalfEdges(box).preview(1000).triangles.size() == 768);  // nothing to do

  const double pi = std::acos(-1.0);
  clray::Mesh globe;
  const std::uint32_t n = 64;
  for (std::uint32_t j = 0; j <= n / 2; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double theta = pi * j / (n / 2), phi = 2 * pi * i / n;
      globe.vertices.push_back(
          j == 0       ? Vec3(0, 0, 1)
          : j == n / 2 ? Vec3(0, 0, -1)
                       : Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  }
  for (std::uint32_t j = 0; j < n / 2; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * n + i, b = j * n + (i + 1) % n;
      if (j > 0) globe.triangles.push_back({a, a + n, b});
      if (j + 1 < n / 2) globe.triangles.push_back({b, a + n, b + n});
    }
  }
  const clray::Mesh round = HalfEdges(globe).preview(400);
  CHECK(round.triangles.size() <= 400);
  CHECK(round.triangles.size() >= 390);
  const std::vector<MeshPart> parts = HalfEdges(round).parts();
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].closed);
  for (const Vec3& v : round.vertices) CHECK(glm::length(v) == doctest::Approx(1.0).epsilon(1e-15));
  // 200 vertices on a sphere: one part in forty or so is cut off; half of that would be a broken surface.
  CHECK(volume(round) < 4 * pi / 3);
  CHECK(volume(round) > 0.9 * 4 * pi / 3);
}

TEST_CASE("the side of a plane is that of 128-bit integers, also for points in it and one unit off") {
  std::mt19937_64 random(7);
  const auto sign = [](__int128 x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  int zeros = 0;
  for (int round = 0; round < 20000; ++round) {
    std::int64_t p[4][3];
    for (auto& point : p)
      for (std::int64_t& x : point)
        x = static_cast<std::int64_t>(random() >> (25 + round % 30)) - (1ll << (38 - round % 30));
    const std::int64_t s = static_cast<std::int64_t>(random() % 5) - 2, t = static_cast<std::int64_t>(random() % 5) - 2;
    if (round % 2) {
      for (int k = 0; k < 3; ++k) p[3][k] = p[0][k] + s * (p[1][k] - p[0][k]) + t * (p[2][k] - p[0][k]);
      if (round % 4 == 3) p[3][round % 3] += 1;
    }
    __int128 d[3][3], det = 0;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) d[i][k] = p[i + 1][k] - p[0][k];
    for (int k = 0; k < 3; ++k)
      det += (d[0][(k + 1) % 3] * d[1][(k + 2) % 3] - d[0][(k + 2) % 3] * d[1][(k + 1) % 3]) * d[2][k];
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 600) - 300);
    Vec3 q[4];
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) q[i][k] = static_cast<double>(p[i][k]) * scale;
    REQUIRE(clray::side_of_plane(q[0], q[1], q[2], q[3]) == sign(det));
    zeros += det == 0;
    const int axis = round % 3, i = (axis + 1) % 3, j = (axis + 2) % 3;
    REQUIRE(clray::turn_sign(q[0], q[1], q[2], axis) == sign(d[0][i] * d[1][j] - d[0][j] * d[1][i]));
  }
  CHECK(zeros > 3000);
  // Differences that no double holds: 1 and 2^-60 on a diagonal.
  const double tiny = 0x1p-60;
  CHECK(clray::side_of_plane(Vec3(0, 0, 0), Vec3(1, 1, tiny), Vec3(1, 0, 0), Vec3(0, 1, tiny)) == 0);
  CHECK(clray::side_of_plane(Vec3(tiny, 0, 0), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 5, 0)) != 0);
  CHECK(clray::area_axis(Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.2, 0.2), Vec3(0.4, 0.4, 0.4)) == -1);
  CHECK(clray::area_axis(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, tiny)) >= 0);
}
