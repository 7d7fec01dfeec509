// SPDX-License-Identifier: Apache-2.0
// delay: the histogram of path length, one per slot and replicate. Bins 0 and bins+1 hold what is below and above
// the window. Beside the sums, hits per bin and the largest weight (for the bound of unresolved bins).
#ifndef CLRAY_DETECTOR_DELAY_CL
#define CLRAY_DETECTOR_DELAY_CL

static void detector_delay_record(const Buffers *g, const Tally *tally, u32 c, u32 lane, f64 w, f64 length) {
  for (u32 d = 0; d < CLRAY_DELAYS; ++d) {
    const __global ClrayDelay *delay = g->delays + d * CLRAY_CONNECTIONS + c;
    const f64 x = (length - delay->first_m) * delay->inv_bin_per_m;
    const u32 bins = delay->bins;
    const u32 bin = x < 0.0 ? 0u : (x < (f64)bins ? 1u + (u32)floor(x) : bins + 1u);
    const u64 row = record_row(g, tally, lane, c);
    accumulate(g->sums, g->wide, delay->sums + row * (bins + 2u) + bin, w, g->pass->weight_scale,
               g->pass->weight_limit, g->counters);
    atomic_inc(g->hits + delay->hits + row * (bins + 3u) + 1u + bin);
  }
}

static void detector_delay_flush(const Buffers *g, u32 c, u64 row, u32 largest) {
  for (u32 d = 0; d < CLRAY_DELAYS; ++d) {
    const __global ClrayDelay *delay = g->delays + d * CLRAY_CONNECTIONS + c;
    atomic_max(g->hits + delay->hits + row * (delay->bins + 3u), largest);
  }
}

#endif
