// SPDX-License-Identifier: Apache-2.0
// Lommel-Seeliger: single scattering in a dark dusty half space, f = albedo/(4 pi)·P/(mu_i + mu_o), with the phase
// function of Henyey & Greenstein (1941). p = albedo, g. The phase angle alpha lies between wi and wo, the scattering
// angle is pi - alpha: P = (1 - g²)/(1 + g² + 2g·cos(alpha))^(3/2), g > 0 scatters forward, g = 0 is isotropic.
// Sampling: the phase function about -wi or a uniform hemisphere, half of each; for g = 0 the hemisphere alone.
#include "brdf/brdf.h"
#include "brdf/quadrature.h"

/// P for h = |wi + wo|, h² = 2 + 2 cos(alpha).
CLRAY_FN f64 brdf_lommel_seeliger_phase(f64 g, f64 h) {
  // 1 + g² + 2g·cos(alpha) = (1 - |g|)² + |g|·(2 + 2 cos(alpha) or 2 - 2 cos(alpha)): no cancellation at the peak
  const f64 size = fabs(g), gap = 1.0 - size;
  const f64 x = fma(gap, gap, size * (g > 0.0 ? h * h : f64_max(0.0, fma(-h, h, 4.0))));
  return gap * (1.0 + size) / (x * sqrt(x));
}

CLRAY_FN f64 brdf_lommel_seeliger_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                       BrdfAngles a) {
  (void)tables;
  const f64 phase = brdf_lommel_seeliger_phase(m->p[1], a.half_length);
  return f64_min(m->p[0] * 0.25 * CLRAY_INV_PI * phase / (a.mu_i + a.mu_o), 1.0e300);
}

CLRAY_FN f64 brdf_lommel_seeliger_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                      BrdfAngles a) {
  (void)tables;
  if (m->p[1] == 0.0) return 0.5 * CLRAY_INV_PI;
  const f64 phase = brdf_lommel_seeliger_phase(m->p[1], a.half_length);
  return fma(0.125 * CLRAY_INV_PI, phase, 0.25 * CLRAY_INV_PI);
}

CLRAY_FN BrdfSample brdf_lommel_seeliger_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                                vec3 wi, f64 u_lobe, f64 u1, f64 u2) {
  BrdfSample s;
  const f64 g = m->p[1];
  f64 sine, cosine;
  s.weight = 0.0;
  s.pdf = 0.0;
  s.ok = 0;
  s.delta = 0;
  el_sincos(2.0 * CLRAY_PI * u2, &sine, &cosine);
  if (g == 0.0 || u_lobe < 0.5) {
    const f64 r = sqrt(u1 * (2.0 - u1));
    s.wo = v3(r * cosine, r * sine, 1.0 - u1);
  } else {
    // Inverse of the cumulated phase function, expanded so that g = 0 is no special case.
    const f64 t = fma(2.0, u1, -1.0), d = fma(g, t, 1.0), g2 = g * g;
    const f64 top = fma(0.5 * g2 * g, fma(t, t, -1.0), fma(g2, t, fma(0.5 * g, fma(t, t, 3.0), t)));
    const f64 c = f64_max(-1.0, f64_min(1.0, top / (d * d)));
    const f64 r = sqrt((1.0 - c) * (1.0 + c));
    vec3 x, y;
    v3_frame(wi, &x, &y);
    s.wo = v3_unit(v3_fma(r * cosine, x, v3_fma(r * sine, y, v3_scale(-c, wi))));
  }
  if (!(s.wo.z > 0.0)) return s;
  const BrdfAngles a = brdf_angles(v3(0.0, 0.0, 1.0), wi, s.wo);
  s.pdf = brdf_lommel_seeliger_pdf(m, tables, a);
  s.weight = brdf_lommel_seeliger_eval(m, tables, a) * s.wo.z / s.pdf;
  s.ok = 1;
  return s;
}

/// albedo·P/(4 pi), as mu_o <= mu_i + mu_o.
CLRAY_FN f64 brdf_lommel_seeliger_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                        f64 cos_half_phase) {
  (void)tables;
  return m->p[0] * 0.25 * CLRAY_INV_PI * brdf_lommel_seeliger_phase(m->p[1], 2.0 * cos_half_phase);
}

#ifndef __OPENCL_VERSION__
/// Complete elliptic integral of the second kind for the complementary parameter m1 in (0, 1], by the
/// arithmetic-geometric mean (Abramowitz & Stegun 17.6).
inline f64 brdf_lommel_seeliger_elliptic(f64 m1) {
  f64 a = 1.0, b = sqrt(m1), power = 0.5, sum = 0.5 * (1.0 - m1);
  for (i32 k = 0; k < 12 && fabs(a - b) > 1.0e-16 * a; ++k) {
    const f64 c = 0.5 * (a - b), mean = 0.5 * (a + b);
    b = sqrt(a * b);
    a = mean;
    power *= 2.0;
    sum = fma(power * c, c, sum);
  }
  return 0.5 * CLRAY_PI / a * (1.0 - sum);
}

/// g = 0: albedo/2·(1 - mu·log(1 + 1/mu)). Else the azimuth's integral is 4E(k)/((a - b)·sqrt(a + b)), a and b the
/// constant and the size of the azimuth's cosine in 1 + g² + 2g·cos(alpha); the elevation is left to quadrature.
inline f64 brdf_lommel_seeliger_reflectance(const ClrayMaterial* m, const f64* tables, f64 mu) {
  (void)tables;
  const f64 g = m->p[1], size = fabs(g), gap = 1.0 - size, right = 0.5 * CLRAY_PI;
  if (g == 0.0) return 0.5 * m->p[0] * (mu > 0.0 ? fma(-mu, el_log1p(1.0 / mu), 1.0) : 1.0);
  const f64 elevation = right - el_acos(f64_min(mu, 1.0));
  BrdfCuts cuts(0.0, right);  // in the elevation of wo
  cuts.add_scales(0.0, f64_max(mu, 1.0e-6));
  cuts.add_scales(g > 0.0 ? 0.0 : elevation, gap);
  return m->p[0] * 0.25 * CLRAY_INV_PI * brdf_integral(cuts, [&](f64 e) {
           f64 nearest, farthest, sine, cosine;
           // half the chord between wo and the peak, at the nearest and the farthest azimuth
           el_sincos(0.5 * (g > 0.0 ? elevation + e : elevation - e), &nearest, &cosine);
           el_sincos(0.5 * (g > 0.0 ? elevation - e : elevation + e), &sine, &farthest);
           el_sincos(e, &sine, &cosine);
           const f64 low = fma(gap, gap, 4.0 * size * nearest * nearest);
           const f64 high = fma(gap, gap, 4.0 * size * farthest * farthest);
           const f64 azimuth =
               4.0 * gap * (1.0 + size) * brdf_lommel_seeliger_elliptic(low / high) / (low * sqrt(high));
           return cosine * azimuth * sine / (mu + sine);
         });
}
#endif
