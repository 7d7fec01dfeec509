// SPDX-License-Identifier: Apache-2.0
// Disk or annulus in z = 0 facing +z: radius p[0], inner radius p[1]. The crossing is (o×d)/d_z by differences of
// products (Kahan), good to a few ulp of itself at any distance and any tilt.
#ifndef CLRAY_SHAPE_DISK_CL
#define CLRAY_SHAPE_DISK_CL
#include "shape/span.h"

CLRAY_FN i32 shape_disk_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  if (d.z == 0.0) return 0;
  const f64 hit = -o.z / d.z;
  if (!(hit > 0.0) || hit > t_max || hit >= CLRAY_SPAN_FAR) return 0;
  const vec3 x = plane_point(o, d, 0.0);
  const f64 rho = sqrt(fma(x.x, x.x, x.y * x.y));
  if (!(rho <= p[0]) || rho < p[1]) return 0;
  *t = hit;
  *part = 0u;
  return 1;
}

CLRAY_FN ShapeSurface shape_disk_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  ShapeSurface s;
  (void)t;
  (void)part;
  s.point = disk_point(o, d, 0.0, p[0]);
  s.normal = v3(0.0, 0.0, 1.0);
  s.error = CLRAY_SHAPE_ROUND * p[0];
  return s;
}

CLRAY_FN f64 shape_disk_support(const CLRAY_GLOBAL f64* p, vec3 u) { return p[0] * sqrt(fma(u.x, u.x, u.y * u.y)); }

CLRAY_FN f64 shape_disk_area(const CLRAY_GLOBAL f64* p) {
  return p[1] < p[0] ? CLRAY_PI * ((p[0] - p[1]) * (p[0] + p[1])) : 0.0;
}

CLRAY_FN i32 shape_disk_traits(const CLRAY_GLOBAL f64* p) {
  (void)p;
  return CLRAY_SHAPE_CONVEX | CLRAY_SHAPE_PLANE;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_disk_facet(const f64* p, u32 part, ShapeFacet* facet) {
  *facet = shape_facet_of(2u, 1.0, 0.0, 1u, p[0], p[1]);
  return part == 0u;
}
#endif

#endif
