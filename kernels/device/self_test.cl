// SPDX-License-Identifier: Apache-2.0
// The start-up self-test's kernel: one work-item computes every kind of number the tracer relies on from its own
// inputs; the host knows the answers (host/device/self_test.cpp).
#include "math/atomic64.cl"
#include "shared/elementary.h"
#include "shared/philox.h"

/// `in`: three numbers a, b, c per item. `out`: the bits of CLRAY_SELF_TEST_RESULTS results per item.
/// `sums`: three zeros; every item adds its integers to them.
__kernel void self_test(const __global f64* in, __global u64* out, volatile __global i64* sums, u32 items) {
  const u32 id = (u32)get_global_id(0);
  if (id >= items) {
    return;
  }
  const f64 a = in[3u * id];
  const f64 b = in[3u * id + 1u];
  const f64 c = in[3u * id + 2u];
  __global u64* result = out + CLRAY_SELF_TEST_RESULTS * id;
  result[0] = CLRAY_AS_U64(a * b + c);  // lint: allow product-sum (this must not be fused)
  result[1] = CLRAY_AS_U64(fma(a, b, c));
  result[2] = CLRAY_AS_U64(a / b);
  result[3] = CLRAY_AS_U64(sqrt(fabs(a)));
  const f64 tiny = a * 0x1p-1030;
  result[4] = CLRAY_AS_U64(tiny);
  result[5] = CLRAY_AS_U64(tiny + b * 0x1p-1040);  // lint: allow product-sum (exact or subnormal either way)
  const i64 whole = convert_long_rte(a * 0x1p31);
  result[6] = (u64)whole;
  const u32 counter[4] = {id, (u32)whole, 0x13198a2eu, 0x03707344u};
  u32 random[4];
  philox4x32(0xa4093822u, id, counter, random);
  result[7] = ((u64)random[1] << 32) | random[0];
  result[8] = ((u64)random[3] << 32) | random[2];
  result[9] = CLRAY_AS_U64(el_exp(a));
  result[10] = CLRAY_AS_U64(el_log(fabs(b)));
  f64 sine, cosine;
  el_sincos(c, &sine, &cosine);
  result[11] = CLRAY_AS_U64(sine);
  result[12] = CLRAY_AS_U64(cosine);
  atomic_add_i64(sums, whole);
  atomic_add_i64(sums + 1, -1);
  atomic_add_i64(sums + 2, (i64)0x00000000ffffffff);
}
