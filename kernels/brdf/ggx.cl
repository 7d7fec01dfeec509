// SPDX-License-Identifier: Apache-2.0
// Cook & Torrance (1982) microfacets with the GGX distribution of Walter et al.
// (2007), the height-correlated Smith masking of Heitz (2014) and Schlick's
// Fresnel factor. p = roughness (alpha), f0. With L(mu) = sqrt(alpha² + (1 -
// alpha²)·mu²): f = F·D/(2·(mu_o·L(mu_i) + mu_i·L(mu_o))), D =
// alpha²/(pi·(alpha²·cos² + sin²)²) from the sine of the half vector, so that
// alpha = 0.001 loses no digits. Sampling: visible normals by spherical caps
// (Dupuy & Benyoub 2023). One bounce between facets: the reflectance of a rough
// surface stays below f0.
#include "brdf/brdf.h"
#include "brdf/quadrature.h"

CLRAY_FN f64 brdf_ggx_l(f64 alpha, f64 mu) { return sqrt(fma(alpha, alpha, (1.0 - alpha) * (1.0 + alpha) * mu * mu)); }

/// D for cos² and sin² of the half vector's angle.
CLRAY_FN f64 brdf_ggx_d(f64 alpha, f64 cos2, f64 sin2) {
  const f64 x = fma(alpha, cos2, sin2 / alpha);
  return CLRAY_INV_PI / (x * x);
}

/// Schlick's Fresnel factor for u = wo·h.
CLRAY_FN f64 brdf_ggx_fresnel(f64 f0, f64 u) {
  const f64 v = 1.0 - f64_min(u, 1.0), v2 = v * v;
  return fma(1.0 - f0, v2 * v2 * v, f0);
}

CLRAY_FN f64 brdf_ggx_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)tables;
  const f64 alpha = m->p[0];
  const f64 d = brdf_ggx_d(alpha, a.cos_half * a.cos_half, a.sin2_half);
  const f64 masking = fma(a.mu_o, brdf_ggx_l(alpha, a.mu_i), a.mu_i * brdf_ggx_l(alpha, a.mu_o));
  return f64_min(0.5 * brdf_ggx_fresnel(m->p[1], 0.5 * a.half_length) * d / masking, 1.0e300);
}

CLRAY_FN f64 brdf_ggx_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)tables;
  const f64 d = brdf_ggx_d(m->p[0], a.cos_half * a.cos_half, a.sin2_half);
  return 0.5 * d / (a.mu_i + brdf_ggx_l(m->p[0], a.mu_i));
}

CLRAY_FN BrdfSample brdf_ggx_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                    f64 u_lobe, f64 u1, f64 u2) {
  (void)u_lobe;
  BrdfSample s;
  const f64 alpha = m->p[0];
  f64 sine, cosine;
  s.weight = 0.0;
  s.pdf = 0.0;
  s.ok = 0;
  s.delta = 0;
  // A uniform point on the cap of the sphere that the stretched direction sees,
  // then half way and stretched back.
  const vec3 w = v3_unit(v3(alpha * wi.x, alpha * wi.y, wi.z));
  const f64 above = (1.0 - u2) * (1.0 + w.z);  // z of the point plus w.z
  const f64 z = fma(1.0 - u2, 1.0 + w.z, -w.z);
  const f64 r = sqrt(f64_max(0.0, (1.0 - z) * (1.0 + z)));
  el_sincos(2.0 * CLRAY_PI * u1, &sine, &cosine);
  const vec3 h = v3_unit(v3(alpha * fma(r, cosine, w.x), alpha * fma(r, sine, w.y), above));
  s.wo = v3_unit(v3_fma(2.0 * v3_dot(wi, h), h, v3_neg(wi)));
  if (!(s.wo.z > 0.0)) return s;
  const BrdfAngles a = brdf_angles(v3(0.0, 0.0, 1.0), wi, s.wo);
  s.pdf = brdf_ggx_pdf(m, tables, a);
  s.weight = brdf_ggx_eval(m, tables, a) * s.wo.z / s.pdf;
  s.ok = 1;
  return s;
}

/// Twice the value at the peak's centre, F/(4 pi alpha²·max(u, alpha)): covers
/// normals that lean toward wo.
CLRAY_FN f64 brdf_ggx_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, f64 cos_half_phase) {
  (void)tables;
  const f64 alpha = m->p[0], u = f64_min(1.0, f64_max(0.0, cos_half_phase));
  return 0.5 * CLRAY_INV_PI * brdf_ggx_fresnel(m->p[1], u) / (alpha * alpha * f64_max(u, alpha));
}

#ifndef __OPENCL_VERSION__
/// Over half vectors: the mean of F·D·2·mu_o·u/(mu_o·L(mu) + mu·L(mu_o)).
inline f64 brdf_ggx_reflectance(const ClrayMaterial* m, const f64* tables, f64 mu) {
  (void)tables;
  const f64 alpha = m->p[0], l_i = brdf_ggx_l(alpha, mu);
  const BrdfCuts cuts = brdf_lobe_cuts(mu, alpha);
  f64 levels[16];  // the masking bends where mu_o is about alpha or mu
  i32 count = 0;
  for (f64 level = 0.5 * f64_min(alpha, f64_max(mu, 1.0e-5)); level < 0.5; level *= 8.0) levels[count++] = level;
  return 2.0 * brdf_integral(cuts, [&](f64 theta) {
           const BrdfHalfVector h(mu, theta);
           const f64 density = brdf_ggx_d(alpha, h.cos_h * h.cos_h, h.sin_h * h.sin_h) * h.sin_h;
           return density * h.over_azimuth(levels, count, [&](f64 cos_phi) {
             const f64 mu_o = h.mu_o(cos_phi), u = h.u(cos_phi);
             return brdf_ggx_fresnel(m->p[1], u) * 2.0 * mu_o * u / fma(mu_o, l_i, mu * brdf_ggx_l(alpha, mu_o));
           });
         });
}
#endif
