// SPDX-License-Identifier: Apache-2.0
// intensity: the weights w of the light toward each connection, w·tau and w·tau² (tau: path length from the middle of
// the window, in [-1, 1] for one bounce). There wherever hits are connected: delay and spectrometer read it.
#ifndef CLRAY_DETECTOR_INTENSITY_CL
#define CLRAY_DETECTOR_INTENSITY_CL

static void detector_intensity_connect(const Buffers* g, Tally* tally, u32 n, u32 c, const Light* weights, f64 length,
                                       vec3 point) {
  (void)point;
  (void)n;
  const __global ClrayView* view = g->views + tally->view;
  const f64 scale = view->weight_scale, limit = view->weight_limit;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 w = weights->lane[lane];
    if (w == 0.0) continue;
    const u64 at = sum_row(g, CLRAY_FIRST_intensity, 0u, connection_row(g, tally, lane, c));
    i64* own = tally->kept + CLRAY_KEPT_intensity_moments + 3u * (lane * CLRAY_CONNECTIONS + c);
    keep(g, own, at, w, scale, limit);
    if (!CLRAY_COUNT_delay) continue;
    const f64 tau = (length - view->path_middle_m) * view->inv_path_per_m;
    keep(g, own + 1, at + 1u, w * tau, scale, limit);
    keep(g, own + 2, at + 2u, w * tau * tau, scale, limit);
  }
}

static void detector_intensity_flush(const Buffers* g, const Tally* tally, u32 n) {
  (void)n;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
      const u64 at = sum_row(g, CLRAY_FIRST_intensity, 0u, connection_row(g, tally, lane, c));
      hand_over(g, at, tally->kept + CLRAY_KEPT_intensity_moments + 3u * (lane * CLRAY_CONNECTIONS + c), 3u);
    }
  }
}

#endif
