// SPDX-License-Identifier: Apache-2.0
// Convex bodies as intervals of a ray's parameter. A ray is inside an infinite quadric, and inside a slab, for one
// interval each; the body is where they overlap (Kay & Kajiya 1986). Entry and exit come from the same two numbers
// whether or not the ends are capped, so a rim can neither lose a hit nor double it. Roots of quadratics without
// cancellation: Press et al. (2007), Numerical Recipes, section 5.6.
#ifndef CLRAY_SHAPE_SPAN_H
#define CLRAY_SHAPE_SPAN_H

#include "shape/shape.h"

#define CLRAY_SPAN_FAR 1.0e300
// 2^-48, 32 half-ulps: what a refined point, a step off it and the next test round, relative to the shape's size
// (docs/shapes.md has the sum).
#define CLRAY_SHAPE_ROUND 3.552713678800501e-15

/// The ray is inside for enter <= t <= leave, through these parts; empty if enter > leave.
typedef struct ShapeSpan {
  f64 enter, leave;
  u32 enter_part, leave_part;
} ShapeSpan;

CLRAY_FN ShapeSpan span_make(f64 enter, f64 leave) {
  ShapeSpan s;
  s.enter = enter;
  s.leave = leave;
  s.enter_part = 0u;
  s.leave_part = 0u;
  return s;
}
CLRAY_FN ShapeSpan span_all(void) { return span_make(-CLRAY_SPAN_FAR, CLRAY_SPAN_FAR); }
CLRAY_FN ShapeSpan span_none(void) { return span_make(CLRAY_SPAN_FAR, -CLRAY_SPAN_FAR); }

/// Between the roots of a·t² + 2b·t + c, a != 0, disc = b² - a·c >= 0.
CLRAY_FN ShapeSpan span_roots(f64 a, f64 b, f64 c, f64 disc) {
  const f64 s = sqrt(disc);
  const f64 q = b > 0.0 ? -(b + s) : s - b;
  if (q == 0.0) return span_make(0.0, 0.0);
  const f64 t0 = c / q;
  const f64 t1 = q / a;
  return t0 < t1 ? span_make(t0, t1) : span_make(t1, t0);
}

/// Overlap with low <= o + t·d <= high. If two ends are equal, the part that was there first keeps it.
CLRAY_FN ShapeSpan span_slab(ShapeSpan s, f64 o, f64 d, f64 low, f64 high, u32 low_part, u32 high_part) {
  if (d == 0.0) return o < low || o > high ? span_none() : s;
  const f64 t_low = (low - o) / d;
  const f64 t_high = (high - o) / d;
  const f64 enter = d > 0.0 ? t_low : t_high;
  const f64 leave = d > 0.0 ? t_high : t_low;
  if (enter > s.enter) {
    s.enter = enter;
    s.enter_part = d > 0.0 ? low_part : high_part;
  }
  if (leave < s.leave) {
    s.leave = leave;
    s.leave_part = d > 0.0 ? high_part : low_part;
  }
  return s;
}

/// Nearest end with 0 < t <= t_max; where `capped` is 0 only part 0 is there to be hit.
CLRAY_FN i32 span_hit(ShapeSpan s, i32 capped, f64 t_max, f64* t, u32* part) {
  if (!(s.enter <= s.leave)) return 0;
  f64 hit = s.enter;
  u32 of = s.enter_part;
  if (!(hit > 0.0) || (!capped && of != 0u)) {
    hit = s.leave;
    of = s.leave_part;
  }
  if (!(hit > 0.0) || hit > t_max || hit >= CLRAY_SPAN_FAR || (!capped && of != 0u)) return 0;
  *t = hit;
  *part = of;
  return 1;
}

/// Inside of x² + y² = r² (the infinite cylinder). The discriminant r²·a - (o×d)_z² by Lagrange's identity: the moment
/// of the line about the axis is known to 1.5 ulp however far the origin is.
CLRAY_FN ShapeSpan span_cylinder(f64 r, vec3 o, vec3 d) {
  const f64 rho = sqrt(fma(o.x, o.x, o.y * o.y));
  const f64 c = (rho - r) * (rho + r);
  const f64 a = fma(d.x, d.x, d.y * d.y);
  // With less than 1e-100 of sideways motion per metre the ray counts as parallel: a would underflow.
  if (a < 1.0e-200) return c <= 0.0 ? span_all() : span_none();
  const f64 b = difference_of_products(o.x, d.x, -o.y, d.y);
  if (c < 0.0) return span_roots(a, b, c, fma(b, b, -(a * c)));
  const f64 reach = r * sqrt(a);
  const f64 moment = fabs(difference_of_products(o.x, d.y, o.y, d.x));
  const f64 disc = (reach - moment) * (reach + moment);
  return disc < 0.0 ? span_none() : span_roots(a, b, c, disc);
}

/// Where the ray crosses z = height, to a few ulp of the crossing itself; d.z is not 0.
CLRAY_FN vec3 plane_point(vec3 o, vec3 d, f64 height) {
  const f64 z = o.z - height;
  return v3(difference_of_products(o.x, d.z, z, d.x) / d.z, difference_of_products(o.y, d.z, z, d.y) / d.z, height);
}

/// A point of an end disk, kept within `radius` of the axis.
CLRAY_FN vec3 disk_point(vec3 o, vec3 d, f64 height, f64 radius) {
  vec3 x = plane_point(o, d, height);
  const f64 rho = sqrt(fma(x.x, x.x, x.y * x.y));
  if (rho > radius) {
    const f64 shrink = radius / rho;
    x.x *= shrink;
    x.y *= shrink;
  }
  return x;
}

CLRAY_FN f64 f64_clamp(f64 x, f64 low, f64 high) { return x < low ? low : (x > high ? high : x); }

#endif
