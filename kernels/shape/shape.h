// SPDX-License-Identifier: Apache-2.0
// What every analytic shape is given and gives. Portable subset (shared/portable.h). A shape lives in its local
// frame (z its axis, see shape.def); stage/intersect.cl carries rays in and hits out.
#ifndef CLRAY_SHAPE_H
#define CLRAY_SHAPE_H

#include "shared/abi.h"

typedef struct ShapeSurface {
  vec3 point;   // on the surface, refined (not merely o + t·d)
  vec3 normal;  // unit, outward (facing +z for open plane shapes), either side may be hit
  f64 error;    // bound of |computed point - exact surface|, m, in the local frame
} ShapeSurface;

#ifndef __OPENCL_VERSION__
/// A flat part of a shape, in its local frame: a rectangle or an annulus across an axis.
typedef struct ShapeFacet {
  u32 axis;    // of its normal: 0 x, 1 y, 2 z
  f64 side;    // 1 or -1: its front looks along that axis, or against it
  f64 offset;  // m, where it stands on that axis
  u32 round;   // 0: a rectangle about the axis, 1: an annulus about it
  f64 a, b;    // m: half the sizes along the next axis and the one after it, or the outer and the inner radius
} ShapeFacet;

CLRAY_FN ShapeFacet shape_facet_of(u32 axis, f64 side, f64 offset, u32 round, f64 a, f64 b) {
  const ShapeFacet f = {axis, side, offset, round, a, b};
  return f;
}
#endif

// A shape X is one file shape/X.cl that defines, for parameters p in the order of its row:
//   i32 shape_X_intersect(p, o, d, t_max, &t, &part)  nearest hit with 0 < t <= t_max of the ray o + t·d (d of unit
//                                                    length to rounding): 1 and t and the part (u32), or 0
//   ShapeSurface shape_X_surface(p, o, d, t, part)   point, normal and error of that hit
//   f64 shape_X_support(p, u)                        max over the shape of x·u (any u): exact bounds come from it
//   f64 shape_X_area(p)                              of one side, m²
//   i32 shape_X_traits(p)                            CLRAY_SHAPE_CLOSED, CLRAY_SHAPE_CONVEX (its surface bounds a
//                                                    convex body or lies in a plane), CLRAY_SHAPE_PLANE (no ray
//                                                    leaving it can hit it again), or several of them
//   i32 shape_X_facet(p, part, &facet)                whether that part is flat and there, and which face it is (host)
// with `const CLRAY_GLOBAL f64 *p`. A ray that starts on the outside, moved off by `error` along the normal, must not
// hit the same spot again, so the sign of a quadratic's constant term must be exact there. `error` therefore also
// covers the rounding of point ± normal·error and of the next test. The caller adds what carrying points between frames
// costs. Parts: 0 side, 1 bottom, 2 top; a box has 0 to 5 for -x +x -y +y -z +z.
#define CLRAY_SHAPE_CLOSED 1
#define CLRAY_SHAPE_CONVEX 2
#define CLRAY_SHAPE_PLANE 4

#endif
