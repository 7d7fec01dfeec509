// SPDX-License-Identifier: Apache-2.0
// Convexity of a triangle mesh by its edges. Coordinates in m; vertices are the same where their bits are.
#include "pipeline/convexity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "shared/portable.h"

namespace clray {
namespace {

constexpr std::size_t kMostTriangles = 2000000;
// Rounding of the orientation determinant, relative to the product of the edge lengths (Shewchuk 1997: (7 + 56ε)ε for
// exact differences; doubled for the rounding of vertices that were computed to lie in one plane).
constexpr double kFlat = 1e-14;

using Point = std::array<double, 3>;

vec3 sub(const Point& a, const Point& b) {
  return v3(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

struct Edge {
  std::uint32_t low, high;  // vertex numbers
  std::uint32_t triangle;
  std::uint32_t opposite;  // the triangle's third vertex
  bool forward;            // low -> high in the triangle's winding
  bool operator<(const Edge& o) const { return low != o.low ? low < o.low : high < o.high; }
};

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

bool convex_triangles(const std::vector<double>& triangles) {
  const std::size_t count = triangles.size() / 9;
  if (count == 0 || count > kMostTriangles) return false;
  std::vector<Point> points(3 * count);
  for (std::size_t k = 0; k < 3 * count; ++k)
    points[k] = {{triangles[3 * k], triangles[3 * k + 1], triangles[3 * k + 2]}};
  const auto normal = [&](std::size_t t) {
    return v3_cross(sub(points[3 * t + 1], points[3 * t]), sub(points[3 * t + 2], points[3 * t]));
  };
  // Positive: x lies beyond the plane of triangle t, on its outer side.
  const auto beyond = [&](std::size_t t, const Point& x) {
    const vec3 n = normal(t), d = sub(x, points[3 * t]);
    const double size = v3_length(n) * v3_length(d);
    const double height = v3_dot(n, d);
    return std::fabs(height) <= kFlat * size ? 0.0 : height;
  };
  if (std::all_of(points.begin(), points.end(), [&](const Point& x) { return beyond(0, x) == 0.0; })) return true;

  std::vector<Point> distinct = points;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const auto number = [&](const Point& x) {
    return static_cast<std::uint32_t>(std::lower_bound(distinct.begin(), distinct.end(), x) - distinct.begin());
  };
  std::vector<Edge> edges;
  edges.reserve(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t v[3] = {number(points[3 * t]), number(points[3 * t + 1]), number(points[3 * t + 2])};
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), v[(k + 2) % 3], a < b});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> parent(count);
  std::iota(parent.begin(), parent.end(), 0u);
  for (std::size_t e = 0; e < edges.size(); e += 2) {
    if (e + 1 >= edges.size()) return false;
    const Edge &a = edges[e], &b = edges[e + 1];
    const bool pair = a.low == b.low && a.high == b.high && a.forward != b.forward;
    const bool third = e + 2 < edges.size() && edges[e + 2].low == a.low && edges[e + 2].high == a.high;
    if (!pair || third) return false;
    if (beyond(a.triangle, distinct[b.opposite]) > 0.0 || beyond(b.triangle, distinct[a.opposite]) > 0.0) return false;
    // Folded flat onto itself: the far vertex is level but on the same side of the edge.
    if (v3_dot(normal(a.triangle), normal(b.triangle)) <= 0.0 && beyond(a.triangle, distinct[b.opposite]) == 0.0)
      return false;
    parent[find_root(parent, a.triangle)] = find_root(parent, b.triangle);
  }
  for (std::uint32_t t = 0; t < count; ++t) {
    if (find_root(parent, t) != find_root(parent, 0)) return false;
  }
  const auto euler = static_cast<std::int64_t>(distinct.size()) - static_cast<std::int64_t>(edges.size() / 2) +
                     static_cast<std::int64_t>(count);
  return euler == 2;
}

}  // namespace clray
