// SPDX-License-Identifier: Apache-2.0
// An isotropic table of f (1/sr) against theta_i, theta_o and phi (rad; phi = 0 on the side of the light). p = scale.
// At `tables + m->table` lie: the counts n_i, n_o, n_phi; the axes theta_i, theta_o (within [0, pi/2]) and phi (within
// [0, pi]), strictly increasing; the values [i][o][phi], finite and >= 0. Linear in the three angles, constant beyond
// the axes. The table's author answers for reciprocity. Sampling: cosine-weighted.
#include "brdf/brdf.h"
#include "brdf/quadrature.h"

/// The cell of x on an axis: the index of its lower end and the weight of its upper end.
CLRAY_FN i32 brdf_tabulated_cell(const CLRAY_GLOBAL f64* axis, i32 count, f64 x, f64* weight) {
  *weight = 0.0;
  if (count < 2 || !(x > axis[0])) return 0;
  if (x >= axis[count - 1]) {
    *weight = 1.0;
    return count - 2;
  }
  i32 low = 0, high = count - 1;
  while (high - low > 1) {
    const i32 middle = (low + high) / 2;
    if (axis[middle] <= x)
      low = middle;
    else
      high = middle;
  }
  *weight = (x - axis[low]) / (axis[high] - axis[low]);
  return low;
}

/// a at weight 0, b at weight 1.
CLRAY_FN f64 brdf_tabulated_mix(f64 a, f64 b, f64 weight) { return fma(weight, b, fma(-weight, a, a)); }

CLRAY_FN f64 brdf_tabulated_value(const CLRAY_GLOBAL f64* t, f64 theta_i, f64 theta_o, f64 phi) {
  const i32 n_i = (i32)t[0], n_o = (i32)t[1], n_phi = (i32)t[2];
  const CLRAY_GLOBAL f64* axis = t + 3;
  f64 w_i, w_o, w_phi;
  const i32 i = brdf_tabulated_cell(axis, n_i, theta_i, &w_i);
  const i32 o = brdf_tabulated_cell(axis + n_i, n_o, theta_o, &w_o);
  const i32 k = brdf_tabulated_cell(axis + n_i + n_o, n_phi, phi, &w_phi);
  const CLRAY_GLOBAL f64* value = axis + n_i + n_o + n_phi;
  f64 over_i[2], over_o[2];
  for (i32 a = 0; a < 2; ++a) {
    const i32 row = i + a < n_i ? i + a : i;
    for (i32 b = 0; b < 2; ++b) {
      const i32 column = o + b < n_o ? o + b : o;
      const CLRAY_GLOBAL f64* v = value + ((i64)row * n_o + column) * n_phi;
      over_o[b] = brdf_tabulated_mix(v[k], v[k + 1 < n_phi ? k + 1 : k], w_phi);
    }
    over_i[a] = brdf_tabulated_mix(over_o[0], over_o[1], w_o);
  }
  return brdf_tabulated_mix(over_i[0], over_i[1], w_i);
}

CLRAY_FN f64 brdf_tabulated_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  const f64 mu_i = f64_min(a.mu_i, 1.0), mu_o = f64_min(a.mu_o, 1.0);
  const f64 sines = sqrt((1.0 - mu_i) * (1.0 + mu_i)) * sqrt((1.0 - mu_o) * (1.0 + mu_o));
  const f64 cos_phi = sines > 0.0 ? fma(-mu_i, mu_o, a.cos_phase) / sines : 1.0;
  const f64 phi = el_acos(f64_max(-1.0, f64_min(1.0, cos_phi)));
  return m->p[0] * brdf_tabulated_value(tables + m->table, el_acos(mu_i), el_acos(mu_o), phi);
}

CLRAY_FN f64 brdf_tabulated_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  (void)m;
  (void)tables;
  return a.mu_o * CLRAY_INV_PI;
}

CLRAY_FN BrdfSample brdf_tabulated_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                          f64 u_lobe, f64 u1, f64 u2) {
  (void)u_lobe;
  BrdfSample s;
  s.wo = sample_cosine_hemisphere(u1, u2);
  s.pdf = s.wo.z * CLRAY_INV_PI;
  s.ok = s.wo.z > 0.0;
  s.weight = s.ok ? CLRAY_PI * brdf_tabulated_eval(m, tables, brdf_angles(v3(0.0, 0.0, 1.0), wi, s.wo)) : 0.0;
  s.delta = 0;
  return s;
}

/// The largest value, as mu_o <= 1.
CLRAY_FN f64 brdf_tabulated_bound(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables,
                                  f64 cos_half_phase) {
  const CLRAY_GLOBAL f64* t = tables + m->table;
  const i64 axes = (i64)t[0] + (i64)t[1] + (i64)t[2], count = (i64)t[0] * (i64)t[1] * (i64)t[2];
  f64 largest = 0.0;
  (void)cos_half_phase;
  for (i64 k = 0; k < count; ++k) largest = f64_max(largest, t[3 + axes + k]);
  return m->p[0] * largest;
}

#ifndef __OPENCL_VERSION__
/// Exact for the interpolant in phi, Gauss-Legendre between the nodes in theta_o.
inline f64 brdf_tabulated_reflectance(const ClrayMaterial* m, const f64* tables, f64 mu) {
  const f64* t = tables + m->table;
  const i32 n_i = (i32)t[0], n_o = (i32)t[1], n_phi = (i32)t[2];
  const f64 *theta_o = t + 3 + n_i, *phi = theta_o + n_o, *value = phi + n_phi;
  f64 w_i;
  const i32 i = brdf_tabulated_cell(t + 3, n_i, el_acos(f64_min(mu, 1.0)), &w_i);
  const i32 j = i + 1 < n_i ? i + 1 : i;
  const auto over_phi = [&](i32 o) {
    const auto at = [&](i32 k) {
      return brdf_tabulated_mix(value[((i64)i * n_o + o) * n_phi + k], value[((i64)j * n_o + o) * n_phi + k], w_i);
    };
    f64 sum = fma(phi[0], at(0), (CLRAY_PI - phi[n_phi - 1]) * at(n_phi - 1));
    for (i32 k = 0; k + 1 < n_phi; ++k) sum = fma(0.5 * (phi[k + 1] - phi[k]), at(k) + at(k + 1), sum);
    return sum;
  };
  // 2·integral of sin·cos from a to b times a value linear from v to w
  const auto over_theta = [](f64 a, f64 b, f64 v, f64 w) {
    if (!(b > a)) return 0.0;
    return brdf_gauss(a, b, [&](f64 theta) {
      f64 s, c;
      el_sincos(2.0 * theta, &s, &c);
      return s * brdf_tabulated_mix(v, w, (theta - a) / (b - a));
    });
  };
  f64 left = over_phi(0);
  f64 sum = over_theta(0.0, theta_o[0], left, left);
  for (i32 o = 1; o < n_o; ++o) {
    const f64 next = over_phi(o);
    sum += over_theta(theta_o[o - 1], theta_o[o], left, next);
    left = next;
  }
  return m->p[0] * (sum + over_theta(theta_o[n_o - 1], 0.5 * CLRAY_PI, left, left));
}

/// Whether the `size` numbers at t are a table as described above.
inline i32 brdf_tabulated_valid(const f64* t, u64 size) {
  if (size < 3) return 0;
  f64 total = 3.0, product = 1.0;
  for (i32 a = 0; a < 3; ++a) {
    if (!(t[a] >= 1.0 && t[a] <= 100000.0) || t[a] != floor(t[a])) return 0;
    total += t[a];
    product *= t[a];
  }
  if (total + product != (f64)size) return 0;
  const f64* axis = t + 3;
  for (i32 a = 0; a < 3; ++a) {
    const i32 n = (i32)t[a];
    // A table in degrees may miss a right angle by a rounding.
    if (!(axis[0] >= 0.0 && axis[n - 1] <= (a < 2 ? 0.5 : 1.0) * CLRAY_PI * (1.0 + 4.0e-16))) return 0;
    for (i32 k = 1; k < n; ++k)
      if (!(axis[k] > axis[k - 1])) return 0;
    axis += n;
  }
  for (u64 k = 0; k < (u64)product; ++k)
    if (!(axis[k] >= 0.0 && axis[k] < EL_INF)) return 0;
  return 1;
}
#endif
