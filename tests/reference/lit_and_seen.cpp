// SPDX-License-Identifier: Apache-2.0
// See lit_and_seen.hpp.
#include "lit_and_seen.hpp"

#include <algorithm>
#include <cmath>

namespace clray_reference {
namespace {

using Number = long double;
using Vector = std::array<Number, 3>;

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Number dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector scaled(const Vector& a, Number by) {
  return {a[0] * by, a[1] * by, a[2] * by};
}
Vector unit(const Vector& a) {
  return scaled(a, 1 / std::sqrt(dot(a, a)));
}
Vector of(const std::array<double, 3>& a) {
  return {a[0], a[1], a[2]};
}

Vector normal_of(const SoupTriangle& t) {
  return unit(cross(minus(of(t.corners[1]), of(t.corners[0])), minus(of(t.corners[2]), of(t.corners[0]))));
}

struct Spot {
  Number u, v;
};
using Polygon = std::vector<Spot>;

/// A plane with axes of its own.
struct PlaneFrame {
  Vector origin, u, v, n;

  Spot place(const Vector& x) const {
    const Vector d = minus(x, origin);
    return {dot(d, u), dot(d, v)};
  }
};

/// The shadow along `toward` of a triangle on a plane: of the part that is in front of it.
Polygon shadow(const SoupTriangle& t, const PlaneFrame& plane, const Vector& toward) {
  Polygon out;
  const auto add = [&](const Vector& x) {
    const Number h = dot(minus(x, plane.origin), plane.n);
    out.push_back(plane.place(minus(x, scaled(toward, h / dot(plane.n, toward)))));
  };
  for (int k = 0; k < 3; ++k) {
    const Vector a = of(t.corners[k]), b = of(t.corners[(k + 1) % 3]);
    const Number ha = dot(minus(a, plane.origin), plane.n), hb = dot(minus(b, plane.origin), plane.n);
    if (ha > 0) add(a);
    if ((ha > 0) != (hb > 0)) {
      const Number s = ha / (ha - hb);
      const Vector step = minus(b, a);
      add({a[0] + s * step[0], a[1] + s * step[1], a[2] + s * step[2]});
    }
  }
  return out;
}

struct Interval {
  Number low, high;
};

/// Where a convex polygon is cut at height v; empty where it is not.
Interval cut(const Polygon& p, Number v) {
  Interval i{HUGE_VALL, -HUGE_VALL};
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Spot &a = p[k], &b = p[(k + 1) % p.size()];
    if ((a.v < v) == (b.v < v)) continue;
    const Number u = a.u + (b.u - a.u) * ((v - a.v) / (b.v - a.v));
    i = {std::min(i.low, u), std::max(i.high, u)};
  }
  return i;
}

/// The length of the first interval that no other covers.
Number uncovered(const Interval& whole, std::vector<Interval> others) {
  std::sort(others.begin(), others.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
  Number length = 0, at = whole.low;
  for (const Interval& i : others) {
    if (!(i.low < i.high)) continue;
    if (i.low > at) length += std::max<Number>(0, std::min(i.low, whole.high) - at);
    at = std::max(at, i.high);
  }
  return length + std::max<Number>(0, whole.high - at);
}

/// Between neighbouring heights of corners and of crossings of edges the uncovered length is linear.
std::vector<Number> heights_of(const std::vector<Polygon>& polygons) {
  std::vector<std::array<Spot, 2>> edges;
  std::vector<Number> heights;
  for (const Polygon& p : polygons) {
    for (std::size_t k = 0; k < p.size(); ++k) {
      edges.push_back({p[k], p[(k + 1) % p.size()]});
      heights.push_back(p[k].v);
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = i + 1; k < edges.size(); ++k) {
      const auto& [a, b] = edges[i];
      const auto& [c, d] = edges[k];
      const Number det = (b.u - a.u) * (d.v - c.v) - (b.v - a.v) * (d.u - c.u);
      if (det == 0) continue;
      const Number s = ((c.u - a.u) * (d.v - c.v) - (c.v - a.v) * (d.u - c.u)) / det;
      if (s > 0 && s < 1) heights.push_back(a.v + s * (b.v - a.v));
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

/// The area of the first polygon that no other covers.
Number uncovered_area(const std::vector<Polygon>& polygons) {
  const std::vector<Number> heights = heights_of(polygons);
  Number area = 0;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const Number v = (heights[k] + heights[k + 1]) / 2;
    const Interval whole = cut(polygons.front(), v);
    if (!(heights[k + 1] > heights[k]) || !(whole.low < whole.high)) continue;
    std::vector<Interval> others;
    for (std::size_t p = 1; p < polygons.size(); ++p) others.push_back(cut(polygons[p], v));
    area += uncovered(whole, others) * (heights[k + 1] - heights[k]);
  }
  return area;
}

}  // namespace

std::vector<long double> lit_and_seen_areas(const std::vector<SoupTriangle>& soup, const std::array<double, 3>& source,
                                            const std::array<double, 3>& observer) {
  const Vector s = of(source), o = of(observer);
  std::vector<long double> areas;
  for (std::size_t t = 0; t < soup.size(); ++t) {
    PlaneFrame plane;
    plane.origin = of(soup[t].corners[0]);
    plane.n = normal_of(soup[t]);
    if (dot(plane.n, s) < 0) plane.n = scaled(plane.n, -1);
    plane.u = unit(minus(of(soup[t].corners[1]), plane.origin));
    plane.v = cross(plane.n, plane.u);
    areas.push_back(0);
    if (!(dot(plane.n, o) > 0)) continue;
    std::vector<Polygon> polygons(1);
    for (const auto& corner : soup[t].corners) polygons.front().push_back(plane.place(of(corner)));
    for (std::size_t k = 0; k < soup.size(); ++k) {
      if (k == t) continue;
      polygons.push_back(shadow(soup[k], plane, s));
      polygons.push_back(shadow(soup[k], plane, o));
    }
    areas.back() = uncovered_area(polygons);
  }
  return areas;
}

std::vector<long double> cosines(const std::vector<SoupTriangle>& soup, const std::array<double, 3>& direction) {
  std::vector<long double> out;
  for (const SoupTriangle& t : soup) out.push_back(std::fabs(dot(normal_of(t), of(direction))));
  return out;
}

}  // namespace clray_reference
