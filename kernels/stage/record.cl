// SPDX-License-Identifier: Apache-2.0
// Stage 4, record: adds weights to totals, moments and detectors, as integers. Sums that every ray of a work-item
// shares are kept in the item (Tally) and added once at its end.
#ifndef CLRAY_RECORD_CL
#define CLRAY_RECORD_CL

/// Slot of a view, lane and connection; every detector's arrays are [slot][replicate][…].
static u64 record_slot(const Tally *tally, u32 lane, u32 c) {
  return ((u64)tally->view * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c;
}

static u64 record_row(const Buffers *g, const Tally *tally, u32 lane, u32 c) {
  return record_slot(tally, lane, c) * g->pass->replicates + tally->replicate;
}

/// Row of a view and lane, for what is not recorded per connection.
static u64 view_row(const Buffers *g, const Tally *tally, u32 lane) {
  return ((u64)tally->view * CLRAY_LANES + lane) * g->pass->replicates + tally->replicate;
}

/// Adds to a sum that the item keeps; what is too large for it goes straight to the second accumulator.
static void tally_add(const Buffers *g, i64 *own, u64 at, f64 value, f64 scale, f64 limit) {
  i64 wide;
  *own += to_fixed(value, scale, limit, &wide, g->counters);
#if CLRAY_WIDE
  if (wide != 0) atomic_add_i64(g->wide + at, wide);
#endif
}

static void add_nonzero(volatile __global i64 *sums, u64 at, i64 value) {
  if (value != 0) atomic_add_i64(sums + at, value);
}

#include "generated/detector_all.inc"

#if CLRAY_BEAM && CLRAY_CONNECT
/// Weights toward connection c that took a path of `length` (m, relative to the reference point).
static void stage_record(const Buffers *g, Tally *tally, u32 c, const f64 *weights, f64 length) {
  const f64 scale = g->pass->weight_scale, limit = g->pass->weight_limit;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 w = weights[lane];
    if (w == 0.0) continue;
    const u32 own = lane * CLRAY_CONNECTIONS + c;
    const u64 at = g->pass->totals + 3u * record_row(g, tally, lane, c);
    i64 *sums = tally->totals + 3u * own;
    tally_add(g, sums, at, w, scale, limit);
#if CLRAY_DELAYS
    const f64 tau = (length - g->pass->path_middle_m) * g->pass->inv_path_per_m;
    tally_add(g, sums + 1, at + 1u, w * tau, scale, limit);
    tally_add(g, sums + 2, at + 2u, w * tau * tau, scale, limit);
    tally->largest[own] = max(tally->largest[own], as_uint(convert_float_rtp(w)));
    detector_delay_record(g, tally, c, lane, w, length);
#endif
  }
}
#endif

#if CLRAY_PIXELS
static void stage_record(const Buffers *g, Tally *tally, u32 c, const f64 *weights, f64 length) {
  (void)c;
  (void)length;
  const u64 pixels = (u64)g->pass->width * g->pass->height;
  const u64 pixel = tally->stream - 1u;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = g->pass->pixels + view_row(g, tally, lane) * pixels + pixel;
    tally_add(g, tally->totals + lane, at, weights[lane], g->pass->weight_scale, g->pass->weight_limit);
  }
}
#endif

#if CLRAY_ENERGY
/// Enters a share of the incident energy of one lane in a book.
static void record_book(const Buffers *g, Tally *tally, u32 lane, u32 book, f64 share) {
  const u64 at = g->pass->books + view_row(g, tally, lane) * CLRAY_BOOKS + book;
  tally_add(g, tally->books + lane * CLRAY_BOOKS + book, at, share, g->pass->unit_scale, CLRAY_UNIT_LIMIT);
}
static void record_books(const Buffers *g, Tally *tally, u32 book, const f64 *shares) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) record_book(g, tally, lane, book, shares[lane]);
}
#endif

static void tally_clear(Tally *tally) {
  tally->started = tally->escaped = tally->killed = tally->capped = 0u;
#if CLRAY_BEAM
  for (u32 k = 0; k < CLRAY_LANES * CLRAY_CONNECTIONS * 3u; ++k) tally->totals[k] = 0;
  for (u32 k = 0; k < CLRAY_LANES * CLRAY_CONNECTIONS; ++k) tally->largest[k] = 0u;
#endif
#if CLRAY_PIXELS
  tally->covered = 0u;
  for (u32 k = 0; k < CLRAY_LANES; ++k) tally->totals[k] = 0;
#endif
#if CLRAY_ENERGY
  for (u32 k = 0; k < CLRAY_LANES * CLRAY_BOOKS; ++k) tally->books[k] = 0;
#endif
#if CLRAY_PRESSURE_PRIVATE
  for (u32 k = 0; k < CLRAY_LANES * CLRAY_COMPONENTS * 6u; ++k) tally->pressure[k] = 0;
#endif
}

/// Adds what the item kept to the pass's sums.
static void tally_flush(const Buffers *g, const Tally *tally) {
#if CLRAY_BEAM && CLRAY_CONNECT
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
      const u32 own = lane * CLRAY_CONNECTIONS + c;
      const u64 row = record_row(g, tally, lane, c);
      for (u32 k = 0; k < 3u; ++k) add_nonzero(g->sums, g->pass->totals + 3u * row + k, tally->totals[3u * own + k]);
#if CLRAY_DELAYS
      if (tally->largest[own]) detector_delay_flush(g, c, row, tally->largest[own]);
#endif
    }
  }
#endif
#if CLRAY_PIXELS
  const u64 pixels = (u64)g->pass->width * g->pass->height;
  const u64 pixel = tally->stream - 1u;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 row = view_row(g, tally, lane);
    add_nonzero(g->sums, g->pass->pixels + row * pixels + pixel, tally->totals[lane]);
  }
  if (tally->covered) atomic_add(g->hits + (u64)tally->view * pixels + pixel, tally->covered);
#endif
#if CLRAY_ENERGY
  for (u32 k = 0; k < CLRAY_LANES * CLRAY_BOOKS; ++k) {
    const u64 row = view_row(g, tally, k / CLRAY_BOOKS);
    add_nonzero(g->sums, g->pass->books + row * CLRAY_BOOKS + k % CLRAY_BOOKS, tally->books[k]);
  }
#endif
#if CLRAY_PRESSURE_PRIVATE
  detector_pressure_flush(g, tally);
#endif
  add_nonzero(g->counters, CLRAY_COUNT_STARTED, tally->started);
  add_nonzero(g->counters, CLRAY_COUNT_ESCAPED, tally->escaped);
  add_nonzero(g->counters, CLRAY_COUNT_KILLED, tally->killed);
  add_nonzero(g->counters, CLRAY_COUNT_CAPPED, tally->capped);
}

#endif
