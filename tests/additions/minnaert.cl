// SPDX-License-Identifier: Apache-2.0
// minnaert: a surface model for scripts/test-additions, which adds it to a scratch copy. Minnaert's law with limb
// exponent 2: f = 3 B/(2 pi) mu_i mu_o, p[0] = B. It reflects B mu_i of the light that arrives (integral of f mu_o over
// the hemisphere). Cosine-weighted sampling.
#include "brdf/brdf.h"

CLRAY_FN f64 brdf_minnaert_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)tables;
  return 1.5 * m->p[0] * CLRAY_INV_PI * a.mu_i * a.mu_o;
}

CLRAY_FN f64 brdf_minnaert_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)m;
  (void)tables;
  return a.mu_o * CLRAY_INV_PI;
}

CLRAY_FN BrdfSample brdf_minnaert_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                         f64 u_lobe, f64 u1, f64 u2) {
  (void)tables;
  (void)u_lobe;
  BrdfSample s;
  s.wo = sample_cosine_hemisphere(u1, u2);
  s.pdf = s.wo.z * CLRAY_INV_PI;
  s.weight = 1.5 * m->p[0] * wi.z * s.wo.z;
  s.ok = s.wo.z > 0.0;
  s.delta = 0;
  return s;
}

CLRAY_FN f64 brdf_minnaert_reflectance(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, f64 mu) {
  (void)tables;
  return m->p[0] * mu;
}

CLRAY_FN f64 brdf_minnaert_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                 f64 cos_half_phase) {
  (void)tables;
  (void)cos_half_phase;
  return 1.5 * m->p[0] * CLRAY_INV_PI;
}
