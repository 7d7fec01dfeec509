// SPDX-License-Identifier: Apache-2.0
// Quadrature for directional reflectances, on the host alone: 16-point
// Gauss-Legendre over pieces whose ends lie where an integrand has kinks or
// changes scale. Angles in rad. Uses elementary.h, so results do not depend on
// the C library.
#ifndef CLRAY_BRDF_QUADRATURE_H
#define CLRAY_BRDF_QUADRATURE_H
#ifndef __OPENCL_VERSION__

#include "brdf/brdf.h"

/// Integral of f over [a, b].
template <class F>
f64 brdf_gauss(f64 a, f64 b, F f) {
  static const f64 x[8] = {0.98940093499164994, 0.9445750230732326,  0.86563120238783176, 0.755404408355003,
                           0.61787624440264377, 0.45801677765722737, 0.28160355077925892, 0.095012509837637441};
  static const f64 w[8] = {0.027152459411754096, 0.062253523938647894, 0.095158511682492786, 0.12462897125553388,
                           0.14959598881657674,  0.16915651939500254,  0.18260341504492358,  0.1894506104550685};
  const f64 middle = 0.5 * (a + b), half = 0.5 * (b - a);
  f64 sum = 0.0;
  for (i32 k = 0; k < 8; ++k) sum = fma(w[k], f(fma(half, x[k], middle)) + f(fma(-half, x[k], middle)), sum);
  return half * sum;
}

/// Points where an interval is to be cut.
struct BrdfCuts {
  f64 low, high;
  i32 count = 0;
  f64 at[124];

  BrdfCuts(f64 from, f64 to) : low(from), high(to) {}
  void add(f64 x) {
    if (!(x > low && x < high) || count == 124) return;
    i32 k = count++;
    for (; k > 0 && at[k - 1] > x; --k) at[k] = at[k - 1];
    at[k] = x;
  }
  /// x, and x ± scale·4^k across the interval.
  void add_scales(f64 x, f64 scale) {
    add(x);
    for (f64 step = f64_max(scale, 1.0e-9); step < high - low; step *= 4.0) {
      add(x - step);
      add(x + step);
    }
  }
};

/// Integral of f between the ends of `cuts`; square-root behaviour at each cut
/// is smoothed away by x = t²(3 - 2t).
template <class F>
f64 brdf_integral(const BrdfCuts& cuts, F f) {
  f64 sum = 0.0, a = cuts.low;
  for (i32 k = 0; k <= cuts.count; ++k) {
    const f64 b = k < cuts.count ? cuts.at[k] : cuts.high, width = b - a;
    if (width > 0.0)
      sum += width * brdf_gauss(0.0, 1.0, [&](f64 t) {
               return 6.0 * t * (1.0 - t) * f(fma(width, t * t * fma(-2.0, t, 3.0), a));
             });
    a = b;
  }
  return sum;
}

/// A mirror-like lobe: light from elevation mu, half vector h at angle theta
/// from the normal and phi from the plane of incidence.
struct BrdfHalfVector {
  f64 mu_i, sin_i;
  f64 sin_h, cos_h;
  f64 slope, base;  // mu_o = base + slope·cos(phi)

  BrdfHalfVector(f64 mu, f64 theta) : mu_i(mu), sin_i(sqrt((1.0 - mu) * (1.0 + mu))) {
    f64 s, c;
    el_sincos(theta, &sin_h, &cos_h);
    el_sincos(2.0 * theta, &s, &c);
    base = mu * c;
    slope = sin_i * s;
  }
  f64 mu_o(f64 cos_phi) const { return fma(slope, cos_phi, base); }
  /// wi·h
  f64 u(f64 cos_phi) const { return fma(sin_i * sin_h, cos_phi, mu_i * cos_h); }
  /// Where mu_o falls to `level`: the cosine of phi, held to [-1, 1].
  f64 cos_at(f64 level) const {
    if (base + slope <= level) return 1.0;
    return base - slope >= level ? -1.0 : f64_max(-1.0, f64_min(1.0, (level - base) / slope));
  }
  /// Integral over 0 < phi < pi, mu_o > 0, of f(cos_phi), cut where mu_o passes
  /// one of `count` ascending levels.
  template <class F>
  f64 over_azimuth(const f64* levels, i32 count, F f) const {
    f64 sum = 0.0, from = 0.0;
    for (i32 k = count - 1; k >= -1 && from < CLRAY_PI; --k) {
      const f64 to = el_acos(cos_at(k < 0 ? 0.0 : levels[k]));
      if (to > from)
        sum += brdf_gauss(from, to, [&](f64 phi) {
          f64 s, c;
          el_sincos(phi, &s, &c);
          return f(c);
        });
      from = f64_max(from, to);
    }
    return sum;
  }
};

/// The cuts in theta of a lobe of angular width `width`: its own scales, and
/// where the mirrored direction meets the horizon (mu_o = 0) or the elevation
/// of the light (mu_o = mu).
inline BrdfCuts brdf_lobe_cuts(f64 mu, f64 width) {
  const f64 theta_i = el_acos(f64_min(mu, 1.0)), right = 0.5 * CLRAY_PI;
  BrdfCuts cuts(0.0, right);
  for (f64 step = width; step < right; step *= 2.0) cuts.add(step);
  cuts.add_scales(0.5 * (right - theta_i), f64_min(width, f64_max(0.25 * (right - theta_i), 1.0e-4)));
  cuts.add(theta_i);
  // A narrow lobe is zero near the horizon. A wide one bends there on the
  // scale of the light's elevation.
  if (width > 0.02)
    cuts.add_scales(0.5 * (right + theta_i), f64_max(0.25 * (right - theta_i), 1.0e-4));
  else
    cuts.add(0.5 * (right + theta_i));
  return cuts;
}

#endif
#endif
