// SPDX-License-Identifier: Apache-2.0
// The entry point of every pass: reads as the pipeline. A work-item carries a few consecutive points of one replicate
// of one view (and pixel) through the stages, bounce by bounce, and adds its sums at the end.
#include "shared/portable.h"
#include "shared/abi.h"
#include "shared/elementary.h"
#include "math/accumulate.cl"
#include "math/sobol.cl"
#include "math/sobol_place.cl"
#include "math/strata.cl"
#include "brdf/brdf.h"
#include "generated/brdf_all.inc"
#include "brdf/dispatch.cl"
#include "shape/shape.h"
#include "generated/shape_all.inc"
#include "shape/dispatch.cl"
#include "generated/walk_all.inc"
#include "stage/state.cl"
#include "stage/generate.cl"
#include "stage/intersect.cl"
#include "stage/material.cl"
#include "stage/record.cl"
#include "stage/gather.cl"
#include "stage/shade.cl"
#include "stage/scatter.cl"
#include "stage/path.cl"
#include "stage/packet.cl"
#include "stage/packet_points.cl"
#include "stage/packet_item.cl"

#if !CLRAY_PACKET
/// Finds the view, pixel, replicate and part that work-item `item` stands for, of `parts` parts.
static u32 place_item(const Buffers* g, const __global u32* asked, u64 item, u32 parts, Tally* tally) {
  const u32 replicates = g->pass->replicates;
  const u64 pixels = (u64)g->pass->width * g->pass->height;
#if CLRAY_PLACED
  tally->replicate = (u32)(item % max(replicates, 1u));
  item /= max(replicates, 1u);
  const u32 part = (u32)(item % max(parts, 1u));
  item /= max(parts, 1u);
#else
  u32 part = (u32)(item % max(parts, 1u));
  // Points whose indices differ only in their high bits are neighbours in Sobol's first dimension. With its bits
  // reversed, the part gives such points to one work-item and to those beside it, so all of them meet the same strip of
  // the beam.
  if ((parts & (parts - 1u)) == 0u) part = parts > 1u ? reverse_bits(part) >> (clz(parts) + 1u) : 0u;
  item /= max(parts, 1u);
  tally->replicate = (u32)(item % max(replicates, 1u));
  item /= max(replicates, 1u);
#endif
  tally->stream = 0u;
  if (CLRAY_PIXELS) {
    tally->stream = 1u + (u32)(item % max(pixels, (u64)1));
    item /= max(pixels, (u64)1);
  }
  tally->view = asked[item];
  return part;
}

/// A work-item of rays alone: part `part` of a block of points.
CLRAY_WAY void trace_alone(const Buffers* g, Tally* tally, u32 first_point, u32 points, u32 part, u32 parts) {
  const __global ClrayPass* pass = g->pass;
  const __global ClrayView* view = g->views + tally->view;
  Sampler sampler = {pass->key0 ^ view->key0, pass->key1 ^ view->key1, pass->epoch,
                     tally->replicate,        tally->stream,           0u};
  tally_clear(tally);
  sampler_begin(&sampler, g->directions, first_point + part);
  trace_paths(g, &sampler, tally, first_point, points, part, parts);
}
#endif

/// Runs the work-items first_item … first_item + items - 1 of a block of points, first_point … first_point + points - 1
/// of every replicate. The number of an item stands for its view (a place in `asked`), pixel, replicate and part; the
/// part runs fastest, or the replicate where points are counted by their places (CLRAY_PLACED): items side by side are
/// then neighbours in the beam at each of their points. With packets it stands for view and part only. With n parts,
/// part k is every n-th point of the block from the k-th on, at most `chunk` points.
#define CLRAY_ARGUMENT(type, name) type *name,
#define CLRAY_VALUE(type, name) name,
__kernel void clray_trace(CLRAY_BUFFERS(CLRAY_ARGUMENT) u64 first_item, u32 items, u32 first_point, u32 points,
                          u32 chunk) {
  Buffers g = {CLRAY_BUFFERS(CLRAY_VALUE)};
  const u32 parts = (points + chunk - 1u) / max(chunk, 1u);
  const u32 number = get_global_id(0);
#if CLRAY_GATHER
  __local Gathered gathered;
  const u64 first = first_item + (number - get_local_id(0)), end = first_item + items;
  const u32 view = gather_view(&g, asked, first, min(first + get_local_size(0), end), parts);
  gather_begin(&gathered);
  barrier(CLK_LOCAL_MEM_FENCE);
#endif
  if (number < items) {
    const u64 item = first_item + number;
#if CLRAY_PACKET
    trace_packets(&g, asked[item / max(parts, 1u)], first_point, points, (u32)(item % max(parts, 1u)), chunk);
#else
    Tally tally;
    const u32 part = place_item(&g, asked, item, parts, &tally);
    Buffers own = g;
    own.counters += CLRAY_COUNTERS * tally.view;
    trace_alone(&own, &tally, first_point, points, part, parts);
#if CLRAY_GATHER
    if (view != CLRAY_NO_VIEW)
      gather_add(&gathered, &tally);
    else
#endif
      tally_flush(&own, &tally);
#endif
  }
#if CLRAY_GATHER
  barrier(CLK_LOCAL_MEM_FENCE);
  if (view != CLRAY_NO_VIEW) gather_flush(&g, &gathered, view);
#endif
}
