// SPDX-License-Identifier: Apache-2.0
// Cone or frustum about z: radius p[0] at z = 0, p[2] at z = height p[1], with end disks if p[3]. With P = (H·o_x,
// H·o_y, W), D = (H·d_x, H·d_y, K·d_z), W = H·radius(o_z), K = p[2] - p[0] and the form <u,v> = u1v1 + u2v2 - u3v3 a
// ray is inside where <P,P> + 2t<P,D> + t²<D,D> <= 0. The discriminant <P,D>² - <P,P><D,D> is m13² + m23² - m12² in the
// minors of (P, D) (Lagrange's identity of that form; minors by differences of products), a product of sum and
// difference; where both terms of the plain form are positive it is that. A far origin is first moved along the ray to
// where it passes the narrow end, so that the form is not near cancellation around an apex.
#ifndef CLRAY_SHAPE_CONE_CL
#define CLRAY_SHAPE_CONE_CL
#include "shape/span.h"

/// <u,u> as a product, so that its sign is right to rounding of the lengths.
CLRAY_FN f64 cone_form(vec3 u) {
  const f64 rho = sqrt(fma(u.x, u.x, u.y * u.y));
  return (rho - u.z) * (rho + u.z);
}

/// Inside of the nappe W >= 0 of the double cone.
CLRAY_FN ShapeSpan span_cone(vec3 P, vec3 D) {
  const f64 a = cone_form(D);
  const f64 c = cone_form(P);
  f64 b = fma(P.x, D.x, difference_of_products(P.y, D.y, P.z, D.z));
  // Inside a nappe the sign of a steep ray's b is known (reversed Cauchy-Schwarz), and rounding must not change it.
  if (c < 0.0 && a <= 0.0 && D.z != 0.0) b = (D.z > 0.0) == (P.z > 0.0) ? -fabs(b) : fabs(b);
  if (a == 0.0) {
    if (D.z == 0.0) return c <= 0.0 ? span_all() : span_none();
    if (b == 0.0 || (b > 0.0) == (D.z > 0.0)) return span_none();
    return b > 0.0 ? span_make(-CLRAY_SPAN_FAR, -0.5 * c / b) : span_make(-0.5 * c / b, CLRAY_SPAN_FAR);
  }
  f64 disc;
  if ((a > 0.0) != (c > 0.0)) {
    disc = fma(b, b, -(a * c));
  } else {
    const f64 m13 = difference_of_products(P.x, D.z, P.z, D.x);
    const f64 m23 = difference_of_products(P.y, D.z, P.z, D.y);
    const f64 m12 = fabs(difference_of_products(P.x, D.y, P.y, D.x));
    const f64 reach = sqrt(fma(m13, m13, m23 * m23));
    disc = (reach - m12) * (reach + m12);
    if (a < 0.0 && disc < 0.0) disc = 0.0;  // a steep ray always crosses the double cone
  }
  if (disc < 0.0) return span_none();
  const ShapeSpan s = span_roots(a, b, c, disc);
  if (a > 0.0) {
    const i32 inside = c < 0.0 && P.z > 0.0;
    return !inside && difference_of_products(P.z, a, D.z, b) < 0.0 ? span_none() : s;
  }
  return D.z > 0.0 ? span_make(s.leave, CLRAY_SPAN_FAR) : span_make(-CLRAY_SPAN_FAR, s.enter);
}

/// P of a point.
CLRAY_FN vec3 cone_vector(const CLRAY_GLOBAL f64* p, vec3 x) {
  return v3(p[1] * x.x, p[1] * x.y, fma(p[0], p[1] - x.z, p[2] * x.z));
}

CLRAY_FN i32 shape_cone_intersect(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t_max, f64* t, u32* part) {
  const f64 height = p[1];
  const f64 narrow = p[2] < p[0] ? height : 0.0;
  f64 shift = fma(narrow - o.z, d.z, difference_of_products(-o.x, d.x, o.y, d.y));
  // Only origins outside a ball about the cone are moved; nearer ones need the sign of their own <P,P>.
  const f64 wide = f64_max(p[0], p[2]);
  if (shift <= sqrt(fma(wide, wide, height * height))) shift = 0.0;
  o = v3_fma(shift, d, o);
  const vec3 P = cone_vector(p, o);
  const vec3 D = v3(height * d.x, height * d.y, (p[2] - p[0]) * d.z);
  // At an apex the nappe ends by itself, and a slab could only round a hit away.
  const f64 top = p[2] > 0.0 ? height : CLRAY_SPAN_FAR;
  ShapeSpan s = span_slab(span_cone(P, D), o.z, d.z, 0.0, top, 1u, 2u);
  s.enter += shift;
  s.leave += shift;
  return span_hit(s, p[3] != 0.0, t_max, t, part);
}

CLRAY_FN ShapeSurface shape_cone_surface(const CLRAY_GLOBAL f64* p, vec3 o, vec3 d, f64 t, u32 part) {
  const f64 r = p[0], height = p[1], top = p[2];
  const f64 slope = top - r;
  const f64 slant = sqrt(fma(slope, slope, height * height));
  ShapeSurface s;
  s.error = CLRAY_SHAPE_ROUND * (f64_max(r, top) + height);
  if (part == 0u) {
    const vec3 x = v3_fma(t, d, o);
    const f64 rho = sqrt(fma(x.x, x.x, x.y * x.y));
    f64 cos_phi = x.x / rho;
    f64 sin_phi = x.y / rho;
    if (rho <= CLRAY_SHAPE_ROUND * (t + height)) {
      // At an apex rounding loses the azimuth. A ray from outside meets the face turned to it, a ray from inside the
      // face turned away.
      const vec3 P = cone_vector(p, o);
      const f64 across = sqrt(fma(d.x, d.x, d.y * d.y));
      const f64 turn = cone_form(P) < 0.0 && P.z > 0.0 ? across : -across;
      cos_phi = across > 0.0 ? d.x / turn : 1.0;
      sin_phi = across > 0.0 ? d.y / turn : 0.0;
    }
    // The nearest point of the generator, as a share of its length. It is kept off the rims, and so far off an apex
    // that a step inward does not come out on the other side.
    const f64 off = f64_min(2.0 * s.error / height, 0.25);
    const f64 off_top = top > 0.0 ? off : f64_min(off + 4.0 * s.error * slant / (height * r), 0.25);
    const f64 share = f64_clamp(fma(rho - r, slope, x.z * height) / (slant * slant), off, 1.0 - off_top);
    const f64 at = fma(share, slope, r);
    s.point = v3(at * cos_phi, at * sin_phi, share * height);
    s.normal = v3(cos_phi * height / slant, sin_phi * height / slant, -slope / slant);
  } else {
    const f64 rim = part == 1u ? r : top;
    const f64 spare = 2.0 * s.error * (1.0 + fabs(slope) / height);
    const f64 keep = f64_max(rim - spare, 0.75 * rim);
    s.point = disk_point(o, d, part == 1u ? 0.0 : height, keep);
    s.normal = v3(0.0, 0.0, part == 1u ? -1.0 : 1.0);
  }
  return s;
}

CLRAY_FN f64 shape_cone_support(const CLRAY_GLOBAL f64* p, vec3 u) {
  const f64 across = sqrt(fma(u.x, u.x, u.y * u.y));
  return f64_max(p[0] * across, fma(p[2], across, p[1] * u.z));
}

CLRAY_FN f64 shape_cone_area(const CLRAY_GLOBAL f64* p) {
  const f64 slope = p[2] - p[0];
  const f64 side = (p[0] + p[2]) * sqrt(fma(slope, slope, p[1] * p[1]));
  return CLRAY_PI * (p[3] != 0.0 ? fma(p[0], p[0], fma(p[2], p[2], side)) : side);
}

CLRAY_FN i32 shape_cone_traits(const CLRAY_GLOBAL f64* p) {
  return p[3] != 0.0 ? CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX : 0;
}

#ifndef __OPENCL_VERSION__
CLRAY_FN i32 shape_cone_facet(const f64* p, u32 part, ShapeFacet* facet) {
  const f64 radius = part == 1u ? p[0] : p[2];
  *facet = shape_facet_of(2u, part == 1u ? -1.0 : 1.0, part == 1u ? 0.0 : p[1], 1u, radius, 0.0);
  return p[3] != 0.0 && (part == 1u || part == 2u) && radius > 0.0;
}
#endif

#endif
