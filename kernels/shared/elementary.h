// SPDX-License-Identifier: Apache-2.0
// Elementary functions of clray's own, in fp64, bit-identical on every conforming device and host: only + - * / sqrt
// fma floor, comparisons and bit casts. Used by the kernels and by host numbers that reach a device or a stopping
// decision. Angles in rad. Arguments are reduced by Cody & Waite (1980), "Software Manual for the Elementary
// Functions", with fma; polynomials interpolate at Chebyshev nodes in quadruple precision. Largest errors found in
// tests/kernels/elementary_test.cpp, in ulp: exp 1, expm1 2, log 1, log1p 2, pow 2, sincos 1, atan2 2, acos 3.
#ifndef CLRAY_ELEMENTARY_H
#define CLRAY_ELEMENTARY_H

#include "shared/portable.h"

#define EL_INF CLRAY_AS_F64(0x7ff0000000000000UL)
#define EL_NAN CLRAY_AS_F64(0x7ff8000000000000UL)
#define EL_LN2_HI 0.69314718048553914  // 33 bits: times an integer below 2^20 it is exact
#define EL_LN2_LO 7.4406171100123968e-11
#define EL_INV_LN2 1.4426950408889634

/// v·2^k for v near 1 and -1100 <= k <= 1100, rounded once.
CLRAY_FN f64 el_scale(f64 v, i32 k) {
  const i32 half_k = k / 2;
  return v * CLRAY_AS_F64((u64)(half_k + 1023) << 52) * CLRAY_AS_F64((u64)(k - half_k + 1023) << 52);
}

/// e^r - 1 - r + low for |r| <= ln2/2.
CLRAY_FN f64 el_exp_tail(f64 r, f64 low) {
  f64 g = 2.0911229928855294e-09;
  g = fma(g, r, 2.5100376111361421e-08);
  g = fma(g, r, 2.7557282983637385e-07);
  g = fma(g, r, 2.7557268479724004e-06);
  g = fma(g, r, 2.4801587317135435e-05);
  g = fma(g, r, 0.00019841269863040922);
  g = fma(g, r, 0.0013888888888886554);
  g = fma(g, r, 0.008333333333330065);
  g = fma(g, r, 0.041666666666666664);
  g = fma(g, r, 0.16666666666666669);
  g = fma(g, r, 0.5);
  return fma(g, r * r, low);
}

/// x + x_lo = k·ln2 + r + r_lo with |r| <= ln2/2; returns k.
CLRAY_FN i32 el_exp_reduce(f64 x, f64 x_lo, f64* r, f64* r_lo) {
  const f64 k = floor(fma(x, EL_INV_LN2, 0.5));
  const f64 a = fma(-k, EL_LN2_HI, x);
  const f64 b = fma(-k, EL_LN2_LO, a);
  const f64 low = fma(-k, EL_LN2_LO, a - b) + x_lo;
  *r = b + low;
  *r_lo = (b - *r) + low;
  return (i32)k;
}

/// e^(x + x_lo), |x_lo| far below |x|, -746 < x < 710.
CLRAY_FN f64 el_exp_parts(f64 x, f64 x_lo) {
  f64 r, r_lo;
  const i32 k = el_exp_reduce(x, x_lo, &r, &r_lo);
  return el_scale(1.0 + (r + el_exp_tail(r, r_lo)), k);
}

/// e^x.
CLRAY_FN f64 el_exp(f64 x) {
  if (!(x == x)) return x;
  if (x > 709.8) return EL_INF;
  if (x < -745.2) return 0.0;
  return el_exp_parts(x, 0.0);
}

/// e^x - 1, accurate for small x.
CLRAY_FN f64 el_expm1(f64 x) {
  if (!(x == x)) return x;
  if (x > 709.8) return EL_INF;
  if (x < -40.0) return -1.0;
  if (fabs(x) < 5.0e-17) return x;
  f64 r, r_lo;
  const i32 k = el_exp_reduce(x, 0.0, &r, &r_lo);
  const f64 low = el_exp_tail(r, fma(r_lo, r, r_lo));
  if (k == 0) return r + low;
  if (k > 60) return el_scale(1.0 + (r + low), k);
  const f64 one = 1.0 - el_scale(1.0, -k);
  const f64 h = one + r;
  return el_scale(h + (((one - h) + r) + low), k);
}

/// x = 2^k·(1 + f) with 1 + f in [sqrt(1/2), sqrt(2)); x positive and finite. Returns k.
CLRAY_FN i32 el_log_reduce(f64 x, f64* f) {
  i32 k = 0;
  if (x < 2.2250738585072014e-308) {
    x *= 18014398509481984.0;  // 2^54
    k = -54;
  }
  const u64 bits = CLRAY_AS_U64(x);
  // 0x3fe6a09e667f3bcd is sqrt(1/2); adding 1100 to the exponent keeps the difference positive.
  const i32 e = (i32)((bits + (((u64)1100 << 52) - 0x3fe6a09e667f3bcdUL)) >> 52) - 1100;
  *f = CLRAY_AS_F64(bits - ((u64)(i64)e << 52)) - 1.0;
  return k + e;
}

/// k·ln2 + log(1 + f) + c, c tiny.
CLRAY_FN f64 el_log_sum(i32 k, f64 f, f64 c) {
  const f64 s = f / (2.0 + f);
  const f64 z = s * s;
  f64 g = 0.14616576421644387;
  g = fma(g, z, 0.15331711346672997);
  g = fma(g, z, 0.18182889433757515);
  g = fma(g, z, 0.22222211130560726);
  g = fma(g, z, 0.28571428626001427);
  g = fma(g, z, 0.39999999999899449);
  g = fma(g, z, 0.66666666666666696);
  // 2 atanh(s) = f - f²/2 + s·(f²/2 + z·g)
  const f64 low = fma(s, fma(z, g, 0.5 * f * f), fma((f64)k, EL_LN2_LO, c));
  return fma((f64)k, EL_LN2_HI, f - fma(0.5 * f, f, -low));
}

/// Natural logarithm; -inf at 0, NaN below.
CLRAY_FN f64 el_log(f64 x) {
  if (x == 0.0) return -EL_INF;
  if (x < 0.0) return EL_NAN;
  if (!(x < EL_INF)) return x;
  f64 f;
  const i32 k = el_log_reduce(x, &f);
  return el_log_sum(k, f, 0.0);
}

/// log(1 + x), accurate for small x.
CLRAY_FN f64 el_log1p(f64 x) {
  if (x > 1.8e16 || !(x > -1.0)) return x < -1.0 ? EL_NAN : (x == -1.0 ? -EL_INF : el_log(x));
  if (fabs(x) < 5.0e-17) return x;
  if (x > -0.29 && x < 0.41) return el_log_sum(0, x, 0.0);
  const f64 u = 1.0 + x;
  const f64 rest = x >= 1.0 ? 1.0 - (u - x) : x - (u - 1.0);
  f64 f;
  const i32 k = el_log_reduce(u, &f);
  return el_log_sum(k, f, rest / u);
}

/// log(x) as high + low, to about 2^-64; x positive and finite.
CLRAY_FN f64 el_log_parts(f64 x, f64* low) {
  f64 f;
  const f64 k = (f64)el_log_reduce(x, &f);
  const f64 d = 2.0 + f;
  const f64 d_lo = f - (d - 2.0);
  const f64 s = f / d;
  const f64 s_lo = fma(-s, d_lo, fma(-s, d, f)) / d;
  const f64 z = s * s;
  const f64 z_lo = fma(2.0 * s, s_lo, fma(s, s, -z));
  f64 g = 0.06456804803218566;
  g = fma(g, z, 0.066429790438985517);
  g = fma(g, z, 0.076927873884135675);
  g = fma(g, z, 0.090909041239070287);
  g = fma(g, z, 0.11111111135550344);
  g = fma(g, z, 0.14285714285669254);
  g = fma(g, z, 0.20000000000000012);
  // atanh(s) = s + s·b, b = z·(1/3 + z·g)
  const f64 third = 0.33333333333333331;
  const f64 c = fma(z, g, third);
  const f64 c_lo = fma(z, g, third - c) + 1.8503717077085941e-17;
  const f64 b = z * c;
  const f64 b_lo = fma(z, c, -b) + fma(z, c_lo, z_lo * c);
  const f64 a = fma(s, b, s);
  const f64 a_lo = fma(s, b, s - a) + fma(s, b_lo, fma(s_lo, b, s_lo));
  const f64 h = fma(k, EL_LN2_HI, 2.0 * a);
  const f64 l = fma(2.0, a, fma(k, EL_LN2_HI, -h)) + fma(2.0, a_lo, k * EL_LN2_LO);
  const f64 high = h + l;
  *low = (h - high) + l;
  return high;
}

/// x^y for x >= 0 (NaN for x < 0); x^0 = 1^y = 1.
CLRAY_FN f64 el_pow(f64 x, f64 y) {
  if (y == 0.0 || x == 1.0) return 1.0;
  if (!(x == x) || !(y == y) || x < 0.0) return EL_NAN;
  if (x == 0.0) return y > 0.0 ? 0.0 : EL_INF;
  if (x == EL_INF) return y > 0.0 ? EL_INF : 0.0;
  f64 low;
  const f64 high = el_log_parts(x, &low);
  const f64 p = y * high;
  if (p > 710.0) return EL_INF;
  if (p < -746.0) return 0.0;
  return el_exp_parts(p, fma(y, low, fma(y, high, -p)));
}

/// sin(r + r_lo) and cos(r + r_lo) for |r| <= pi/4.
CLRAY_FN void el_sincos_kernel(f64 r, f64 r_lo, f64* s, f64* c) {
  const f64 z = r * r;
  f64 p = -7.5865994688271927e-13;
  p = fma(p, z, 1.6058529961120116e-10);
  p = fma(p, z, -2.5052106221979607e-08);
  p = fma(p, z, 2.7557319219309009e-06);
  p = fma(p, z, -0.00019841269841265027);
  p = fma(p, z, 0.0083333333333333315);
  p = fma(p, z, -0.16666666666666666);
  f64 q = -1.1382490122000279e-11;
  q = fma(q, z, 2.0876144291642197e-09);
  q = fma(q, z, -2.7557317262237481e-07);
  q = fma(q, z, 2.4801587298747373e-05);
  q = fma(q, z, -0.0013888888888887385);
  q = fma(q, z, 0.041666666666666664);
  const f64 w = fma(-0.5, z, 1.0);
  *s = r + fma(p * z, r, fma(-0.5 * z, r_lo, r_lo));
  *c = w + (fma(-0.5, z, 1.0 - w) + fma(q * z, z, -r * r_lo));
}

/// Sine and cosine. Relative accuracy for |x| <= 2^20, absolute 4e-16 for |x| <= 2^30, NaN beyond: reduce whole
/// turns first.
CLRAY_FN void el_sincos(f64 x, f64* s, f64* c) {
  if (!(fabs(x) <= 1073741824.0)) {
    *s = EL_NAN;
    *c = EL_NAN;
    return;
  }
  // pi/2 in parts of 33, 33, 33 and 53 bits: with |k| <= 2^20 the first three products are exact.
  const f64 k = floor(fma(x, 0.63661977236758138, 0.5));
  const f64 a = fma(-k, 1.5707963267341256, x);
  const f64 b = fma(-k, 6.077100506303966e-11, a);
  const f64 bb = b - a;
  const f64 b_lo = (a - (b - bb)) - fma(k, 6.077100506303966e-11, bb);
  const f64 d = fma(-k, 2.0222662487111665e-21, b);
  const f64 dd = d - b;
  const f64 d_lo = ((b - (d - dd)) - fma(k, 2.0222662487111665e-21, dd)) + fma(-k, 8.4784276603689e-32, b_lo);
  const f64 r = d + d_lo;
  f64 sine, cosine;
  el_sincos_kernel(r, (d - r) + d_lo, &sine, &cosine);
  const i32 quadrant = (i32)k & 3;
  const f64 u = quadrant & 1 ? cosine : sine;
  const f64 v = quadrant & 1 ? sine : cosine;
  *s = quadrant & 2 ? -u : (x == 0.0 ? x : u);
  *c = (quadrant + 1) & 2 ? -v : v;
}

/// Angle of a/b for 0 <= a <= b, b > 0, as high + low.
CLRAY_FN f64 el_atan_kernel(f64 a, f64 b, f64* low) {
  // atan(a/b) = atan(t) + atan((a - t·b)/(b + t·a)) with t = 0, 1/2 or 1
  f64 t = 0.0, high = 0.0, base_lo = 0.0;
  if (a > 0.75 * b) {
    t = 1.0;
    high = 0.78539816339744828;
    base_lo = 3.061616997868383e-17;
  } else if (a > 0.24 * b) {
    t = 0.5;
    high = 0.46364760900080609;
    base_lo = 2.2698777452961687e-17;
  }
  const f64 x = fma(-t, b, a) / fma(t, a, b);
  const f64 z = x * x;
  f64 p = -0.041034266985419496;
  p = fma(p, z, 0.057529943904780285);
  p = fma(p, z, -0.066586874146977434);
  p = fma(p, z, 0.076920178772373851);
  p = fma(p, z, -0.090909028749694157);
  p = fma(p, z, 0.11111111035986847);
  p = fma(p, z, -0.14285714285258511);
  p = fma(p, z, 0.19999999999998933);
  p = fma(p, z, -0.33333333333333331);
  const f64 rest = fma(p * z, x, base_lo);
  if (t == 0.0) {
    *low = rest;
    return x;
  }
  const f64 sum = high + x;
  *low = ((high - sum) + x) + rest;
  return sum;
}

/// Angle of the point (x, y), in [-pi, pi]; signs of zeros count.
CLRAY_FN f64 el_atan2(f64 y, f64 x) {
  if (!(x == x) || !(y == y)) return EL_NAN;
  f64 ax = fabs(x), ay = fabs(y);
  if (ax == EL_INF || ay == EL_INF) {  // the corners stand for the infinite directions
    ax = ax == EL_INF ? 1.0 : 0.0;
    ay = ay == EL_INF ? 1.0 : 0.0;
  }
  const f64 largest = f64_max(ax, ay);
  if (largest > 1.0e300) {
    ax *= 9.5367431640625e-07;  // 2^-20
    ay *= 9.5367431640625e-07;
  } else if (largest < 1.0e-280) {
    ax *= 5.192296858534828e+33;  // 2^112
    ay *= 5.192296858534828e+33;
  }
  const i32 swap = ay > ax;
  f64 low = 0.0, high = 0.0;
  if (largest > 0.0) high = el_atan_kernel(swap ? ax : ay, swap ? ay : ax, &low);
  // The angle is base ± (high + low), base 0, pi/2 or pi.
  const i32 left = (i32)(CLRAY_AS_U64(x) >> 63);
  const f64 sign = swap != left ? -1.0 : 1.0;
  const f64 base = swap ? 1.5707963267948966 : (left ? 3.1415926535897931 : 0.0);
  const f64 base_lo = swap ? 6.123233995736766e-17 : (left ? 1.2246467991473532e-16 : 0.0);
  const f64 sum = fma(sign, high, base);
  const f64 rest = base > 0.0 ? fma(sign, high, base - sum) : 0.0;
  const f64 angle = sum + (rest + fma(sign, low, base_lo));
  return CLRAY_AS_U64(y) >> 63 ? -angle : angle;
}

/// Angle in [0, pi] whose cosine is x, accurate near ±1 too; NaN outside [-1, 1].
CLRAY_FN f64 el_acos(f64 x) {
  if (!(fabs(x) <= 1.0)) return EL_NAN;
  return 2.0 * el_atan2(sqrt(1.0 - x), sqrt(1.0 + x));
}

/// A direction about +z with density cos(theta)/pi, from u1, u2 in [0, 1).
CLRAY_FN vec3 sample_cosine_hemisphere(f64 u1, f64 u2) {
  f64 s, c;
  el_sincos(2.0 * CLRAY_PI * u2, &s, &c);
  const f64 r = sqrt(u1);
  return v3(r * c, r * s, sqrt(1.0 - u1));
}

#endif
