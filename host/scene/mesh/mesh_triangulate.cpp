// SPDX-License-Identifier: Apache-2.0
// Polygon triangulation: a fan for convex polygons, else ear clipping (Meisters 1975) in the coordinate plane that
// Newell's normal favours. The projection onto it is affine on the polygon's plane, so an ear stays an ear. It drops a
// coordinate instead of rotating, so the points stay exact. Orientations come from Kahan's difference of products.
#include "scene/mesh/mesh_triangulate.hpp"

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "shared/portable.h"

namespace clray {

namespace {

struct Point {
  double x, y;
};

bool same(const Point& a, const Point& b) {
  return a.x == b.x && a.y == b.y;
}

// Twice the signed area of a, b, c.
double turn(const Point& a, const Point& b, const Point& c) {
  return difference_of_products(b.x - a.x, c.y - a.y, b.y - a.y, c.x - a.x);
}

Vec3 newell_normal(const std::vector<Vec3>& p) {
  Vec3 normal(0.0);
  // Relative to the first corner, so that a far-off polygon loses no digits.
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vec3 a = p[i] - p[0], b = p[i + 1] - p[0];
    normal.x += difference_of_products(a.y, b.z, a.z, b.y);
    normal.y += difference_of_products(a.z, b.x, a.x, b.z);
    normal.z += difference_of_products(a.x, b.y, a.y, b.x);
  }
  return normal;
}

// Makes the polygon counter-clockwise as seen along the kept axes. Returns false if it spans no plane.
bool project(const std::vector<Vec3>& corners, std::vector<Point>& points) {
  const Vec3 n = newell_normal(corners);
  const Vec3 size(std::fabs(n.x), std::fabs(n.y), std::fabs(n.z));
  int drop = size.y > size.x ? 1 : 0;
  if (size.z > size[drop]) drop = 2;
  if (!(size[drop] > 0.0)) return false;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  points.reserve(corners.size());
  for (const Vec3& c : corners) points.push_back(n[drop] > 0.0 ? Point{c[u], c[v]} : Point{c[v], c[u]});
  return true;
}

// Whether the polygon is strictly convex and goes round once: every turn is to the left, and the edges' x changes its
// sign twice.
bool is_convex(const std::vector<Point>& p) {
  const std::size_t n = p.size();
  int changes = 0, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    if (!(turn(a, b, c) > 0.0)) return false;
    const int sign = b.x > a.x ? 1 : (b.x < a.x ? -1 : 0);
    if (sign == 0) continue;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  return changes <= 2;
}

class EarClipper {
 public:
  explicit EarClipper(const std::vector<Point>& points) : p_(points), left_(points.size()) {
    const auto n = static_cast<std::uint32_t>(points.size());
    next_.resize(n);
    previous_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  void clip(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::uint32_t at = 0;
    while (left_ > 3) {
      at = find_ear(at);
      triangles.push_back({previous_[at], at, next_[at]});
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      --left_;
      // Two corners on, since ears clipped side by side would make a fan of slivers.
      at = next_[next_[at]];
    }
    triangles.push_back({previous_[at], at, next_[at]});
  }

 private:
  std::uint32_t find_ear(std::uint32_t start) const {
    // First round: a corner on the diagonal that would close the ear blocks it, so that no triangle without area is
    // left. Second: a corner may touch the diagonal, as a hole bridged by a double edge does. Third: corners without an
    // angle are clipped.
    for (int leniency = 0; leniency < 3; ++leniency) {
      std::uint32_t i = start;
      for (std::size_t k = 0; k < left_; ++k, i = next_[i]) {
        if (is_ear(i, leniency)) return i;
      }
    }
    return start;
  }

  bool is_ear(std::uint32_t i, int leniency) const {
    const Point &a = p_[previous_[i]], &b = p_[i], &c = p_[next_[i]];
    const double area = turn(a, b, c);
    if (leniency == 2) return area == 0.0;
    if (!(area > 0.0)) return false;
    for (std::uint32_t j = next_[next_[i]]; j != previous_[i]; j = next_[j]) {
      const Point& q = p_[j];
      // A corner at the same place as one of the ear's blocks it only if its edges enter the ear.
      if (same(q, a) || same(q, b) || same(q, c)) {
        if (enters(j, a, b, c)) return false;
        continue;
      }
      const double ab = turn(a, b, q), bc = turn(b, c, q), ca = turn(c, a, q);
      if (leniency == 0 ? ab >= 0.0 && bc >= 0.0 && ca >= 0.0 : ab > 0.0 && bc > 0.0 && ca > 0.0) return false;
    }
    return true;
  }

  // Whether the outline goes from corner j, which lies on a, b or c, into the triangle.
  bool enters(std::uint32_t j, const Point& a, const Point& b, const Point& c) const {
    const Point& q = p_[j];
    const Point corner[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
      if (!same(q, corner[k])) continue;
      for (const std::uint32_t neighbour : {previous_[j], next_[j]}) {
        const Point& r = p_[neighbour];
        if (turn(q, corner[(k + 1) % 3], r) > 0.0 && turn(q, corner[(k + 2) % 3], r) < 0.0) return true;
      }
      return false;
    }
    return false;
  }

  const std::vector<Point>& p_;
  std::size_t left_;
  std::vector<std::uint32_t> next_, previous_;
};

}  // namespace

Triangulation triangulate(const std::vector<Vec3>& corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  const std::size_t before = triangles.size();
  const auto fan = [&] {
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
  };
  if (n == 3) {
    fan();
    return Triangulation::exact;
  }
  std::vector<Point> points;
  if (!project(corners, points)) {
    fan();
    return Triangulation::crossing;
  }
  if (is_convex(points)) {
    fan();
    return Triangulation::exact;
  }
  if (n > kMaxConcaveCorners) {
    throw Error(ErrorCode::input, "a concave face of " + std::to_string(n) + " corners; at most " +
                                      std::to_string(kMaxConcaveCorners) + " were expected");
  }
  EarClipper(points).clip(triangles);
  // A simple outline is covered once, so no triangle is turned over.
  for (std::size_t i = before; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    if (turn(points[t[0]], points[t[1]], points[t[2]]) >= 0.0) continue;
    triangles.resize(before);
    fan();
    return Triangulation::crossing;
  }
  return Triangulation::exact;
}

}  // namespace clray
