// SPDX-License-Identifier: Apache-2.0
// Sphere of radius p[0] about the origin. Discriminant r²|d|² - |o×d|² (the squared half chord by way of the line's
// distance from the centre: Haines, Günther & Akenine-Möller 2019, "Precision improvements for ray/sphere
// intersection", Ray Tracing Gems, section 7.2), as a product of sum and difference; the moment o×d by differences of
// products is known to 1.5 ulp per component however far the origin is. Roots in the form without cancellation
// (same chapter, section 7.3).
#ifndef CLRAY_SHAPE_SPHERE_CL
#define CLRAY_SHAPE_SPHERE_CL
#include "shape/span.h"

CLRAY_FN i32 shape_sphere_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  const f64 r = p[0];
  const f64 distance = v3_length(o);
  const f64 a = v3_dot(d, d);
  const f64 b = v3_dot(o, d);
  const f64 c = (distance - r) * (distance + r);
  f64 disc;
  if (c < 0.0) {
    disc = fma(b, b, -(a * c));  // both terms positive: from inside there is always a hit
  } else {
    if (b >= 0.0) return 0;
    const f64 reach = r * sqrt(a);
    const f64 moment = v3_length(v3_cross(o, d));
    disc = (reach - moment) * (reach + moment);
    if (disc < 0.0) return 0;
  }
  return span_hit(span_roots(a, b, c, disc), 1, t_max, t, part);
}

CLRAY_FN ShapeSurface shape_sphere_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  ShapeSurface s;
  (void)part;
  s.normal = v3_unit(v3_fma(t, d, o));
  s.point = v3_scale(p[0], s.normal);
  s.error = CLRAY_SHAPE_ROUND * p[0];
  return s;
}

CLRAY_FN f64 shape_sphere_support(const CLRAY_GLOBAL f64* p, vec3 u) { return p[0] * v3_length(u); }

CLRAY_FN f64 shape_sphere_area(const CLRAY_GLOBAL f64* p) { return 4.0 * CLRAY_PI * p[0] * p[0]; }

CLRAY_FN i32 shape_sphere_traits(const CLRAY_GLOBAL f64* p) {
  (void)p;
  return CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_sphere_facet(const f64* p, u32 part, ShapeFacet* facet) {
  (void)p;
  (void)part;
  (void)facet;
  return 0;
}
#endif

#endif
