// SPDX-License-Identifier: Apache-2.0
// Lambert: f = rho/pi. p[0] = rho. Cosine-weighted sampling by the concentric map's polar form.
#include "brdf/brdf.h"

CLRAY_FN f64 brdf_lambert_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)tables;
  (void)a;
  return m->p[0] * CLRAY_INV_PI;
}

CLRAY_FN f64 brdf_lambert_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)m;
  (void)tables;
  return a.mu_o * CLRAY_INV_PI;
}

CLRAY_FN BrdfSample brdf_lambert_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                        f64 u_lobe, f64 u1, f64 u2) {
  (void)tables;
  (void)wi;
  (void)u_lobe;
  BrdfSample s;
  s.wo = sample_cosine_hemisphere(u1, u2);
  s.pdf = s.wo.z * CLRAY_INV_PI;
  s.weight = m->p[0];
  s.ok = s.wo.z > 0.0;
  s.delta = 0;
  return s;
}

CLRAY_FN f64 brdf_lambert_reflectance(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, f64 mu) {
  (void)tables;
  (void)mu;
  return m->p[0];
}

CLRAY_FN f64 brdf_lambert_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                f64 cos_half_phase) {
  (void)tables;
  (void)cos_half_phase;
  return m->p[0] * CLRAY_INV_PI;
}
