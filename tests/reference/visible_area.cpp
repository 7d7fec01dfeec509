// SPDX-License-Identifier: Apache-2.0
// See visible_area.hpp.
#include "visible_area.hpp"

#include <algorithm>
#include <cmath>

namespace clray_reference {
namespace {

using Number = long double;

struct Point2 {
  Number x, y;
};

/// A segment across z, from low to high y.
struct Segment {
  Point2 a, b;
  Number at(Number y) const { return a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)); }
  bool spans(Number y) const { return a.y < y && y < b.y; }
};

Segment ordered(Point2 a, Point2 b) {
  return a.y <= b.y ? Segment{a, b} : Segment{b, a};
}

/// z of a triangle's plane: z = p·x + q·y + r.
struct Plane {
  Number p, q, r;
  Number z(Number x, Number y) const { return p * x + q * y + r; }
};

Plane plane_of(const SoupTriangle& t) {
  const auto& c = t.corners;
  const Number ax = Number(c[1][0]) - c[0][0], ay = Number(c[1][1]) - c[0][1], az = Number(c[1][2]) - c[0][2];
  const Number bx = Number(c[2][0]) - c[0][0], by = Number(c[2][1]) - c[0][1], bz = Number(c[2][2]) - c[0][2];
  const Number det = ax * by - ay * bx;
  const Number p = (az * by - ay * bz) / det, q = (ax * bz - az * bx) / det;
  return {p, q, c[0][2] - p * c[0][0] - q * c[0][1]};
}

struct Scan {
  std::vector<std::array<Segment, 3>> edges;
  std::vector<Plane> planes;
  std::vector<Segment> crossings;
  std::vector<Number> heights;
};

/// The part of the line along which two planes meet that lies over both triangles.
void add_crossing(const Scan& scan, std::size_t i, std::size_t k, std::vector<Segment>* crossings) {
  const Plane &a = scan.planes[i], &b = scan.planes[k];
  const Number p = a.p - b.p, q = a.q - b.q, r = a.r - b.r;  // p·x + q·y + r = 0
  std::vector<Point2> ends;
  for (const std::size_t t : {i, k}) {
    for (const Segment& e : scan.edges[t]) {
      const Number u = p * e.a.x + q * e.a.y + r, v = p * e.b.x + q * e.b.y + r;
      if ((u > 0) == (v > 0)) continue;
      const Number s = u / (u - v);
      ends.push_back({e.a.x + s * (e.b.x - e.a.x), e.a.y + s * (e.b.y - e.a.y)});
    }
  }
  if (ends.size() != 4) return;
  // Along the line: both triangles have an interval; the crossing is where they overlap.
  const auto along = [&](const Point2& x) { return -q * x.x + p * x.y; };
  const auto less = [&](const Point2& x, const Point2& y) { return along(x) < along(y); };
  if (less(ends[1], ends[0])) std::swap(ends[0], ends[1]);
  if (less(ends[3], ends[2])) std::swap(ends[2], ends[3]);
  const Point2 from = less(ends[0], ends[2]) ? ends[2] : ends[0], to = less(ends[1], ends[3]) ? ends[1] : ends[3];
  if (less(from, to)) crossings->push_back(ordered(from, to));
}

void add_meeting(const Segment& a, const Segment& b, std::vector<Number>* heights) {
  const Number ax = a.b.x - a.a.x, ay = a.b.y - a.a.y, bx = b.b.x - b.a.x, by = b.b.y - b.a.y;
  const Number det = ax * by - ay * bx;
  if (det == 0) return;
  const Number dx = b.a.x - a.a.x, dy = b.a.y - a.a.y;
  const Number s = (dx * by - dy * bx) / det, t = (dx * ay - dy * ax) / det;
  if (s > 0 && s < 1 && t > 0 && t < 1) heights->push_back(a.a.y + s * ay);
}

/// Adds the lengths in which triangles are seen at height y, times `thickness`.
void add_lengths(const Scan& scan, Number y, Number thickness, std::vector<Number>* areas) {
  struct Interval {
    Number low, high;
    std::size_t triangle;
  };
  std::vector<Interval> intervals;
  std::vector<Number> places;
  for (std::size_t t = 0; t < scan.edges.size(); ++t) {
    Number x[2];
    int count = 0;
    for (const Segment& e : scan.edges[t]) {
      if (e.spans(y) && count < 2) x[count++] = e.at(y);
    }
    if (count != 2) continue;
    intervals.push_back({std::min(x[0], x[1]), std::max(x[0], x[1]), t});
    places.insert(places.end(), {x[0], x[1]});
  }
  for (const Segment& c : scan.crossings) {
    if (c.spans(y)) places.push_back(c.at(y));
  }
  std::sort(places.begin(), places.end());
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const Number x = (places[k] + places[k + 1]) / 2;
    const Interval* top = nullptr;
    for (const Interval& i : intervals) {
      if (!(i.low < x && x < i.high)) continue;
      if (top == nullptr || scan.planes[i.triangle].z(x, y) > scan.planes[top->triangle].z(x, y)) top = &i;
    }
    if (top != nullptr) (*areas)[top->triangle] += (places[k + 1] - places[k]) * thickness;
  }
}

}  // namespace

std::vector<long double> visible_areas(const std::vector<SoupTriangle>& soup) {
  Scan scan;
  for (const SoupTriangle& t : soup) {
    std::array<Segment, 3> edges;
    for (int k = 0; k < 3; ++k) {
      const auto &a = t.corners[k], &b = t.corners[(k + 1) % 3];
      edges[k] = ordered({a[0], a[1]}, {b[0], b[1]});
      scan.heights.push_back(a[1]);
    }
    scan.edges.push_back(edges);
    scan.planes.push_back(plane_of(t));
  }
  for (std::size_t i = 0; i < soup.size(); ++i) {
    for (std::size_t k = i + 1; k < soup.size(); ++k) add_crossing(scan, i, k, &scan.crossings);
  }
  std::vector<Segment> all = scan.crossings;
  for (const auto& edges : scan.edges) all.insert(all.end(), edges.begin(), edges.end());
  for (const Segment& c : scan.crossings) scan.heights.insert(scan.heights.end(), {c.a.y, c.b.y});
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = i + 1; k < all.size(); ++k) add_meeting(all[i], all[k], &scan.heights);
  }
  std::sort(scan.heights.begin(), scan.heights.end());
  std::vector<long double> areas(soup.size(), 0.0L);
  for (std::size_t k = 0; k + 1 < scan.heights.size(); ++k) {
    const Number low = scan.heights[k], high = scan.heights[k + 1];
    if (high > low) add_lengths(scan, (low + high) / 2, high - low, &areas);
  }
  return areas;
}

}  // namespace clray_reference
