// SPDX-License-Identifier: Apache-2.0
// The entry point of exact passes: the visible part of every face in every tile (docs/exact.md). A work-item takes one
// face in one tile or, where `seen` is 1, one lit piece in a tile of an observer's view. Items whose stack is too small
// are noted with the number of fragments that they have done; the host finishes them.
#include "shared/portable.h"
#include "shared/abi.h"
#include "exact/exact_buffers.h"
#include "exact/leaf.cl"

#define CLRAY_ARGUMENT(type, name) type *name,
#define CLRAY_VALUE(type, name) name,
__kernel void clray_exact(CLRAY_EXACT_BUFFERS(CLRAY_ARGUMENT) u32 seen, u32 count) {
  const u32 item = (u32)get_global_id(0);
  if (item >= count) return;
  const Exact g = {CLRAY_EXACT_BUFFERS(CLRAY_VALUE)};
  Fragment stack[CLRAY_EXACT_STACK];
  u32 full;
  const u32 done = exact_item(&g, item, CLRAY_CARRY ? seen : 0u, stack, CLRAY_EXACT_STACK, 0u, &full);
  if (!full) return;
  const u32 at = atomic_inc(unfinished);
  unfinished[1u + 2u * at] = item;
  unfinished[2u + 2u * at] = done;
}

#if CLRAY_TILES
#include "exact/sample.cl"

__kernel void clray_sample(CLRAY_SAMPLE_BUFFERS(CLRAY_ARGUMENT) u32 first, u32 end) {
  const u32 item = first + (u32)get_global_id(0);
  if (item >= end) return;
  const Sampled g = {CLRAY_SAMPLE_BUFFERS(CLRAY_VALUE)};
  sample_item(&g, item);
}
#endif
