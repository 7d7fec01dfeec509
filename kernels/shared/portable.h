// SPDX-License-Identifier: Apache-2.0
// The common subset of OpenCL C 1.2 and C++17 in which kernels/shared, kernels/brdf and kernels/shape are
// written: fixed-size types, address spaces, and a few fp64 operations that both sides round alike
// (+ - * / sqrt fma only, compiled without contraction). In C++ include it inside no namespace.
#ifndef CLRAY_PORTABLE_H
#define CLRAY_PORTABLE_H

#include "shared/constants.h"

#ifdef __OPENCL_VERSION__
typedef double f64;
typedef float f32;
typedef int i32;
typedef uint u32;
typedef long i64;
typedef ulong u64;
#define CLRAY_GLOBAL __global
#define CLRAY_CONST __constant
#define CLRAY_FN static inline
// A function on the way of every ray is no call even where the optimiser is off. There a driver's linker may visit
// every chain of calls of a kernel, and each call on that way doubles their number: 1.5 million of them took it a
// quarter of all the time that a program takes. Functions that return structures stay calls: a simulator does not know
// what marks the memory of the result where such a one is inlined.
#define CLRAY_WAY static inline __attribute__((always_inline))
#define CLRAY_AS_U64(x) as_ulong(x)
#define CLRAY_AS_F64(x) as_double(x)
#else
#include <cmath>
#include <cstdint>
#include <cstring>
typedef double f64;
typedef float f32;
typedef std::int32_t i32;
typedef std::uint32_t u32;
typedef std::int64_t i64;
typedef std::uint64_t u64;
#define CLRAY_GLOBAL
#define CLRAY_CONST static const
#define CLRAY_FN static inline
#define CLRAY_WAY CLRAY_FN
using std::fma;
using std::sqrt;
using std::fabs;
using std::floor;
CLRAY_FN u64 CLRAY_AS_U64(f64 x) {
  u64 bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
CLRAY_FN f64 CLRAY_AS_F64(u64 bits) {
  f64 x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
#endif

CLRAY_FN f64 f64_min(f64 a, f64 b) { return a < b ? a : b; }
CLRAY_FN f64 f64_max(f64 a, f64 b) { return a > b ? a : b; }

/// a·b − c·d to 1.5 ulp (Kahan; Jeannerod, Louvet & Muller 2013): its sign is exact barring underflow.
CLRAY_FN f64 difference_of_products(f64 a, f64 b, f64 c, f64 d) {
  const f64 w = c * d;
  return fma(a, b, -w) + fma(-c, d, w);
}

/// A vector of three fp64 numbers; used in private memory only (never crosses between host and device).
typedef struct vec3 {
  f64 x, y, z;
} vec3;

CLRAY_FN vec3 v3(f64 x, f64 y, f64 z) {
  vec3 r;
  r.x = x;
  r.y = y;
  r.z = z;
  return r;
}
CLRAY_FN vec3 v3_add(vec3 a, vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
CLRAY_FN vec3 v3_sub(vec3 a, vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
CLRAY_FN vec3 v3_neg(vec3 a) { return v3(-a.x, -a.y, -a.z); }
CLRAY_FN vec3 v3_scale(f64 s, vec3 a) { return v3(s * a.x, s * a.y, s * a.z); }
/// a + s·b
CLRAY_FN vec3 v3_fma(f64 s, vec3 b, vec3 a) { return v3(fma(s, b.x, a.x), fma(s, b.y, a.y), fma(s, b.z, a.z)); }
CLRAY_FN f64 v3_dot(vec3 a, vec3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
CLRAY_FN vec3 v3_cross(vec3 a, vec3 b) {
  return v3(difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x));
}
CLRAY_FN f64 v3_length(vec3 a) { return sqrt(v3_dot(a, a)); }
/// a/|a|; a must not be zero.
CLRAY_FN vec3 v3_unit(vec3 a) {
  const f64 l = v3_length(a);
  return v3(a.x / l, a.y / l, a.z / l);
}
/// Loads three consecutive numbers.
CLRAY_FN vec3 v3_load(const CLRAY_GLOBAL f64* p) { return v3(p[0], p[1], p[2]); }

/// Two unit vectors that make a right-handed frame (t, b, n) with the unit vector n
/// (Duff et al. 2017, "Building an orthonormal basis, revisited").
CLRAY_FN void v3_frame(vec3 n, vec3* t, vec3* b) {
  const f64 sign = n.z >= 0.0 ? 1.0 : -1.0;
  const f64 a = -1.0 / (sign + n.z);
  const f64 c = n.x * n.y * a;
  *t = v3(fma(sign * n.x, n.x * a, 1.0), sign * c, -sign * n.x);
  *b = v3(c, fma(n.y, n.y * a, sign), -n.y);
}

#endif
