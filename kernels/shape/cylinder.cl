// SPDX-License-Identifier: Apache-2.0
// Cylinder about z, centred: radius p[0], height p[1], with end disks if p[2]. The infinite cylinder's interval
// (span_cylinder: moment form of the discriminant after Haines et al. 2019, Ray Tracing Gems, chapter 7) overlapped
// with that of the slab |z| <= p[1]/2.
#ifndef CLRAY_SHAPE_CYLINDER_CL
#define CLRAY_SHAPE_CYLINDER_CL
#include "shape/span.h"

CLRAY_FN i32 shape_cylinder_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  const f64 half_height = 0.5 * p[1];
  const ShapeSpan s = span_slab(span_cylinder(p[0], o, d), o.z, d.z, -half_height, half_height, 1u, 2u);
  return span_hit(s, p[2] != 0.0, t_max, t, part);
}

CLRAY_FN ShapeSurface shape_cylinder_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  const f64 r = p[0];
  const f64 half_height = 0.5 * p[1];
  // Points stay this far from a rim, so that a step inward from either face ends inside.
  const f64 keep = 1.0 - CLRAY_SHAPE_ROUND;
  ShapeSurface s;
  if (part == 0u) {
    const vec3 x = v3_fma(t, d, o);
    const f64 rho = sqrt(fma(x.x, x.x, x.y * x.y));
    s.normal = v3(x.x / rho, x.y / rho, 0.0);
    s.point = v3(r * s.normal.x, r * s.normal.y, f64_clamp(x.z, -keep * half_height, keep * half_height));
    s.error = CLRAY_SHAPE_ROUND * r;
  } else {
    const f64 side = part == 1u ? -1.0 : 1.0;
    s.point = disk_point(o, d, side * half_height, keep * r);
    s.normal = v3(0.0, 0.0, side);
    s.error = CLRAY_SHAPE_ROUND * half_height;
  }
  return s;
}

CLRAY_FN f64 shape_cylinder_support(const CLRAY_GLOBAL f64* p, vec3 u) {
  return fma(p[0], sqrt(fma(u.x, u.x, u.y * u.y)), 0.5 * p[1] * fabs(u.z));
}

CLRAY_FN f64 shape_cylinder_area(const CLRAY_GLOBAL f64* p) {
  return 2.0 * CLRAY_PI * p[0] * (p[2] != 0.0 ? p[1] + p[0] : p[1]);
}

CLRAY_FN i32 shape_cylinder_traits(const CLRAY_GLOBAL f64* p) {
  return p[2] != 0.0 ? CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX : 0;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_cylinder_facet(const f64* p, u32 part, ShapeFacet* facet) {
  const f64 side = part == 1u ? -1.0 : 1.0;
  *facet = shape_facet_of(2u, side, 0.5 * side * p[1], 1u, p[0], 0.0);
  return p[2] != 0.0 && (part == 1u || part == 2u);
}
#endif

#endif
