// SPDX-License-Identifier: Apache-2.0
// Sums that do not depend on the order of work: a number w becomes the 64-bit integer rte(w·2^S), and integers add up
// alike in any order. NaN and infinity are counted before the conversion, in which devices differ. A number too large
// for the first accumulator goes to a second one, at scale S - 32; what that scale rounds away goes to the first. A
// number too large for both is counted.
#ifndef CLRAY_ACCUMULATE_CL
#define CLRAY_ACCUMULATE_CL

#include "math/atomic64.cl"

#define CLRAY_WIDE_LIMIT 274877906944.0  // 2^38: with 2^24 contributions a slice the sum stays below 2^62

static void count_event(volatile __global i64* counters, u32 which) { atomic_add_i64(counters + which, 1); }

/// The integer next to x, of two the even one, for |x| <= 2^51: at the size of 1.5·2^52 the last bit of a sum is worth
/// 1 and its integer bits follow one another. A conversion takes ten times as many steps on some devices.
static i64 nearest_integer(f64 x) {
  const f64 shift = 6755399441055744.0;
  return (i64)(CLRAY_AS_U64(x + shift) - CLRAY_AS_U64(shift));
}

/// Splits `value` into an integer for the first (returned) or second (*wide) accumulator.
static i64 to_fixed(f64 value, f64 scale, f64 limit, i64* wide, volatile __global i64* counters) {
  *wide = 0;
  const f64 size = fabs(value);
  if (size <= limit) return nearest_integer(value * scale);
  const f64 scaled = value * (scale * CLRAY_TWO_TO_MINUS_32);
  if (CLRAY_WIDE && fabs(scaled) <= CLRAY_WIDE_LIMIT) {
    *wide = nearest_integer(scaled);
    // What the coarser scale rounds away, exactly, so that nothing is lost.
    return nearest_integer(fma(-(f64)*wide, CLRAY_TWO_TO_32, value * scale));
  }
  count_event(counters, size - size == 0.0 ? CLRAY_COUNT_OVERFLOW : CLRAY_COUNT_NON_FINITE);
  return 0;
}

/// Adds `value` to accumulator `at`.
static void accumulate(volatile __global i64* sums, volatile __global i64* wide_sums, u64 at, f64 value, f64 scale,
                       f64 limit, volatile __global i64* counters) {
  i64 wide;
  const i64 q = to_fixed(value, scale, limit, &wide, counters);
  if (q != 0) atomic_add_i64(sums + at, q);
  if (CLRAY_WIDE && wide != 0) atomic_add_i64(wide_sums + at, wide);
}

#endif
