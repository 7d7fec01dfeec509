// SPDX-License-Identifier: Apache-2.0
// The exact pulse of triangle soups against two other methods in long double (tests/reference): walks along edges, and
// scanlines for small soups; and of solids and soups against points within their errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "reference/visible_edges.hpp"
#include "support/exact_checks.hpp"

using namespace clray_test;

namespace {

using AreasOf = std::vector<long double> (*)(const std::vector<clray_reference::SoupTriangle>&);

std::vector<clray_reference::SoupTriangle> reference_soup(const Triangles& triangles) {
  std::vector<clray_reference::SoupTriangle> soup;
  for (const auto& t : triangles) {
    clray_reference::SoupTriangle r;
    for (int k = 0; k < 3; ++k) r.corners[k] = {t[k].x, t[k].y, t[k].z};
    soup.push_back(r);
  }
  return soup;
}

/// A of a soup of Lambert faces from +z, by a reference.
long double reference_total(const Triangles& triangles, double rho, AreasOf areas_of) {
  const std::vector<clray_reference::SoupTriangle> soup = reference_soup(triangles);
  const std::vector<long double> areas = areas_of(soup);
  long double sum = 0.0L;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const auto& c = soup[k].corners;
    const long double ax = static_cast<long double>(c[1][0]) - c[0][0],
                      ay = static_cast<long double>(c[1][1]) - c[0][1],
                      az = static_cast<long double>(c[1][2]) - c[0][2];
    const long double bx = static_cast<long double>(c[2][0]) - c[0][0],
                      by = static_cast<long double>(c[2][1]) - c[0][1],
                      bz = static_cast<long double>(c[2][2]) - c[0][2];
    const long double nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
    sum += areas[k] * std::fabs(nz) / std::sqrt(nx * nx + ny * ny + nz * nz);
  }
  return sum * rho / std::acos(-1.0L);
}

struct Off {
  double relative, of_bound;
};

/// The triangles in a frame whose z is `s`, rounded once.
Triangles turned(const Triangles& triangles, const clray::Vec3& s) {
  // u is across s and z; v is across both.
  const long double r = std::hypot(static_cast<long double>(s.x), static_cast<long double>(s.y));
  const long double u[3] = {-s.y / r, s.x / r, 0.0L}, w[3] = {s.x, s.y, s.z};
  const long double v[3] = {-w[2] * u[1], w[2] * u[0], w[0] * u[1] - w[1] * u[0]};
  Triangles out = triangles;
  for (auto& t : out) {
    for (auto& corner : t) {
      const auto along = [&, c = corner](const long double* axis) {
        return static_cast<double>(axis[0] * c.x + axis[1] * c.y + axis[2] * c.z);
      };
      corner = {along(u), along(v), along(w)};
    }
  }
  return out;
}

Off off_from(const Triangles& triangles, AreasOf areas_of, const clray::Vec3& s = toward(0.0)) {
  const long double expected = reference_total(s.z == 1.0 ? triangles : turned(triangles, s), 0.5, areas_of);
  const clray::Estimate a = total(solve(lambert_scene(mesh_of(triangles), s)));
  const auto off = static_cast<double>(std::fabs(a.value - expected));
  return {off / static_cast<double>(expected), off / a.rounding_bound};
}

/// Stairs with a railing, as a body whose faces share edges and hide one another.
MeshPtr stairs() {
  Triangles faces;
  for (int k = 0; k < 12; ++k) {
    const double x = 0.25 * k, z = 0.125 * k;
    add_quad(&faces, {x, 0, z}, {x + 0.25, 0, z}, {x + 0.25, 1, z}, {x, 1, z});
    add_quad(&faces, {x, 0, z - 0.125}, {x, 0, z}, {x, 1, z}, {x, 1, z - 0.125});
    add_quad(&faces, {x, 0, z}, {x + 0.0625, 0, z}, {x + 0.0625, 0, z + 1}, {x, 0, z + 1});
  }
  return mesh_of(faces);
}

/// A mesh of the project, all of one material.
MeshPtr repository_mesh(const char* name) {
  auto mesh = std::make_shared<clray::Mesh>(
      *clray::load_scene(std::string(CLRAY_SOURCE_DIR "/meshes/") + name).components.at(0).mesh);
  mesh->material_slots = {""};
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  return mesh;
}

}  // namespace

TEST_CASE("two references agree on visible areas") {
  // Both are of long double: sums of some thousand terms, each right to 1e-19 of the body.
  for (const double size : {0.6, 1.5}) {
    const std::vector<clray_reference::SoupTriangle> all = reference_soup(soup(5, 40, size));
    const std::vector<long double> lines = clray_reference::visible_areas(all),
                                   edges = clray_reference::visible_areas_by_edges(all);
    for (std::size_t k = 0; k < all.size(); ++k) CHECK(std::fabs(static_cast<double>(lines[k] - edges[k])) < 1e-15);
  }
}

TEST_CASE("soups of 200 against walks along edges in long double, and the claimed bound of rounding") {
  const std::uint64_t soups = long_tests() ? 200 : 40;
  for (std::uint64_t seed = 1; seed <= soups; ++seed) {
    CAPTURE(seed);
    const double sizes[] = {0.3, 0.6, 1.0, 1.5};
    const Off off = off_from(soup(seed, 200, sizes[seed % 4]), clray_reference::visible_areas_by_edges);
    CHECK(off.relative <= 1e-11);
    CHECK(off.of_bound <= 1.0);
  }
}

TEST_CASE("many small soups, sparse and dense, against scanlines: the claimed bound of rounding holds") {
  const std::uint64_t soups = long_tests() ? 1000 : 100;
  double closest = 0.0;
  for (std::uint64_t seed = 1; seed <= soups; ++seed) {
    const Triangles triangles = soup(100 + seed, 12, seed % 2 == 0 ? 0.5 : 2.0);
    closest = std::max(closest, off_from(triangles, clray_reference::visible_areas).of_bound);
  }
  CHECK(closest > 0.0);
  CHECK(closest <= 1.0);
}

TEST_CASE("soups on a lattice, where corners, edges and planes meet, against scanlines") {
  // Coordinates are halves or quarters, so all but crossings is free of rounding. Of faces in one plane either may be
  // the one that is seen: A is the same.
  const std::uint64_t soups = long_tests() ? 2000 : 100;
  for (std::uint64_t seed = 1; seed <= soups; ++seed) {
    CAPTURE(seed);
    const double steps = seed % 2 == 0 ? 2.0 : 4.0;
    Triangles triangles;
    for (auto t : soup(1000 + seed, 60, 0.5)) {
      for (auto& corner : t) {
        for (int k = 0; k < 3; ++k) corner[k] = std::round(corner[k] * steps) / steps;
      }
      const double across = (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
      if (across != 0.0) triangles.push_back(t);
    }
    const Off off = off_from(triangles, clray_reference::visible_areas);
    CHECK(off.relative <= 1e-11);
    CHECK(off.of_bound <= 1.0);
    // From aslant rounding tears apart what meets. The reference's corners are rounded, too.
    CHECK(off_from(triangles, clray_reference::visible_areas, toward(0.6, 0.1 * static_cast<double>(seed))).relative <=
          1e-11);
  }
}

TEST_CASE("faces given twice, turned and shuffled change no bit of an exact pulse") {
  auto triangles = soup(7, 60, 0.8);
  const clray::Result once = solve(lambert_scene(mesh_of(triangles), toward(0.4, 0.3)));
  for (std::size_t k = 0; k < 42; ++k) triangles.push_back({triangles[k][1], triangles[k][2], triangles[k][0]});
  std::reverse(triangles.begin(), triangles.end());
  const clray::Result twice = solve(lambert_scene(mesh_of(triangles), toward(0.4, 0.3)));
  CHECK(twice.digest == once.digest);
}

TEST_CASE("points agree with the exact pulse within their errors") {
  std::vector<MeshPtr> bodies = {
      merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})}),
      bowl_mesh(24, 12, 1.0, 0.3, 2.0),
      mesh_of(soup(11, 100, 0.7)),
      stairs(),
  };
  if (long_tests()) {
    for (const char* name : {"box_wing.obj", "cylinder.obj", "hexprism.obj"}) bodies.push_back(repository_mesh(name));
    bodies.push_back(mesh_of(soup(12, 1000, 0.3)));
    bodies.push_back(mesh_of(soup(13, 30, 2.0)));
    bodies.push_back(merged({cone_mesh(40, 1.0, 2.0), moved(prism_mesh(6, 0.5, 3.0), {0.25, 0.5, 1.0})}));
  }
  double sum = 0.0;
  int count = 0;
  for (const MeshPtr& mesh : bodies) {
    for (const clray::Vec3& s : {toward(0.7, 0.4), toward(1.9, 2.0)}) {
      CAPTURE(count);
      clray::Scene scene = lambert_scene(mesh, s);
      const clray::Result exact = solve(scene);
      rays(scene, 18);
      const clray::Result points = run(scene);
      const double t = (total(points).value - total(exact).value) / total(points).standard_error;
      sum += t * t;
      ++count;
      CHECK(points.delay.at(0).bin_width_s == exact.delay.at(0).bin_width_s);
    }
  }
  // Of 16 replicates t has 15 degrees of freedom: t² has the mean 15/13 and the variance 3·15²/(13·11) - (15/13)², so
  // the sum of n lies beyond four standard deviations in less than one of 100 cases, however skewed it is.
  const double mean = 15.0 / 13.0, deviation = std::sqrt(3.0 * 225.0 / 143.0 - mean * mean);
  CAPTURE(sum);
  CHECK(sum <= count * mean + 4.0 * deviation * std::sqrt(static_cast<double>(count)));
  CHECK(sum > 0.0);
}
