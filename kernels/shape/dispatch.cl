// SPDX-License-Identifier: Apache-2.0
// Calls the analytic shape of a row of shape.def. The program builder defines CLRAY_SHAPE_<id> (row numbers),
// CLRAY_SHAPES(X) with X(id) for each shape of the scene (`triangle` is handled apart) and includes their files before
// this one; with one shape alone it defines CLRAY_SHAPE_ONLY as its id, and no choice is left to make.
#ifndef CLRAY_SHAPE_DISPATCH_CL
#define CLRAY_SHAPE_DISPATCH_CL

#define CLRAY_SHAPE_PASTE(id, function) shape_##id##_##function
#define CLRAY_SHAPE_CALL(id, function) CLRAY_SHAPE_PASTE(id, function)

CLRAY_WAY i32 shape_intersect(u32 shape, const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
#ifdef CLRAY_SHAPE_ONLY
  (void)shape;
  return CLRAY_SHAPE_CALL(CLRAY_SHAPE_ONLY, intersect)(p, o, d, t_max, t, part);
#else
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_intersect(p, o, d, t_max, t, part);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      return 0;
  }
#endif
}

CLRAY_FN ShapeSurface shape_surface(u32 shape, const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
#ifdef CLRAY_SHAPE_ONLY
  (void)shape;
  return CLRAY_SHAPE_CALL(CLRAY_SHAPE_ONLY, surface)(p, o, d, t, part);
#else
  ShapeSurface none;
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_surface(p, o, d, t, part);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      break;
  }
  none.point = v3_fma(t, d, o);
  none.normal = v3_neg(d);
  none.error = 0.0;
  return none;
#endif
}

CLRAY_FN f64 shape_support(u32 shape, const CLRAY_GLOBAL f64* p, vec3 u) {
#ifdef CLRAY_SHAPE_ONLY
  (void)shape;
  return CLRAY_SHAPE_CALL(CLRAY_SHAPE_ONLY, support)(p, u);
#else
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_support(p, u);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      return 0.0;
  }
#endif
}

CLRAY_FN f64 shape_area(u32 shape, const CLRAY_GLOBAL f64* p) {
#ifdef CLRAY_SHAPE_ONLY
  (void)shape;
  return CLRAY_SHAPE_CALL(CLRAY_SHAPE_ONLY, area)(p);
#else
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_area(p);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      return 0.0;
  }
#endif
}

CLRAY_FN i32 shape_traits(u32 shape, const CLRAY_GLOBAL f64* p) {
#ifdef CLRAY_SHAPE_ONLY
  (void)shape;
  return CLRAY_SHAPE_CALL(CLRAY_SHAPE_ONLY, traits)(p);
#else
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_traits(p);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      return 0;
  }
#endif
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_facet(u32 shape, const f64* p, u32 part, ShapeFacet* facet) {
  switch (shape) {
#define CLRAY_SHAPE_CASE(id) \
  case CLRAY_SHAPE_##id:     \
    return shape_##id##_facet(p, part, facet);
    CLRAY_SHAPES(CLRAY_SHAPE_CASE)
#undef CLRAY_SHAPE_CASE
    default:
      return 0;
  }
}
#endif

#endif
