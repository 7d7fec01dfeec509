// SPDX-License-Identifier: Apache-2.0
// Stage 6, record: each detector of the scene looks at moments of the path and adds to its sums, as integers. A
// detector is one file, detector/<id>.cl, with a function for each hook that its row in detector.def names. This file
// calls these functions and has what they add with. A hook that no detector of the scene has calls nothing.
//   hit      (g, tally, n, bounce, surface, path)        light that a path carries meets a surface
//   connect  (g, tally, n, c, weights, length, point)    light toward connection c from a point, on a path of `length`
//                                                        (m, relative to the reference point)
//   scatter  (g, tally, n, bounce, surface, path, s)     light goes on from a surface, or ends there
//   escape   (g, tally, n, path, blind)                  it leaves the body; blind: from a mirror toward no cone at all
//   end      (g, tally, n, path)                         it is cut off at the last bounce
//   flush    (g, tally, n)                               the work-item ends and hands over what it kept
// n: which detector of its kind. What a work-item keeps lies in tally->kept from CLRAY_KEPT_<id>_<sum> on, in the order
// [n][lane][connection or number].
#ifndef CLRAY_RECORD_CL
#define CLRAY_RECORD_CL

/// Rows of a block: of a view and lane, and of a view, lane and connection; of this replicate.
static u64 lane_row(const Buffers* g, const Tally* tally, u32 lane) {
  return ((u64)tally->view * CLRAY_LANES + lane) * g->pass->replicates + tally->replicate;
}
static u64 connection_row(const Buffers* g, const Tally* tally, u32 lane, u32 c) {
  const u64 slot = ((u64)tally->view * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c;
  return slot * g->pass->replicates + tally->replicate;
}

/// Index of the first number of a row of a detector's sum.
static u64 sum_row(const Buffers* g, u32 detector, u32 sum, u64 row) {
  const __global ClrayBlock* block = g->blocks + g->detectors[detector].first_block + sum;
  return block->offset + row * block->width;
}

/// Numbers in a row of a detector's sum.
static u32 sum_width(const Buffers* g, u32 detector, u32 sum) {
  return g->blocks[g->detectors[detector].first_block + sum].width;
}

/// Adds to a number that the item keeps. What is too large for that goes at once to the second accumulator at `at`.
static void keep(const Buffers* g, i64* own, u64 at, f64 value, f64 scale, f64 limit) {
  i64 wide;
  *own += to_fixed(value, scale, limit, &wide, g->counters);
  if (CLRAY_WIDE && wide != 0) atomic_add_i64(g->wide + at, wide);
}

static void add_nonzero(volatile __global i64* sums, u64 at, i64 value) {
  if (value != 0) atomic_add_i64(sums + at, value);
}

/// Adds `count` kept numbers to the pass's sums from `at` on.
static void hand_over(const Buffers* g, u64 at, const i64* own, u32 count) {
  for (u32 k = 0; k < count; ++k) add_nonzero(g->sums, at + k, own[k]);
}

#include "generated/detector_all.inc"

static void record_hit(const Buffers* g, Tally* tally, u32 bounce, const Surface* surface, const Path* path) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_hit(g, tally, n, bounce, surface, path);
  CLRAY_HOOK_hit(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
}

static void record_connect(const Buffers* g, Tally* tally, u32 c, const Light* weights, f64 length, vec3 point) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_connect(g, tally, n, c, weights, length, point);
  CLRAY_HOOK_connect(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
}

static void record_scatter(const Buffers* g, Tally* tally, u32 bounce, const Surface* surface, const Path* path,
                           const Scattering* s) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_scatter(g, tally, n, bounce, surface, path, s);
  CLRAY_HOOK_scatter(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
}

static void record_escape(const Buffers* g, Tally* tally, const Path* path, u32 blind) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_escape(g, tally, n, path, blind);
  CLRAY_HOOK_escape(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
}

static void record_end(const Buffers* g, Tally* tally, const Path* path) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_end(g, tally, n, path);
  CLRAY_HOOK_end(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
}

static void tally_clear(Tally* tally) {
  tally->started = tally->escaped = tally->killed = tally->capped = 0u;
  for (u32 k = 0; k < CLRAY_KEPT; ++k) tally->kept[k] = 0;
#if CLRAY_HOLD
  for (u32 k = 0; k < CLRAY_HELD_ROWS * CLRAY_HELD_BINS; ++k)
    tally->held[k / CLRAY_HELD_BINS].hits[k % CLRAY_HELD_BINS] = 0u;
#endif
}

/// Adds what the item kept to the pass's sums.
static void tally_flush(const Buffers* g, const Tally* tally) {
#define CLRAY_DETECTOR_CASE(id) \
  for (u32 n = 0; n < CLRAY_COUNT_##id; ++n) detector_##id##_flush(g, tally, n);
  CLRAY_HOOK_flush(CLRAY_DETECTOR_CASE)
#undef CLRAY_DETECTOR_CASE
      add_nonzero(g->counters, CLRAY_COUNT_STARTED, tally->started);
  add_nonzero(g->counters, CLRAY_COUNT_ESCAPED, tally->escaped);
  add_nonzero(g->counters, CLRAY_COUNT_KILLED, tally->killed);
  add_nonzero(g->counters, CLRAY_COUNT_CAPPED, tally->capped);
}

#endif
