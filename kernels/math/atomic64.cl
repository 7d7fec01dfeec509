// SPDX-License-Identifier: Apache-2.0
// Adding to a 64-bit integer from many work-items. Integer sums are exact, so their order cannot matter.
// Without cl_khr_int64_base_atomics two 32-bit atomics carry: the halves are consistent once the kernel has ended
// (never read the sum in the kernel that adds to it).
#ifndef CLRAY_ATOMIC64_CL
#define CLRAY_ATOMIC64_CL

#include "shared/portable.h"

#ifdef CLRAY_NO_INT64_ATOMICS

#ifdef __ENDIAN_LITTLE__
#define CLRAY_LOW_WORD 0
#else
#define CLRAY_LOW_WORD 1
#endif

CLRAY_FN void atomic_add_i64(volatile __global i64* p, i64 v) {
  volatile __global u32* word = (volatile __global u32*)p;
  const u32 low = (u32)v;
  const u32 before = atomic_add(word + CLRAY_LOW_WORD, low);
  const u32 carry = before + low < low ? 1u : 0u;  // lint: integer
  const u32 high = (u32)((u64)v >> 32) + carry;
  if (high != 0u) {
    atomic_add(word + (1 - CLRAY_LOW_WORD), high);
  }
}

#else

CLRAY_FN void atomic_add_i64(volatile __global i64* p, i64 v) { atom_add(p, v); }

#endif

#endif
