// SPDX-License-Identifier: Apache-2.0
// Which bodies count as unable to hide themselves: a wrong yes drops shadows from a result, a wrong no costs time.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "body/mesh_convexity.hpp"
#include "clray/scene.hpp"

using namespace clray;

namespace {

using Soup = std::vector<double>;  // nine numbers a triangle

void face(Soup& soup, std::vector<Vec3> corners) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    for (const Vec3& v : {corners[0], corners[k], corners[k + 1]}) soup.insert(soup.end(), {v.x, v.y, v.z});
}

/// The walls, bottom and top of a polygon (counter-clockwise from above) raised from z = low to high.
Soup raised(const std::vector<std::array<double, 2>>& outline, double low, double high, bool bottom = true) {
  Soup soup;
  const std::size_t n = outline.size();
  const auto at = [&](std::size_t k, double z) { return Vec3(outline[k % n][0], outline[k % n][1], z); };
  for (std::size_t k = 0; k < n; ++k) face(soup, {at(k, low), at(k + 1, low), at(k + 1, high), at(k, high)});
  std::vector<Vec3> up, down;
  for (std::size_t k = 0; k < n; ++k) {
    up.push_back(at(k, high));
    down.push_back(at(n - k, low));
  }
  face(soup, up);
  if (bottom) face(soup, down);
  return soup;
}

Soup cube(double x0 = 0.0, double size = 1.0) {
  return raised({{x0, 0}, {x0 + size, 0}, {x0 + size, size}, {x0, size}}, 0, size);
}

std::vector<std::array<double, 2>> polygon(int sides, double radius) {
  std::vector<std::array<double, 2>> outline;
  for (int k = 0; k < sides; ++k)
    outline.push_back({radius * std::cos(2 * M_PI * k / sides), radius * std::sin(2 * M_PI * k / sides)});
  return outline;
}

Soup turned(Soup soup, double angle, Vec3 by = Vec3(0.0)) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (std::size_t k = 0; k < soup.size(); k += 3) {
    const double x = soup[k], y = c * soup[k + 1] - s * soup[k + 2], z = s * soup[k + 1] + c * soup[k + 2];
    soup[k] = c * x - s * y + by.x;
    soup[k + 1] = s * x + c * y + by.y;
    soup[k + 2] = z + by.z;
  }
  return soup;
}

Soup plus(Soup a, const Soup& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Soup flipped(Soup soup, std::size_t first = 0, std::size_t count = ~std::size_t{0}) {
  for (std::size_t t = first; t < std::min(first + count, soup.size() / 9); ++t)
    for (int k = 0; k < 3; ++k) std::swap(soup[9 * t + 3 + k], soup[9 * t + 6 + k]);
  return soup;
}

/// A sphere of rings of quads; quads of a ring lie in one plane but for rounding.
Soup globe(int slices, int stacks) {
  Soup soup;
  const auto at = [&](int i, int j) {
    if (j == 0) return Vec3(0, 0, 1);
    if (j == stacks) return Vec3(0, 0, -1);
    const double theta = M_PI * j / stacks, phi = 2 * M_PI * (i % slices) / slices;
    return Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  for (int j = 0; j < stacks; ++j)
    for (int i = 0; i < slices; ++i) {
      if (j == 0) {
        face(soup, {at(i, 0), at(i, 1), at(i + 1, 1)});
      } else if (j == stacks - 1) {
        face(soup, {at(i, j), at(i, stacks), at(i + 1, j)});
      } else {
        face(soup, {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
      }
    }
  return soup;
}

Soup torus(int n, int m) {
  Soup soup;
  const auto at = [&](int i, int j) {
    const double a = 2 * M_PI * (i % n) / n, b = 2 * M_PI * (j % m) / m, r = 2 + std::cos(b);
    return Vec3(r * std::cos(a), r * std::sin(a), std::sin(b));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) face(soup, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  return soup;
}

}  // namespace

TEST_CASE("convex bodies are seen to be convex, wherever they are and however turned") {
  CHECK(convex_triangles(cube()));
  for (int sides : {3, 4, 6, 7, 50, 999}) {
    CAPTURE(sides);
    CHECK(convex_triangles(raised(polygon(sides, 1.0), -0.5, 0.5)));
  }
  for (const Soup& body : {cube(), raised(polygon(6, 1.0), 0, 1)})
    for (double angle : {0.3, 1.0, 2.2}) {
      CAPTURE(angle);
      CHECK(convex_triangles(turned(body, angle)));
      CHECK(convex_triangles(turned(body, angle, {0.3, -0.2, 0.7})));
    }
  Soup tetrahedron;
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0, 0, 1);
  face(tetrahedron, {a, c, b});
  face(tetrahedron, {a, b, d});
  face(tetrahedron, {b, c, d});
  face(tetrahedron, {c, a, d});
  CHECK(convex_triangles(tetrahedron));
  CHECK(convex_triangles(globe(8, 5)));
}

TEST_CASE("what lies in one plane cannot hide itself, open or overlapping") {
  Soup plate;
  face(plate, {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}});
  CHECK(convex_triangles(plate));
  CHECK(convex_triangles(plus(plate, flipped(plate))));
  Soup far = plate;
  for (std::size_t k = 0; k < far.size(); k += 3) far[k] += 5.0;
  CHECK(convex_triangles(plus(plate, far)));
  CHECK(!convex_triangles(plus(plate, turned(plate, 0.1))));
  for (std::size_t k = 2; k < far.size(); k += 3) far[k] += 1e-9;  // parallel, a nanometre above
  CHECK(!convex_triangles(plus(plate, far)));
}

TEST_CASE("bodies that can hide a part of themselves are never called convex") {
  CHECK(!convex_triangles({}));
  CHECK(!convex_triangles(flipped(cube())));          // inside out: its walls see each other
  CHECK(!convex_triangles(flipped(cube(), 3, 1)));    // one triangle against the rest
  CHECK(!convex_triangles(plus(cube(), cube(3.0))));  // two, apart
  CHECK(!convex_triangles(plus(cube(), cube(1.0))));  // two, sharing an edge of four faces
  CHECK(!convex_triangles(plus(cube(), cube(0.25, 0.5))));
  CHECK(!convex_triangles(plus(cube(), cube())));                                            // twice the same
  CHECK(!convex_triangles(raised({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1)));  // an L
  CHECK(!convex_triangles(raised(polygon(4, 1.0), 0, 1, false)));                            // a box without a bottom
  CHECK(!convex_triangles(torus(24, 12)));
  Soup fin = cube();  // three faces on one edge
  face(fin, {{0, 0, 0}, {1, 0, 0}, {0.5, -1, -1}});
  CHECK(!convex_triangles(fin));
}

TEST_CASE("a dent of 1e-9 in a cube's face is seen, a bump is convex") {
  for (const double height : {1e-9, 1e-3, -1e-9, -1e-3}) {
    Soup body = cube();
    body.erase(body.begin() + 8 * 9, body.begin() + 10 * 9);  // the top
    const Vec3 tip(0.5, 0.5, 1.0 + height), p[4] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (int k = 0; k < 4; ++k) face(body, {p[k], p[(k + 1) % 4], tip});
    CAPTURE(height);
    CHECK(convex_triangles(body) == (height > 0));
  }
}

TEST_CASE("the order of the triangles and their first corners do not matter") {
  std::mt19937 random(4);
  for (const Soup& body : {globe(12, 7), torus(9, 5)}) {
    const bool expected = convex_triangles(body);
    std::vector<std::size_t> order(body.size() / 9);
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    for (int round = 0; round < 5; ++round) {
      std::shuffle(order.begin(), order.end(), random);
      Soup other;
      for (const std::size_t t : order) {
        const std::size_t turn = random() % 3;
        for (std::size_t k = 0; k < 9; ++k) other.push_back(body[9 * t + (k + 3 * turn) % 9]);
      }
      CHECK(convex_triangles(other) == expected);
    }
  }
}
