// SPDX-License-Identifier: Apache-2.0
// Polygon triangulation: a fan for convex polygons, else ear clipping (Meisters 1975) in the coordinate plane that
// Newell's normal favours. The projection onto it is affine on the polygon's plane, so an ear stays an ear. It drops a
// coordinate instead of rotating, so the points stay exact. Orientations come from Kahan's difference of products.
#include "scene/mesh/mesh_triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "clray/error.hpp"
#include "scene/mesh/corner_tree.hpp"
#include "shared/portable.h"

namespace clray {

namespace {

bool same(const PlanePoint& a, const PlanePoint& b) {
  return a.x == b.x && a.y == b.y;
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
bool project(const std::vector<Vec3>& corners, std::vector<PlanePoint>& points) {
  const Vec3 n = newell_normal(corners);
  const Vec3 size(std::fabs(n.x), std::fabs(n.y), std::fabs(n.z));
  int drop = size.y > size.x ? 1 : 0;
  if (size.z > size[drop]) drop = 2;
  if (!(size[drop] > 0.0)) return false;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  points.reserve(corners.size());
  for (const Vec3& c : corners) points.push_back(n[drop] > 0.0 ? PlanePoint{c[u], c[v]} : PlanePoint{c[v], c[u]});
  return true;
}

// Whether the polygon is strictly convex and goes round once: every turn is to the left, and the edges' x changes its
// sign twice.
bool is_convex(const std::vector<PlanePoint>& p) {
  const std::size_t n = p.size();
  int changes = 0, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const PlanePoint &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    if (!(plane_turn(a, b, c) > 0.0)) return false;
    const int sign = b.x > a.x ? 1 : (b.x < a.x ? -1 : 0);
    if (sign == 0) continue;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  return changes <= 2;
}

// Cuts ears off. Whether a corner is an ear is remembered until something near it changes: a corner that is none waits
// for the corner that blocks it, and for its own neighbours.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<PlanePoint>& points)
      : p_(points), left_(points.size()), tree_(points), waiting_(points.size()) {
    const auto n = static_cast<std::uint32_t>(points.size());
    next_.resize(n);
    previous_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
      for (auto& open : open_) open.insert(open.end(), i);
    }
  }

  void clip(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::uint32_t at = 0;
    while (left_ > 3) {
      at = find_ear(at);
      triangles.push_back({previous_[at], at, next_[at]});
      cut(at);
      // Two corners on, since ears clipped side by side would make a fan of slivers.
      at = next_[next_[at]];
    }
    triangles.push_back({previous_[at], at, next_[at]});
  }

 private:
  // First round: a corner on the diagonal that would close the ear blocks it, so that no triangle without area is
  // left. Second: a corner may touch the diagonal, as a hole bridged by a double edge does. Third: corners without an
  // angle are clipped.
  static constexpr int kRounds = 3;

  // The first ear from `start` on, round the outline. If there is none, `start`.
  std::uint32_t find_ear(std::uint32_t start) {
    for (int leniency = 0; leniency < kRounds; ++leniency) {
      std::set<std::uint32_t>& open = open_[leniency];
      while (!open.empty()) {
        auto place = open.lower_bound(start);
        if (place == open.end()) place = open.begin();
        if (is_ear(*place, leniency)) return *place;
        open.erase(place);
      }
    }
    return start;
  }

  void cut(std::uint32_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    --left_;
    tree_.remove(i);
    for (auto& open : open_) open.erase(i);
    for (const std::uint32_t changed : {i, previous_[i], next_[i]}) {
      for (const Waiting& w : waiting_[changed]) {
        if (!tree_.has(w.corner)) continue;
        open_[w.leniency].insert(w.corner);
      }
      waiting_[changed].clear();
      if (changed == i) continue;
      for (auto& open : open_) open.insert(changed);
    }
  }

  bool is_ear(std::uint32_t i, int leniency) {
    const PlanePoint &a = p_[previous_[i]], &b = p_[i], &c = p_[next_[i]];
    const double area = plane_turn(a, b, c);
    if (leniency == 2) return area == 0.0;
    if (!(area > 0.0)) return false;
    const std::uint32_t blocker = tree_.find(a, b, c, [&](std::uint32_t j) {
      if (j == i || j == previous_[i] || j == next_[i]) return false;
      const PlanePoint& q = p_[j];
      // A corner at the same place as one of the ear's blocks it only if its edges enter the ear.
      if (same(q, a) || same(q, b) || same(q, c)) return enters(j, a, b, c);
      const double ab = plane_turn(a, b, q), bc = plane_turn(b, c, q), ca = plane_turn(c, a, q);
      return leniency == 0 ? ab >= 0.0 && bc >= 0.0 && ca >= 0.0 : ab > 0.0 && bc > 0.0 && ca > 0.0;
    });
    if (blocker == CornerTree::kNone) return true;
    waiting_[blocker].push_back({i, leniency});
    return false;
  }

  // Whether the outline goes from corner j, which lies on a, b or c, into the triangle.
  bool enters(std::uint32_t j, const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) const {
    const PlanePoint& q = p_[j];
    const PlanePoint corner[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
      if (!same(q, corner[k])) continue;
      for (const std::uint32_t neighbour : {previous_[j], next_[j]}) {
        const PlanePoint& r = p_[neighbour];
        if (plane_turn(q, corner[(k + 1) % 3], r) > 0.0 && plane_turn(q, corner[(k + 2) % 3], r) < 0.0) return true;
      }
      return false;
    }
    return false;
  }

  struct Waiting {
    std::uint32_t corner;
    int leniency;
  };

  const std::vector<PlanePoint>& p_;
  std::size_t left_;
  std::vector<std::uint32_t> next_, previous_;
  CornerTree tree_;
  std::set<std::uint32_t> open_[kRounds];      // corners that may be ears in a round
  std::vector<std::vector<Waiting>> waiting_;  // for a corner: those that it blocks
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
  std::vector<PlanePoint> points;
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
    if (plane_turn(points[t[0]], points[t[1]], points[t[2]]) >= 0.0) continue;
    triangles.resize(before);
    fan();
    return Triangulation::crossing;
  }
  return Triangulation::exact;
}

}  // namespace clray
