// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10, a counter-based random generator: Salmon, Moraes, Dror & Shaw (2011), "Parallel random numbers:
// as easy as 1, 2, 3". Every random number of clray is a function of (seed; what it is for), so any part of a run
// can be redone alone and no order of work matters.
#ifndef CLRAY_PHILOX_H
#define CLRAY_PHILOX_H

#include "shared/portable.h"

/// Four 32-bit numbers from a 64-bit key and a 128-bit counter.
CLRAY_FN void philox4x32(u32 key0, u32 key1, const u32 counter[4], u32 out[4]) {
  u32 c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
  for (i32 round = 0; round < 10; ++round) {
    const u64 p0 = (u64)0xD2511F53u * c0;
    const u64 p1 = (u64)0xCD9E8D57u * c2;
    const u32 n0 = (u32)(p1 >> 32) ^ c1 ^ key0;
    const u32 n2 = (u32)(p0 >> 32) ^ c3 ^ key1;
    c1 = (u32)p1;
    c3 = (u32)p0;
    c0 = n0;
    c2 = n2;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  out[0] = c0;
  out[1] = c1;
  out[2] = c2;
  out[3] = c3;
}

#endif
