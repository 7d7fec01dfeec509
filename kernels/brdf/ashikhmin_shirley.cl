// SPDX-License-Identifier: Apache-2.0
// Ashikhmin-Shirley, isotropic: diffuse coat and specular peak. p = rho, d, n,
// f0. Ashikhmin & Shirley (2000), "An anisotropic Phong BRDF model", in the d/s
// form of Wetterer, Hill & Jah (2014), s = 1 - d: f = d·R_d + s·R_s with the
// half vector normalised and measured from the normal (c = n·h), s·F = s·f0 +
// (1 - s·f0)(1 - u)^5, u = wo·h, and the specular part without its singularity
// at grazing: (n+1)/(4 pi)·sF·c^(n+1)/((mu_i + mu_o)·max(mu_i, mu_o)). d = 1
// leaves a grazing Fresnel coat. Sampling: the half vector by c^n, or a cosine
// for the diffuse part.
#include "brdf/brdf.h"
#include "brdf/quadrature.h"

/// log(n·h): by the sine near the peak, where n amplifies a rounding of the
/// cosine; never below -745.
CLRAY_FN f64 brdf_ashikhmin_shirley_log_cos(BrdfAngles a) {
  if (a.sin2_half < 0.5) return 0.5 * el_log1p(-a.sin2_half);
  return a.cos_half > 1.0e-300 ? el_log(a.cos_half) : -745.0;
}

/// 1 - (1 - mu/2)^5
CLRAY_FN f64 brdf_ashikhmin_shirley_g(f64 mu) {
  const f64 x = 0.5 * mu;
  return x * fma(x, fma(x, fma(x, x - 5.0, 10.0), -10.0), 5.0);
}

/// s·F for sf0 = s·f0 and 1 - u.
CLRAY_FN f64 brdf_ashikhmin_shirley_fresnel(f64 sf0, f64 v) {
  const f64 v2 = v * v;
  return fma(1.0 - sf0, v2 * v2 * v, sf0);
}

/// s·f0
CLRAY_FN f64 brdf_ashikhmin_shirley_sf0(const CLRAY_GLOBAL ClrayMaterial* m) { return (1.0 - m->p[1]) * m->p[3]; }

/// Diffuse part over g(mu_i)·g(mu_o).
CLRAY_FN f64 brdf_ashikhmin_shirley_diffuse(const CLRAY_GLOBAL ClrayMaterial* m) {
  return m->p[1] * (28.0 / 23.0 * CLRAY_INV_PI) * m->p[0] * (1.0 - brdf_ashikhmin_shirley_sf0(m));
}

/// Probability of sampling the half vector, from rough reflectances of the two
/// parts.
CLRAY_FN f64 brdf_ashikhmin_shirley_share(const CLRAY_GLOBAL ClrayMaterial* m, f64 mu_i) {
  const f64 sf0 = brdf_ashikhmin_shirley_sf0(m);
  const f64 diffuse = m->p[0] * m->p[1] * (1.0 - sf0) * brdf_ashikhmin_shirley_g(mu_i);
  const f64 specular = brdf_ashikhmin_shirley_fresnel(sf0, 1.0 - mu_i);
  if (!(diffuse > 0.0)) return 1.0;
  return f64_min(0.95, f64_max(0.05, specular / (specular + diffuse)));
}

CLRAY_FN f64 brdf_ashikhmin_shirley_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                         BrdfAngles a) {
  (void)tables;
  const f64 n1 = m->p[2] + 1.0;
  const f64 sf = brdf_ashikhmin_shirley_fresnel(brdf_ashikhmin_shirley_sf0(m), 1.0 - f64_min(1.0, 0.5 * a.half_length));
  const f64 peak = 0.25 * CLRAY_INV_PI * n1 * sf * el_exp(n1 * brdf_ashikhmin_shirley_log_cos(a));
  const f64 gg = brdf_ashikhmin_shirley_g(a.mu_i) * brdf_ashikhmin_shirley_g(a.mu_o);
  const f64 specular = peak / (a.mu_i + a.mu_o) / f64_max(a.mu_i, a.mu_o);
  return f64_min(fma(brdf_ashikhmin_shirley_diffuse(m), gg, specular), 1.0e300);
}

CLRAY_FN f64 brdf_ashikhmin_shirley_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                        BrdfAngles a) {
  (void)tables;
  const f64 share = brdf_ashikhmin_shirley_share(m, a.mu_i);
  const f64 n = m->p[2];
  // (n+1)/(2 pi)·c^n over half vectors, 1/(4u) from half vectors to directions
  const f64 half_vector =
      a.half_length > 0.0 ? el_exp(n * brdf_ashikhmin_shirley_log_cos(a)) * (n + 1.0) / a.half_length : 0.0;
  return fma(share * 0.25 * CLRAY_INV_PI, half_vector, (1.0 - share) * CLRAY_INV_PI * a.mu_o);
}

CLRAY_FN BrdfSample brdf_ashikhmin_shirley_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                                  vec3 wi, f64 u_lobe, f64 u1, f64 u2) {
  BrdfSample s;
  s.weight = 0.0;
  s.pdf = 0.0;
  s.ok = 0;
  s.delta = 0;
  if (u_lobe < brdf_ashikhmin_shirley_share(m, wi.z)) {
    const f64 log_c = el_log(u1) / (m->p[2] + 1.0);
    const f64 sin_h = sqrt(-el_expm1(2.0 * log_c));
    f64 sine, cosine;
    el_sincos(2.0 * CLRAY_PI * u2, &sine, &cosine);
    const vec3 h = v3(sin_h * cosine, sin_h * sine, el_exp(log_c));
    s.wo = v3_unit(v3_fma(2.0 * v3_dot(wi, h), h, v3_neg(wi)));
  } else {
    s.wo = sample_cosine_hemisphere(u1, u2);
  }
  if (!(s.wo.z > 0.0)) return s;
  const BrdfAngles a = brdf_angles(v3(0.0, 0.0, 1.0), wi, s.wo);
  s.pdf = brdf_ashikhmin_shirley_pdf(m, tables, a);
  if (!(s.pdf > 0.0)) return s;
  s.weight = brdf_ashikhmin_shirley_eval(m, tables, a) * s.wo.z / s.pdf;
  s.ok = 1;
  return s;
}

/// (n+1)·sF/(8 pi u) for the peak, by c <= 1 and mu_o <= max, and the diffuse
/// part with g <= 31/32. Below u = 1e-3 (forward scattering within 0.06
/// degrees) it stays at that of u = 1e-3 and may be exceeded.
CLRAY_FN f64 brdf_ashikhmin_shirley_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                          f64 cos_half_phase) {
  (void)tables;
  const f64 u = f64_min(1.0, f64_max(cos_half_phase, 1.0e-3));
  const f64 sf = brdf_ashikhmin_shirley_fresnel(brdf_ashikhmin_shirley_sf0(m), 1.0 - u);
  return fma(0.125 * CLRAY_INV_PI * (m->p[2] + 1.0), sf / u, brdf_ashikhmin_shirley_diffuse(m) * (961.0 / 1024.0));
}

#ifndef __OPENCL_VERSION__
/// Integrals of cos^0 … cos^6 from 0 to the angle with this cosine.
inline void brdf_ashikhmin_shirley_moments(f64 cosine, f64* moment) {
  const f64 sine = sqrt((1.0 - cosine) * (1.0 + cosine));
  f64 power = sine;  // cos^(k-1)·sin
  moment[0] = el_acos(cosine);
  moment[1] = sine;
  for (i32 k = 2; k <= 6; ++k) {
    power *= cosine;
    moment[k] = fma((f64)(k - 1), moment[k - 2], power) / (f64)k;
  }
}

/// Integral over azimuth of sF·mu_o/max(mu, mu_o): a polynomial in cos(phi) on
/// either side of mu_o = mu.
inline f64 brdf_ashikhmin_shirley_azimuth(BrdfHalfVector h, f64 sf0) {
  static const f64 binomial[6] = {1.0, 5.0, 10.0, 10.0, 5.0, 1.0};
  f64 above[7], all[7], fresnel[6];
  brdf_ashikhmin_shirley_moments(h.cos_at(h.mu_i), above);
  brdf_ashikhmin_shirley_moments(h.cos_at(0.0), all);
  // sF = sf0 + (1 - sf0)·(a + b·cos(phi))^5
  const f64 b = -h.sin_i * h.sin_h, a = fma(-h.mu_i, h.cos_h, 1.0);
  f64 power = 1.0 - sf0;
  for (i32 k = 0; k <= 5; ++k, power *= b) fresnel[k] = binomial[k] * power;
  power = 1.0;
  for (i32 k = 5; k >= 0; --k, power *= a) fresnel[k] *= power;
  fresnel[0] += sf0;
  f64 full = 0.0, part = 0.0;
  for (i32 k = 0; k <= 5; ++k) {
    full = fma(fresnel[k], above[k], full);
    part = fma(fresnel[k], fma(h.base, all[k] - above[k], h.slope * (all[k + 1] - above[k + 1])), part);
  }
  return h.mu_i > 0.0 ? full + part / h.mu_i : full;
}

/// The diffuse part integrates to rho·d·(1 - s·f0)·g(mu). The peak is the mean
/// of sF·mu_o/max(mu, mu_o) over half vectors of density (n+1)/(2 pi)·c^n.
inline f64 brdf_ashikhmin_shirley_reflectance(const ClrayMaterial* m, const f64* tables, f64 mu) {
  (void)tables;
  const f64 n = m->p[2], sf0 = brdf_ashikhmin_shirley_sf0(m);
  const BrdfCuts cuts = brdf_lobe_cuts(mu, 1.0 / sqrt(n + 1.0));
  const f64 specular = brdf_integral(cuts, [&](f64 theta) {
    const BrdfHalfVector h(mu, theta);
    const f64 log_c = h.sin_h * h.sin_h < 0.5 ? 0.5 * el_log1p(-h.sin_h * h.sin_h) : el_log(h.cos_h);
    const f64 density = (n + 1.0) * el_exp(n * log_c) * h.sin_h;
    return density < 1.0e-20 ? 0.0 : density * brdf_ashikhmin_shirley_azimuth(h, sf0);
  });
  const f64 diffuse = m->p[0] * m->p[1] * (1.0 - sf0) * brdf_ashikhmin_shirley_g(mu);
  return fma(CLRAY_INV_PI, specular, diffuse);
}
#endif
