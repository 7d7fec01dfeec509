// SPDX-License-Identifier: Apache-2.0
// Triangulation against the shoelace formula, the three generated bodies against their closed forms, and large
// and nasty meshes in bounded time.
#include <chrono>
#include <cmath>

#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace {

struct P {
  double x, y;
};

double shoelace(const std::vector<P>& p) {
  double twice = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const P &a = p[i], &b = p[(i + 1) % p.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::fabs(twice) / 2;
}

// One face in the plane spanned by two orthogonal unit vectors, so that its area is the plane one.
std::string face_text(const std::vector<P>& outline, const clray::Vec3& u, const clray::Vec3& v,
                      const clray::Vec3& at) {
  std::string text, face = "f";
  char line[160];
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const clray::Vec3 p = at + outline[i].x * u + outline[i].y * v;
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
    text += line;
    face += " " + std::to_string(i + 1);
  }
  return text + face + "\n";
}

// All triangles turn the same way and sum to the outline: with the sum equal, that is a cover without overlap.
void check_outline(std::vector<P> outline, std::size_t degenerate = 0) {
  const double area = shoelace(outline);
  const double r = std::sqrt(0.5);
  const clray::Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), tilted(0.6, 0, 0.8), across(-0.8 * r, r, 0.6 * r);
  for (int turned = 0; turned < 2; ++turned) {
    for (const auto& [u, v] :
         {std::pair{x, y}, std::pair{y, x}, std::pair{y, z}, std::pair{z, x}, std::pair{tilted, across}}) {
      const bool exact = u != tilted;
      const auto mesh = load_text(face_text(outline, u, v, exact ? clray::Vec3(0) : clray::Vec3(10, -20, 30)));
      CHECK(mesh->warnings.empty());
      CHECK(mesh->triangles.size() == outline.size() - 2);
      // In tilted planes coordinates near 30 are rounded to 2^-49 and lengths are near 1.
      CHECK(mesh->report.area_m2 == doctest::Approx(area).epsilon(exact ? 1e-14 : 1e-12));
      CHECK(mesh->report.boundary_edges == outline.size());
      if (exact) CHECK(mesh->report.degenerate == degenerate);
      double turned_sum = 0.0;
      for (const auto& t : mesh->triangles) {
        const auto &a = mesh->vertices[t[0]], &b = mesh->vertices[t[1]], &c = mesh->vertices[t[2]];
        turned_sum += 0.5 * glm::dot(glm::cross(b - a, c - a), glm::cross(u, v));
      }
      CHECK(std::fabs(turned_sum) == doctest::Approx(area).epsilon(exact ? 1e-14 : 1e-12));
    }
    std::reverse(outline.begin(), outline.end());
    std::rotate(outline.begin(), outline.begin() + outline.size() / 3, outline.end());
  }
}

std::shared_ptr<const clray::Mesh> generated(const std::string& name) {
  return clray::load_mesh(std::string(CLRAY_SOURCE_DIR) + "/meshes/" + name);
}

// Grid of n × n quads on the unit square, as triangles.
std::string grid_text(int n) {
  std::string text;
  char line[96];
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      std::snprintf(line, sizeof line, "v %.9f %.9f 0\n", i / double(n), j / double(n));
      text += line;
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 1; i <= n; ++i) {
      const int a = j * (n + 1) + i;
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
      text += line;
    }
  }
  return text;
}

}  // namespace

TEST_CASE("concave polygons keep the area of their outline in every plane and winding") {
  check_outline({{0, 0}, {4, 0}, {4, 4}, {2, 1}});                                  // dart, concave quad
  check_outline({{2, 1}, {0, 0}, {4, 0}, {4, 4}});                                  // the same from its notch
  check_outline({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});                  // L
  check_outline({{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}});  // U
  check_outline(
      {{0, 0}, {7, 0}, {7, 5}, {1, 5}, {1, 2}, {5, 2}, {5, 3}, {2, 3}, {2, 4}, {6, 4}, {6, 1}, {0, 1}});  // spiral
  check_outline({{0, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 4}, {0, 4}});  // straight corners
  check_outline({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {0, 4}});          // more on one edge
  std::vector<P> comb;                                              // 40 teeth
  for (int i = 0; i < 40; ++i) comb.insert(comb.end(), {{double(i), 0.0}, {i + 0.5, 10.0}});
  comb.insert(comb.end(), {{40.0, 0.0}, {40.0, -1.0}, {0.0, -1.0}});
  check_outline(comb);
  std::vector<P> star;
  for (int i = 0; i < 50; ++i) {
    const double angle = i * std::acos(-1.0) / 25, radius = i % 2 ? 1.0 : 0.3;
    star.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  check_outline(star);
}

TEST_CASE("a square with a square hole, bridged by a double edge, keeps its area") {
  const auto mesh =
      load_text("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\nf 1 2 3 4 1 5 6 7 8 5\n");
  CHECK(mesh->triangles.size() == 8);
  CHECK(mesh->report.area_m2 == 12.0);
  CHECK(mesh->report.degenerate == 0);
  CHECK(mesh->report.boundary_edges == 8);  // the bridge is used both ways by the one face
  CHECK(mesh->warnings.empty());
}

TEST_CASE("repeated corners give a triangle without area; a crossing outline gives a warning") {
  const auto repeated = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 2 3 4\n");
  CHECK(repeated->report.area_m2 == 1.0);
  CHECK(repeated->triangles.size() == 3);
  CHECK(repeated->report.degenerate == 1);
  CHECK(repeated->report.boundary_edges == 4);
  const auto bow = load_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\n");
  CHECK(bow->triangles.size() == 2);
  REQUIRE(bow->warnings.size() == 1);
  CHECK(bow->warnings[0].find("1 polygon crosses itself or has no plane (first: face 1)") != std::string::npos);
}

TEST_CASE("the hexagonal prism has its closed-form area and volume and is closed") {
  const auto mesh = generated("hexprism.obj");
  const double root = std::sqrt(3.0);
  CHECK(mesh->report.area_m2 == doctest::Approx(6 + 3 * root).epsilon(1e-15));
  CHECK(volume(*mesh) == doctest::Approx(1.5 * root).epsilon(1e-15));
  CHECK(mesh->report.faces == 8);
  CHECK(mesh->report.triangles == 20);
  CHECK(mesh->report.boundary_edges == 0);
  CHECK(mesh->report.non_manifold_edges == 0);
  CHECK(mesh->report.degenerate == 0);
  CHECK(mesh->warnings.empty());
  REQUIRE(mesh->file_materials.size() == 1);
  CHECK(mesh->file_materials[0].parameters.at("d") == doctest::Approx(0.8).epsilon(1e-15));
  for (const auto& v : mesh->vertices) {
    CHECK(std::fabs(v.y) == 0.5);
    CHECK(std::hypot(v.x, v.z) == doctest::Approx(1.0).epsilon(1e-15));
  }
}

TEST_CASE("the cylinder is the prism inscribed in it, to its closed forms") {
  const auto mesh = generated("cylinder.obj");
  const double pi = std::acos(-1.0);
  const double side = 256 * 3 * 2 * std::sin(pi / 256), cap = 128 * std::sin(2 * pi / 256);
  CHECK(mesh->report.area_m2 == doctest::Approx(side + 2 * cap).epsilon(1e-14));
  CHECK(volume(*mesh) == doctest::Approx(3 * cap).epsilon(1e-14));
  CHECK(mesh->report.triangles == 1020);
  CHECK(mesh->report.boundary_edges == 0);
  CHECK(mesh->report.non_manifold_edges == 0);
  CHECK(mesh->report.degenerate == 0);
  CHECK(mesh->warnings.empty());
}

TEST_CASE("the box-wing satellite has its stated areas per material, and wings apart from the box in depth") {
  const auto mesh = generated("box_wing.obj");
  CHECK(mesh->report.area_m2 == doctest::Approx(31.2).epsilon(1e-15));
  CHECK(mesh->report.boundary_edges == 8);
  CHECK(mesh->report.non_manifold_edges == 0);
  CHECK(mesh->warnings.empty());
  CHECK(mesh->material_slots == std::vector<std::string>{"box", "wing"});
  double area[2] = {0, 0}, facing[2] = {0, 0}, near_wing = 1e9, far_wing = -1e9;
  for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
    const auto& t = mesh->triangles[i];
    const auto &a = mesh->vertices[t[0]], &b = mesh->vertices[t[1]], &c = mesh->vertices[t[2]];
    const clray::Vec3 n = 0.5 * glm::cross(b - a, c - a);
    const auto slot = mesh->triangle_slot[i];
    area[slot] += glm::length(n);
    facing[slot] += std::max(n.z, 0.0);
    if (slot == 1) {
      for (const auto& v : {a, b, c}) {
        if (v.x > 0) near_wing = std::min(near_wing, v.z);
        if (v.x < 0) far_wing = std::max(far_wing, v.z);
      }
    }
  }
  CHECK(area[0] == doctest::Approx(24.0).epsilon(1e-15));
  CHECK(area[1] == doctest::Approx(7.2).epsilon(1e-15));
  CHECK(facing[0] == doctest::Approx(4.0).epsilon(1e-15));
  CHECK(facing[1] == doctest::Approx(7.2 * std::sqrt(3.0) / 2).epsilon(1e-15));
  CHECK(near_wing == doctest::Approx(1.2).epsilon(1e-15));
  CHECK(far_wing == doctest::Approx(-1.2).epsilon(1e-15));
  REQUIRE(mesh->file_materials.size() == 2);
  for (const clray::Material& m : mesh->file_materials) {
    CHECK(m.model == "ashikhmin-shirley");
    CHECK(m.parameters.at("rho") == doctest::Approx(0.5).epsilon(1e-15));
    CHECK(m.parameters.at("d") == doctest::Approx(0.2).epsilon(1e-15));
    CHECK(m.parameters.at("n") == 50.0);
  }
}

TEST_CASE("a grid of 320,000 triangles and fans of 100,000 faces on one edge or vertex take seconds at most") {
  const auto start = std::chrono::steady_clock::now();
  const auto grid = load_text(grid_text(400));
  CHECK(grid->triangles.size() == 320000);
  CHECK(grid->report.area_m2 == doctest::Approx(1.0).epsilon(1e-9));  // nine decimals in the file
  CHECK(grid->report.boundary_edges == 1600);
  CHECK(grid->report.non_manifold_edges == 0);
  std::string edge = "v 0 0 0\nv 0 0 1\n", vertex = "v 0 0 0\n";
  for (int i = 0; i < 100000; ++i) {
    edge += "v 1 " + std::to_string(i) + " 0\n";
    vertex += "v 1 " + std::to_string(i) + " 0\n";
  }
  for (int i = 0; i < 100000; ++i) edge += "f 1 2 " + std::to_string(i + 3) + "\n";
  for (int i = 0; i + 1 < 100000; ++i) vertex += "f 1 " + std::to_string(i + 2) + " " + std::to_string(i + 3) + "\n";
  const auto book = load_text(edge);
  CHECK(book->report.non_manifold_edges == 1);
  CHECK(book->triangles.size() == 100000);
  const auto fan = load_text(vertex);
  CHECK(fan->report.boundary_edges == 100001);
  CHECK(fan->report.area_m2 == doctest::Approx(0.5 * 99999).epsilon(1e-12));
  // About a second when optimised; a square-law step would take many minutes.
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 60.0);
}
