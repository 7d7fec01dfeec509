// SPDX-License-Identifier: Apache-2.0
// delay: the histogram of path length of every connection. Bins 0 and bins+1 hold what is below and above the window.
// Beside the sums, hits per bin and the largest weight (for the bound of unresolved bins).
// Settings: bins; then for each connection the path length where its first bin starts (m, relative to the reference
// point), bins per metre of path, and a bin's width (m).
#ifndef CLRAY_DETECTOR_DELAY_CL
#define CLRAY_DETECTOR_DELAY_CL

#define CLRAY_DELAY_BINS 0u
#define CLRAY_DELAY_LARGEST 1u
#define CLRAY_DELAY_HITS 2u

/// Adds `hits` weights, with the sum `sum`, to a bin.
static void delay_add(const Buffers* g, u32 d, u64 row, u32 bin, i64 sum, u32 hits) {
  add_nonzero(g->sums, sum_row(g, d, CLRAY_DELAY_BINS, row) + bin, sum);
  atomic_add(g->counts + sum_row(g, d, CLRAY_DELAY_HITS, row) + bin, hits);
}

#if CLRAY_HOLD
/// Adds a weight to a bin that waits; one that it displaces is added up.
static void delay_hold(const Buffers* g, u32 d, u64 row, HeldBins* held, u32 bin, i64 sum) {
  const u32 slot = bin % CLRAY_HELD_BINS;
  if (held->hits[slot] != 0u && held->bin[slot] != bin) {
    delay_add(g, d, row, held->bin[slot], held->sum[slot], held->hits[slot]);
    held->hits[slot] = 0u;
  }
  held->bin[slot] = bin;
  held->sum[slot] = (held->hits[slot] != 0u ? held->sum[slot] : 0) + sum;
  ++held->hits[slot];
}
#endif

static void detector_delay_connect(const Buffers* g, Tally* tally, u32 n, u32 c, const Light* weights, f64 length,
                                   vec3 point) {
  (void)point;
  const u32 d = CLRAY_FIRST_delay + n;
  const __global f64* settings = g->settings + g->detectors[d].settings;
  const u32 bins = (u32)settings[0];
  const f64 x = (length - settings[1u + 3u * c]) * settings[2u + 3u * c];
  const u32 bin = x < 0.0 ? 0u : (x < (f64)bins ? 1u + (u32)floor(x) : bins + 1u);
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 w = weights->lane[lane];
    if (w == 0.0) continue;
    const u64 row = connection_row(g, tally, lane, c);
    const u32 own = (n * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c;
    i64 sum = 0;
    keep(g, &sum, sum_row(g, d, CLRAY_DELAY_BINS, row) + bin, w, g->views[tally->view].weight_scale,
         g->views[tally->view].weight_limit);
#if CLRAY_HOLD
    delay_hold(g, d, row, tally->held + own, bin, sum);
#else
    delay_add(g, d, row, bin, sum, 1u);
#endif
    i64* largest = tally->kept + CLRAY_KEPT_delay_largest + own;
    if (!(w <= (f64)as_float((u32)*largest))) *largest = max(*largest, (i64)as_uint(convert_float_rtp(w)));
  }
}

static void detector_delay_flush(const Buffers* g, const Tally* tally, u32 n) {
  const u32 d = CLRAY_FIRST_delay + n;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
      const u32 own = (n * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c;
      const u64 row = connection_row(g, tally, lane, c);
#if CLRAY_HOLD
      const HeldBins* held = tally->held + own;
      for (u32 k = 0; k < CLRAY_HELD_BINS; ++k) {
        if (held->hits[k] != 0u) delay_add(g, d, row, held->bin[k], held->sum[k], held->hits[k]);
      }
#endif
      const i64 largest = tally->kept[CLRAY_KEPT_delay_largest + own];
      if (largest != 0) atomic_max(g->counts + sum_row(g, d, CLRAY_DELAY_LARGEST, row), (u32)largest);
    }
  }
}

#endif
