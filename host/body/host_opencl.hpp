// SPDX-License-Identifier: Apache-2.0
// What the kernels of a pass use of OpenCL C, for the host: included where they are compiled as C++, and nowhere else.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include "shared/portable.h"

#define __kernel static
#define __global
#define CLRAY_STACK 192
#define CLRAY_PACKET 0
#define CLRAY_PLACED 0

inline thread_local std::size_t global_id = 0;
inline std::size_t get_global_id(int) {
  return global_id;
}

template <class T>
T min(T a, T b) {
  return b < a ? b : a;
}
template <class T>
T max(T a, T b) {
  return a < b ? b : a;
}
inline u32 clz(u32 x) {
  u32 zeros = 32;
  for (; x != 0; x >>= 1) --zeros;
  return zeros;
}
inline u32 as_uint(f32 x) {
  u32 bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline f32 as_float(u32 bits) {
  f32 x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
inline f32 convert_float_rtp(f64 x) {
  const f32 near = static_cast<f32>(x);
  return static_cast<f64>(near) < x ? std::nextafterf(near, HUGE_VALF) : near;
}
/// The host keeps the rounding mode it starts with: to nearest, ties to even.
inline i64 convert_long_rte(f64 x) {
  return std::llrint(x);
}

// One work-item at a time: plain sums.
inline void atom_add(volatile i64* p, i64 value) {
  *p = static_cast<i64>(static_cast<u64>(*p) + static_cast<u64>(value));
}
inline u32 atomic_add(volatile u32* p, u32 value) {
  const u32 before = *p;
  *p = before + value;
  return before;
}
inline void atomic_inc(volatile u32* p) {
  *p = *p + 1u;
}
inline void atomic_max(volatile u32* p, u32 value) {
  if (value > *p) *p = value;
}
