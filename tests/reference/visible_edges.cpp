// SPDX-License-Identifier: Apache-2.0
// See visible_edges.hpp.
#include "visible_edges.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace clray_reference {
namespace {

using Number = long double;
constexpr std::size_t kNone = ~std::size_t{0};

struct Point2 {
  Number x, y;
};

/// z = p·x + q·y + r
struct Plane {
  Number p, q, r;
  Number z(const Point2& at) const { return p * at.x + q * at.y + r; }
};

struct Triangle {
  Point2 corners[3];  // counter-clockwise
  Plane plane;
};

Number cross(const Point2& a, const Point2& b) {
  return a.x * b.y - a.y * b.x;
}

Triangle triangle_of(const SoupTriangle& t) {
  const auto& c = t.corners;
  const Number ax = Number(c[1][0]) - c[0][0], ay = Number(c[1][1]) - c[0][1], az = Number(c[1][2]) - c[0][2];
  const Number bx = Number(c[2][0]) - c[0][0], by = Number(c[2][1]) - c[0][1], bz = Number(c[2][2]) - c[0][2];
  const Number det = ax * by - ay * bx;
  Triangle out;
  out.plane.p = (az * by - ay * bz) / det;
  out.plane.q = (ax * bz - az * bx) / det;
  out.plane.r = c[0][2] - out.plane.p * c[0][0] - out.plane.q * c[0][1];
  for (int k = 0; k < 3; ++k) out.corners[k] = {c[k][0], c[k][1]};
  if (det < 0) std::swap(out.corners[1], out.corners[2]);
  return out;
}

/// A piece of a straight line, by a parameter from 0 to 1.
struct Segment {
  Point2 a, b;
  Point2 at(Number t) const { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }
};

struct Interval {
  Number from, to;
};

/// The part of a segment over a triangle.
std::optional<Interval> over(const Segment& s, const Triangle& t) {
  Interval part{0, 1};
  for (int k = 0; k < 3; ++k) {
    const Point2 &a = t.corners[k], &b = t.corners[(k + 1) % 3];
    const Point2 e{b.x - a.x, b.y - a.y};
    const Number u = cross(e, {s.a.x - a.x, s.a.y - a.y}), v = cross(e, {s.b.x - a.x, s.b.y - a.y});
    if (u <= 0 && v <= 0) return {};
    if (u < 0) part.from = std::max(part.from, u / (u - v));
    if (v < 0) part.to = std::min(part.to, u / (u - v));
  }
  if (part.from >= part.to) return {};
  return part;
}

/// A triangle over a part of a segment: its depth there is z0 + slope·t.
struct Cover {
  std::size_t triangle;
  Interval part;
  Number z0, slope;
  Number z(Number t) const { return z0 + slope * t; }
};

class Walk {
 public:
  explicit Walk(const std::vector<SoupTriangle>& soup) : areas_(soup.size(), 0) {
    for (const SoupTriangle& t : soup) triangles_.push_back(triangle_of(t));
  }

  std::vector<Number> run() {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const Segment edge{triangles_[i].corners[k], triangles_[i].corners[(k + 1) % 3]};
        along(edge, i, kNone);
      }
      for (std::size_t k = i + 1; k < triangles_.size(); ++k) {
        if (const auto line = crossing(i, k)) along(*line, i, k);
      }
    }
    return areas_;
  }

 private:
  /// The segment along which two triangles pass through one another.
  std::optional<Segment> crossing(std::size_t i, std::size_t k) const {
    const Plane &a = triangles_[i].plane, &b = triangles_[k].plane;
    const Plane gap{a.p - b.p, a.q - b.q, a.r - b.r};
    std::vector<Point2> ends;  // where the line meets the outline of i
    for (int e = 0; e < 3; ++e) {
      const Point2 &from = triangles_[i].corners[e], &to = triangles_[i].corners[(e + 1) % 3];
      const Number u = gap.z(from), v = gap.z(to);
      if ((u > 0) != (v > 0)) ends.push_back(Segment{from, to}.at(u / (u - v)));
    }
    if (ends.size() != 2) return {};
    const Segment line{ends[0], ends[1]};
    const auto part = over(line, triangles_[k]);
    if (!part) return {};
    return Segment{line.at(part->from), line.at(part->to)};
  }

  /// Follows an edge of triangle i, or the line along which i and k cross.
  void along(const Segment& s, std::size_t i, std::size_t k) {
    segment_ = s;
    left_ = i;
    right_ = k;
    if (k != kNone) {
      const Plane &a = triangles_[i].plane, &b = triangles_[k].plane;
      const Point2 left{s.a.y - s.b.y, s.b.x - s.a.x};
      if ((a.p - b.p) * left.x + (a.q - b.q) * left.y < 0) std::swap(left_, right_);
    }
    own_ = cover(i, {0, 1});
    std::vector<Cover> covers;
    std::vector<Number> ends{0, 1};
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (t == i || t == k) continue;
      const auto part = over(s, triangles_[t]);
      if (!part) continue;
      covers.push_back(cover(t, *part));
      ends.insert(ends.end(), {part->from, part->to});
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t e = 0; e + 1 < ends.size(); ++e) {
      const Number from = ends[e], to = ends[e + 1];
      if (!(to > from)) continue;
      std::vector<Cover> here;
      for (const Cover& c : covers) {
        if (c.part.from <= from && c.part.to >= to) here.push_back(c);
      }
      if (here.empty()) {
        add(from, to, kNone);
      } else {
        envelope(here, from, *top(here, from), to, *top(here, to));
      }
    }
  }

  Cover cover(std::size_t t, const Interval& part) const {
    const Number z0 = triangles_[t].plane.z(segment_.a), z1 = triangles_[t].plane.z(segment_.b);
    return {t, part, z0, z1 - z0};
  }

  static const Cover* top(const std::vector<Cover>& covers, Number t) {
    return &*std::max_element(covers.begin(), covers.end(),
                              [&](const Cover& a, const Cover& b) { return a.z(t) < b.z(t); });
  }

  /// The upper envelope from `from`, where `a` is on top, to `to`, where `b` is.
  void envelope(const std::vector<Cover>& covers, Number from, const Cover& a, Number to, const Cover& b) {
    if (a.triangle == b.triangle || a.slope == b.slope) return below_or_behind(from, to, a);
    const Number meet = std::clamp((b.z0 - a.z0) / (a.slope - b.slope), from, to);
    const Cover& c = *top(covers, meet);
    const bool other = c.triangle != a.triangle && c.triangle != b.triangle;
    if (other && meet > from && meet < to) {
      envelope(covers, from, a, meet, c);
      envelope(covers, meet, c, to, b);
    } else {
      below_or_behind(from, meet, a);
      below_or_behind(meet, to, b);
    }
  }

  /// Of a piece on which `other` is the nearest of all but the segment's own: adds what is in front of it.
  void below_or_behind(Number from, Number to, const Cover& other) {
    const Number u = own_.z(from) - other.z(from), v = own_.z(to) - other.z(to);
    if (u <= 0 && v <= 0) return;
    if (u < 0) {
      from += (to - from) * (u / (u - v));
    } else if (v < 0) {
      to = from + (to - from) * (u / (u - v));
    }
    add(from, to, other.triangle);
  }

  /// A piece of the segment that is seen: `behind` is next to an edge.
  void add(Number from, Number to, std::size_t behind) {
    const Number area = cross(segment_.at(from), segment_.at(to)) / 2;
    areas_[left_] += area;
    const std::size_t beside = right_ == kNone ? behind : right_;
    if (beside != kNone) areas_[beside] -= area;
  }

  std::vector<Triangle> triangles_;
  std::vector<Number> areas_;
  Segment segment_{};
  std::size_t left_ = 0, right_ = 0;  // faces of which the segment bounds the visible parts
  Cover own_{};
};

}  // namespace

std::vector<long double> visible_areas_by_edges(const std::vector<SoupTriangle>& soup) {
  return Walk(soup).run();
}

}  // namespace clray_reference
