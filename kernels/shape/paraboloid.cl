// SPDX-License-Identifier: Apache-2.0
// Paraboloid of revolution (a dish): vertex at the origin, opening toward +z, rim of radius p[0] at z = p[1]:
// x² + y² = c·z with c = p[0]²/p[1], z <= p[1]; the normal points out of the bowl (-z at the vertex). The
// discriminant is expanded in minors of (o, d), c·(d_x·m_xz + d_y·m_yz + c·d_z²/4) - m_xy² (Lagrange's identity), each
// minor by differences of products, so that a far origin costs no digits; from inside it is a sum of positive terms.
#ifndef CLRAY_SHAPE_PARABOLOID_CL
#define CLRAY_SHAPE_PARABOLOID_CL
#include "shape/span.h"

CLRAY_FN f64 paraboloid_c(const CLRAY_GLOBAL f64* p) { return p[0] * p[0] / p[1]; }

/// Inside of the infinite paraboloid.
CLRAY_FN ShapeSpan span_paraboloid(f64 k, vec3 o, vec3 d) {
  const f64 a = fma(d.x, d.x, d.y * d.y);
  const f64 b = fma(-0.5 * k, d.z, difference_of_products(o.x, d.x, -o.y, d.y));
  const f64 c = fma(-k, o.z, fma(o.x, o.x, o.y * o.y));
  if (a < 1.0e-200) {
    const f64 t = -0.5 * c / b;  // parallel to the axis: one crossing
    return d.z > 0.0 ? span_make(t, CLRAY_SPAN_FAR) : span_make(-CLRAY_SPAN_FAR, t);
  }
  f64 disc;
  if (c < 0.0) {
    disc = fma(b, b, -(a * c));
  } else {
    const f64 mx = difference_of_products(d.x, o.z, o.x, d.z);
    const f64 my = difference_of_products(d.y, o.z, o.y, d.z);
    const f64 mz = difference_of_products(o.x, d.y, o.y, d.x);
    disc = difference_of_products(k, fma(d.x, mx, fma(d.y, my, 0.25 * k * (d.z * d.z))), mz, mz);
    if (disc < 0.0) return span_none();
  }
  return span_roots(a, b, c, disc);
}

CLRAY_FN i32 shape_paraboloid_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  const ShapeSpan s = span_slab(span_paraboloid(paraboloid_c(p), o, d), o.z, d.z, -CLRAY_SPAN_FAR, p[1], 1u, 2u);
  return span_hit(s, 0, t_max, t, part);
}

CLRAY_FN ShapeSurface shape_paraboloid_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  const f64 c = paraboloid_c(p);
  ShapeSurface s;
  vec3 x = v3_fma(t, d, o);
  f64 rho2 = fma(x.x, x.x, x.y * x.y);
  (void)part;
  if (rho2 > p[0] * p[0]) {
    const f64 shrink = p[0] / sqrt(rho2);
    x.x *= shrink;
    x.y *= shrink;
    rho2 = p[0] * p[0];
  }
  // Onto the surface along z where it is flat, along the radius where it is steep.
  if (2.0 * sqrt(rho2) <= c) {
    x.z = f64_min(rho2 / c, p[1]);
  } else {
    x.z = f64_clamp(x.z, 0.0, p[1]);
    const f64 grow = sqrt(c * x.z / rho2);
    x.x *= grow;
    x.y *= grow;
  }
  s.point = x;
  s.normal = v3_unit(v3(x.x, x.y, -0.5 * c));
  s.error = CLRAY_SHAPE_ROUND * (p[0] + p[1]);
  return s;
}

CLRAY_FN f64 shape_paraboloid_support(const CLRAY_GLOBAL f64* p, vec3 u) {
  const f64 across = sqrt(fma(u.x, u.x, u.y * u.y));
  // rho·across + rho²·u_z/c is largest inside the rim where its slope vanishes at rho < p[0].
  const f64 c = paraboloid_c(p);
  if (u.z < 0.0 && across * c < -2.0 * u.z * p[0]) return across * (across * c) / (-4.0 * u.z);
  return fma(p[0], across, p[1] * u.z);
}

CLRAY_FN f64 shape_paraboloid_area(const CLRAY_GLOBAL f64* p) {
  // (pi·R/6D²)·((R²+4D²)^(3/2) - R³) with the difference of cubes divided out.
  const f64 r = p[0], depth = 2.0 * p[1];
  const f64 s = sqrt(fma(r, r, depth * depth));
  return (2.0 * CLRAY_PI / 3.0) * r * (fma(s, s, fma(s, r, r * r)) / (s + r));
}

CLRAY_FN i32 shape_paraboloid_traits(const CLRAY_GLOBAL f64* p) {
  (void)p;
  return 0;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_paraboloid_facet(const f64* p, u32 part, ShapeFacet* facet) {
  (void)p;
  (void)part;
  (void)facet;
  return 0;
}
#endif

#endif
