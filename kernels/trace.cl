// SPDX-License-Identifier: Apache-2.0
// The entry point of every pass: reads as the pipeline. A work-item carries a few consecutive points of one replicate
// of one view (and pixel) through the stages, bounce by bounce, and adds its sums at the end.
#include "shared/portable.h"
#include "shared/abi.h"
#include "shared/elementary.h"
#include "math/accumulate.cl"
#include "math/sobol.cl"
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
#include "stage/shade.cl"
#include "stage/scatter.cl"
#include "stage/path.cl"
#include "stage/packet.cl"
#include "stage/packet_points.cl"
#include "stage/packet_item.cl"

/// Runs the work-items first_item … first_item + items - 1 of a block of points, first_point … first_point + points - 1
/// of every replicate. The number of an item stands for its view (a place in `asked`), pixel, replicate and part; the
/// part runs fastest. With packets it stands for view and part only. With n parts, part k is every n-th point of the
/// block from the k-th on, at most `chunk` points.
#define CLRAY_ARGUMENT(type, name) type *name,
#define CLRAY_VALUE(type, name) name,
__kernel void clray_trace(CLRAY_BUFFERS(CLRAY_ARGUMENT) u64 first_item, u32 items, u32 first_point, u32 points,
                          u32 chunk) {
  if (get_global_id(0) >= items) return;
  Buffers g = {CLRAY_BUFFERS(CLRAY_VALUE)};
  const u32 chunks = (points + chunk - 1u) / max(chunk, 1u);
  u64 item = first_item + get_global_id(0);
  u32 part = (u32)(item % max(chunks, 1u));
#if CLRAY_PACKET
  trace_packets(&g, asked[item / max(chunks, 1u)], first_point, points, part, chunk);
#else
  // Points whose indices differ only in their high bits are neighbours in Sobol's first dimension. With its bits
  // reversed, the part gives such points to one work-item and to those beside it, so all of them meet the same strip of
  // the beam.
  if ((chunks & (chunks - 1u)) == 0u) part = chunks > 1u ? reverse_bits(part) >> (clz(chunks) + 1u) : 0u;
  item /= max(chunks, 1u);
  Tally tally;
  tally.replicate = (u32)(item % max(pass->replicates, 1u));
  item /= max(pass->replicates, 1u);
  tally.stream = 0u;
  if (CLRAY_PIXELS) {
    const u64 pixels = (u64)pass->width * pass->height;
    tally.stream = 1u + (u32)(item % max(pixels, (u64)1));
    item /= max(pixels, (u64)1);
  }
  tally.view = asked[item];
  g.counters += CLRAY_COUNTERS * tally.view;
  tally_clear(&tally);
  const __global ClrayView* view = views + tally.view;
  Sampler sampler = {pass->key0 ^ view->key0, pass->key1 ^ view->key1, pass->epoch, tally.replicate, tally.stream, 0u};
  sampler_begin(&sampler, directions, first_point + part);
  for (u32 k = part; k < points; k += chunks) {
    sampler.index = first_point + k;
    trace_path(&g, &sampler, &tally);
  }
  tally_flush(&g, &tally);
#endif
}
