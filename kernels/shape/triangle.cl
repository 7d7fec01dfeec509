// SPDX-License-Identifier: Apache-2.0
// Triangles of meshes: three vertices (9 numbers), the smallest first, winding kept. Watertight test of Woop, Benthin
// & Wald (2013) in fp64: vertices are carried into a frame where the ray is the z axis, in the same way for every
// triangle that shares them, and edge functions are Kahan differences of products, so their signs are exact and a ray
// through a shared edge hits at least one of its two triangles.
#ifndef CLRAY_TRIANGLE_CL
#define CLRAY_TRIANGLE_CL

/// What the test needs of a ray, once per ray.
typedef struct RayShear {
  f64 ox, oy, oz;  // its origin: z along the axis of the largest component of the direction, x and y follow cyclically
  f64 sx, sy, sz;
  u32 ix, iy, iz;  // which coordinates these are
} RayShear;

CLRAY_FN vec3 triangle_permute(vec3 a, u32 axis) {
  if (axis == 0u) return v3(a.y, a.z, a.x);
  if (axis == 1u) return v3(a.z, a.x, a.y);
  return a;
}

CLRAY_FN RayShear triangle_shear(vec3 o, vec3 d) {
  RayShear r;
  const f64 ax = fabs(d.x), ay = fabs(d.y), az = fabs(d.z);
  r.iz = az >= ax && az >= ay ? 2u : (ay >= ax ? 1u : 0u);
  r.ix = r.iz == 2u ? 0u : r.iz + 1u;
  r.iy = r.ix == 2u ? 0u : r.ix + 1u;
  const vec3 placed = triangle_permute(o, r.iz), p = triangle_permute(d, r.iz);
  r.ox = placed.x;
  r.oy = placed.y;
  r.oz = placed.z;
  r.sx = p.x / p.z;
  r.sy = p.y / p.z;
  r.sz = 1.0 / p.z;
  return r;
}

/// A vertex in the ray's frame: x and y across the ray, z along it in units of t.
CLRAY_FN vec3 triangle_vertex(const CLRAY_GLOBAL f64* p, const RayShear* r) {
  const f64 along = p[r->iz] - r->oz;
  return v3(fma(-r->sx, along, p[r->ix] - r->ox), fma(-r->sy, along, p[r->iy] - r->oy), r->sz * along);
}

/// Nearest hit with 0 < t <= t_max: 1, t and barycentric weights (sum 1 to rounding), or 0. One branch decides on the
/// signs: each alone would be guessed wrongly half of the time.
CLRAY_FN i32 triangle_intersect(const CLRAY_GLOBAL f64* p, const RayShear* r, f64 t_max, f64* t_hit, vec3* weights) {
  const vec3 a = triangle_vertex(p, r);
  const vec3 b = triangle_vertex(p + 3, r);
  const vec3 c = triangle_vertex(p + 6, r);
  const f64 u = difference_of_products(c.x, b.y, c.y, b.x);
  const f64 v = difference_of_products(a.x, c.y, a.y, c.x);
  const f64 w = difference_of_products(b.x, a.y, b.y, a.x);
  const i32 below = (u < 0.0) | (v < 0.0) | (w < 0.0), above = (u > 0.0) | (v > 0.0) | (w > 0.0);
  if ((below & above) != 0) return 0;
  const f64 det = u + v + w;
  if (det == 0.0) return 0;
  const f64 t = fma(u, a.z, fma(v, b.z, w * c.z)) / det;
  if (!(t > 0.0 && t <= t_max)) return 0;
  *t_hit = t;
  *weights = v3(u / det, v / det, w / det);
  return 1;
}

/// Point, unit normal (counter-clockwise side) and error bound of a hit with these weights.
CLRAY_FN ShapeSurface triangle_surface(const CLRAY_GLOBAL f64* p, vec3 weights) {
  const vec3 a = v3_load(p), b = v3_load(p + 3), c = v3_load(p + 6);
  ShapeSurface s;
  s.point = v3_fma(weights.x, a, v3_fma(weights.y, b, v3_scale(weights.z, c)));
  s.normal = v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a)));
  // gamma_7 of Pharr, Jakob & Humphreys (2016), section 3.9.4, summed over the axes; the factor 2 covers the move
  // itself.
  const f64 size_a = fabs(a.x) + fabs(a.y) + fabs(a.z);
  const f64 size_b = fabs(b.x) + fabs(b.y) + fabs(b.z);
  const f64 size_c = fabs(c.x) + fabs(c.y) + fabs(c.z);
  const f64 size = fma(weights.x, size_a, fma(weights.y, size_b, weights.z * size_c));
  s.error = 1.6e-15 * size;
  return s;
}

#endif
