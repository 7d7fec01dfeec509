// SPDX-License-Identifier: Apache-2.0
// ellipse: a shape for scripts/test-additions, which adds it to a scratch copy. Elliptic plate with half axes p[0]
// along x and p[1] along y in z = 0, facing +z. Crossing and error as in rectangle.cl.
#ifndef CLRAY_SHAPE_ELLIPSE_CL
#define CLRAY_SHAPE_ELLIPSE_CL
#include "shape/span.h"

CLRAY_FN i32 shape_ellipse_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  if (d.z == 0.0) return 0;
  const f64 hit = -o.z / d.z;
  if (!(hit > 0.0) || hit > t_max || hit >= CLRAY_SPAN_FAR) return 0;
  const vec3 point = plane_point(o, d, 0.0);
  const f64 x = point.x / p[0], y = point.y / p[1];
  if (!(fma(x, x, y * y) <= 1.0)) return 0;
  *t = hit;
  *part = 0u;
  return 1;
}

CLRAY_FN ShapeSurface shape_ellipse_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  ShapeSurface s;
  (void)t;
  (void)part;
  s.point = plane_point(o, d, 0.0);
  s.normal = v3(0.0, 0.0, 1.0);
  s.error = CLRAY_SHAPE_ROUND * f64_max(p[0], p[1]);
  return s;
}

CLRAY_FN f64 shape_ellipse_support(const CLRAY_GLOBAL f64* p, vec3 u) {
  const f64 x = p[0] * u.x, y = p[1] * u.y;
  return sqrt(fma(x, x, y * y));
}

CLRAY_FN f64 shape_ellipse_area(const CLRAY_GLOBAL f64* p) {
  return CLRAY_PI * p[0] * p[1];
}

CLRAY_FN i32 shape_ellipse_traits(const CLRAY_GLOBAL f64* p) {
  (void)p;
  return CLRAY_SHAPE_CONVEX | CLRAY_SHAPE_PLANE;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_ellipse_facet(const f64* p, u32 part, ShapeFacet* facet) {
  (void)p;
  (void)part;
  (void)facet;
  return 0;
}
#endif

#endif
