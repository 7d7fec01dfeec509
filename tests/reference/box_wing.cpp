// SPDX-License-Identifier: Apache-2.0
// See box_wing.hpp.
#include "box_wing.hpp"

#include <cmath>
#include <vector>

namespace clray_reference {
namespace {

using Number = long double;
using Vector = std::array<Number, 3>;
struct Point2 {
  Number x, y;
};
using Outline = std::vector<Point2>;

Number dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
Vector unit(const Vector& a) {
  const Number length = std::sqrt(dot(a, a));
  return {{a[0] / length, a[1] / length, a[2] / length}};
}

Number twice_area(const Outline& p) {
  Number sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Point2 &a = p[k], &b = p[(k + 1) % p.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

/// The overlap of two convex outlines, both counter-clockwise (Sutherland & Hodgman 1974).
Outline overlap(Outline a, const Outline& b) {
  for (std::size_t k = 0; k < b.size(); ++k) {
    const Point2 &from = b[k], &to = b[(k + 1) % b.size()];
    const auto side = [&](const Point2& p) {
      return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
    };
    Outline kept;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Point2 &p = a[i], &q = a[(i + 1) % a.size()];
      const Number u = side(p), v = side(q);
      if (u >= 0) kept.push_back(p);
      if ((u > 0 && v < 0) || (u < 0 && v > 0))
        kept.push_back({p.x + u / (u - v) * (q.x - p.x), p.y + u / (u - v) * (q.y - p.y)});
    }
    a = kept;
  }
  return a;
}

struct Face {
  Outline outline;  // across the beam
  Number area = 0, cosine = 0;
};

class View {
 public:
  explicit View(const std::array<double, 3>& source) : s_{{source[0], source[1], source[2]}} {
    const Vector aside = std::fabs(s_[0]) < 0.5L ? Vector{{1, 0, 0}} : Vector{{0, 1, 0}};
    u_ = unit(cross(aside, s_));
    v_ = cross(s_, u_);
  }

  /// A rectangle by its centre and half of its sides.
  Face face(const Vector& centre, const Vector& a, const Vector& b) const {
    Face f;
    for (const auto& [i, k] : {std::pair<int, int>{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      Vector x;
      for (int n = 0; n < 3; ++n) x[n] = centre[n] + i * a[n] + k * b[n];
      f.outline.push_back({dot(u_, x), dot(v_, x)});
    }
    Number area = twice_area(f.outline) / 2;
    if (area < 0) f.outline = Outline(f.outline.rbegin(), f.outline.rend());
    f.area = std::fabs(area);
    f.cosine = std::fabs(dot(unit(cross(a, b)), s_));
    return f;
  }

 private:
  Vector s_, u_, v_;
};

Number shared(const Outline& a, const Outline& b) {
  return twice_area(overlap(a, b)) / 2;
}

}  // namespace

BoxWingView box_wing_view(const BoxWing& body, const std::array<double, 3>& source) {
  const View view(source);
  std::vector<Face> box;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    Vector centre{}, a{}, b{};
    centre[axis] = source[axis] >= 0.0 ? body.half[axis] : -body.half[axis];
    a[next] = body.half[next];
    b[last] = body.half[last];
    box.push_back(view.face(centre, a, b));
  }
  const auto wing = [&](double sign) {
    return view.face({{0, sign * body.wing_y, 0}}, {{0, body.half_span, 0}},
                     {{body.half_chord[0], body.half_chord[1], body.half_chord[2]}});
  };
  // One wing is nearer than the box, and the box is nearer than the other wing.
  const double ahead = source[1] >= 0.0 ? 1.0 : -1.0;
  const Face near = wing(ahead), far = wing(-ahead);
  BoxWingView out;
  const auto add = [&](const Face& f, Number hidden) {
    out.area_times_cosine += (f.area - hidden) * f.cosine;
    out.hidden += hidden;
  };
  add(near, 0);
  Number hidden = shared(far.outline, near.outline);
  for (const Face& f : box) {
    add(f, shared(f.outline, near.outline));
    // The box's faces do not overlap; where the near wing hides the far one, too, the box adds nothing.
    const Outline both = overlap(far.outline, f.outline);
    hidden += twice_area(both) / 2 - shared(both, near.outline);
  }
  add(far, hidden);
  return out;
}

}  // namespace clray_reference
