// SPDX-License-Identifier: Apache-2.0
// Ideal specular reflection. p = reflectance, index, extinction. With index 0 the reflectance is constant, else it is
// Fresnel's for unpolarised light and the complex index (index + i·extinction) against vacuum (Born & Wolf, section
// 14.4). A delta: sampled, never evaluated.
#include "brdf/brdf.h"

/// Fresnel reflectance at incidence cosine mu > 0.
CLRAY_FN f64 brdf_mirror_fresnel(f64 eta, f64 k, f64 mu) {
  const f64 sin2 = (1.0 - mu) * (1.0 + mu);
  // a² - b² and 2ab of the refracted wave's normal component a + ib
  const f64 difference = fma(mu, mu, fma(-k, k, (eta - 1.0) * (eta + 1.0))), product = 2.0 * eta * k;
  const f64 size = sqrt(fma(difference, difference, product * product));
  const f64 a2 = difference > 0.0 ? 0.5 * (size + difference)
                                  : (size > difference ? 0.5 * product * product / (size - difference) : 0.0);
  const f64 t = 2.0 * sqrt(a2) * mu, even = fma(mu, mu, size);
  const f64 s_polarised = fma(-2.0 * sqrt(a2), mu, even) / fma(2.0 * sqrt(a2), mu, even);
  const f64 p = fma(sin2, sin2, mu * mu * size);
  const f64 ratio = p > 0.0 ? fma(-t, sin2, p) / fma(t, sin2, p) : 1.0;
  return f64_min(1.0, f64_max(0.0, 0.5 * s_polarised * (1.0 + ratio)));
}

CLRAY_FN f64 brdf_mirror_reflectance(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, f64 mu) {
  (void)tables;
  if (m->p[1] == 0.0) return m->p[0];
  return mu > 0.0 ? brdf_mirror_fresnel(m->p[1], m->p[2], mu) : 1.0;
}

CLRAY_FN f64 brdf_mirror_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)m;
  (void)tables;
  (void)a;
  return 0.0;
}

CLRAY_FN f64 brdf_mirror_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)m;
  (void)tables;
  (void)a;
  return 0.0;
}

CLRAY_FN BrdfSample brdf_mirror_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                       f64 u_lobe, f64 u1, f64 u2) {
  (void)u_lobe;
  (void)u1;
  (void)u2;
  BrdfSample s;
  s.wo = v3(-wi.x, -wi.y, wi.z);
  s.weight = brdf_mirror_reflectance(m, tables, wi.z);
  s.pdf = 0.0;
  s.ok = wi.z > 0.0;
  s.delta = 1;
  return s;
}

/// The largest reflectance. The caller accounts for the observer's cone.
CLRAY_FN f64 brdf_mirror_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                               f64 cos_half_phase) {
  (void)tables;
  (void)cos_half_phase;
  return m->p[1] == 0.0 ? m->p[0] : 1.0;
}
