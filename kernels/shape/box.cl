// SPDX-License-Identifier: Apache-2.0
// Box p[0] by p[1] by p[2], centred. Overlap of three slabs (Kay & Kajiya 1986). Parts 0 to 5: -x +x -y +y -z +z.
// Coordinates of a hit within its face are minors of (o - corner, d) over the face's direction component, by
// differences of products.
#ifndef CLRAY_SHAPE_BOX_CL
#define CLRAY_SHAPE_BOX_CL
#include "shape/span.h"

CLRAY_FN i32 shape_box_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  ShapeSpan s = span_slab(span_all(), o.x, d.x, -0.5 * p[0], 0.5 * p[0], 0u, 1u);
  s = span_slab(s, o.y, d.y, -0.5 * p[1], 0.5 * p[1], 2u, 3u);
  s = span_slab(s, o.z, d.z, -0.5 * p[2], 0.5 * p[2], 4u, 5u);
  return span_hit(s, 1, t_max, t, part);
}

/// One coordinate where the ray crosses the face at distance z of another, kept within `half` off the edges.
CLRAY_FN f64 box_coordinate(f64 o, f64 d, f64 o_face, f64 d_face, f64 half_size) {
  // Kept off the edge by the rounding of a step, so that a step inward from either face ends inside.
  const f64 keep = (1.0 - CLRAY_SHAPE_ROUND) * half_size;
  return f64_clamp(difference_of_products(o, d_face, o_face, d) / d_face, -keep, keep);
}

CLRAY_FN ShapeSurface shape_box_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  ShapeSurface s;
  const f64 side = (part & 1u) != 0u ? 1.0 : -1.0;
  const f64 hx = 0.5 * p[0], hy = 0.5 * p[1], hz = 0.5 * p[2];
  (void)t;
  if (part < 2u) {
    const f64 w = fma(-side, hx, o.x);
    s.point = v3(side * hx, box_coordinate(o.y, d.y, w, d.x, hy), box_coordinate(o.z, d.z, w, d.x, hz));
    s.normal = v3(side, 0.0, 0.0);
    s.error = CLRAY_SHAPE_ROUND * hx;
  } else if (part < 4u) {
    const f64 w = fma(-side, hy, o.y);
    s.point = v3(box_coordinate(o.x, d.x, w, d.y, hx), side * hy, box_coordinate(o.z, d.z, w, d.y, hz));
    s.normal = v3(0.0, side, 0.0);
    s.error = CLRAY_SHAPE_ROUND * hy;
  } else {
    const f64 w = fma(-side, hz, o.z);
    s.point = v3(box_coordinate(o.x, d.x, w, d.z, hx), box_coordinate(o.y, d.y, w, d.z, hy), side * hz);
    s.normal = v3(0.0, 0.0, side);
    s.error = CLRAY_SHAPE_ROUND * hz;
  }
  return s;
}

CLRAY_FN f64 shape_box_support(const CLRAY_GLOBAL f64* p, vec3 u) {
  return 0.5 * fma(p[0], fabs(u.x), fma(p[1], fabs(u.y), p[2] * fabs(u.z)));
}

CLRAY_FN f64 shape_box_area(const CLRAY_GLOBAL f64* p) { return 2.0 * fma(p[0], p[1], fma(p[1], p[2], p[2] * p[0])); }

CLRAY_FN i32 shape_box_traits(const CLRAY_GLOBAL f64* p) {
  (void)p;
  return CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_box_facet(const f64* p, u32 part, ShapeFacet* facet) {
  if (part >= 6u) return 0;
  const u32 axis = part / 2u;
  const f64 side = part % 2u != 0u ? 1.0 : -1.0;
  *facet = shape_facet_of(axis, side, 0.5 * side * p[axis], 0u, 0.5 * p[(axis + 1u) % 3u], 0.5 * p[(axis + 2u) % 3u]);
  return 1;
}
#endif

#endif
