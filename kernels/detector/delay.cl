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
    accumulate(g->sums, g->wide, sum_row(g, d, CLRAY_DELAY_BINS, row) + bin, w, g->views[tally->view].weight_scale,
               g->views[tally->view].weight_limit, g->counters);
    atomic_inc(g->counts + sum_row(g, d, CLRAY_DELAY_HITS, row) + bin);
    i64* largest = tally->kept + CLRAY_KEPT_delay_largest + (n * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c;
    *largest = max(*largest, (i64)as_uint(convert_float_rtp(w)));
  }
}

static void detector_delay_flush(const Buffers* g, const Tally* tally, u32 n) {
  const u32 d = CLRAY_FIRST_delay + n;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
      const i64 largest = tally->kept[CLRAY_KEPT_delay_largest + (n * CLRAY_LANES + lane) * CLRAY_CONNECTIONS + c];
      if (largest == 0) continue;
      atomic_max(g->counts + sum_row(g, d, CLRAY_DELAY_LARGEST, connection_row(g, tally, lane, c)), (u32)largest);
    }
  }
}

#endif
