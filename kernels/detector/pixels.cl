// SPDX-License-Identifier: Apache-2.0
// pixels: radiance of every pixel and lane, and how many of its rays meet the body. There in every picture's pass: rgb
// and hyperspectral read it. A work-item has one pixel.
#ifndef CLRAY_DETECTOR_PIXELS_CL
#define CLRAY_DETECTOR_PIXELS_CL

static void detector_pixels_hit(const Buffers* g, Tally* tally, u32 n, u32 bounce, const Surface* surface,
                                const Path* path) {
  (void)g;
  (void)n;
  (void)surface;
  (void)path;
  if (bounce == 0u) ++tally->kept[CLRAY_KEPT_pixels_covered];
}

static void detector_pixels_connect(const Buffers* g, Tally* tally, u32 n, u32 c, const Light* weights, f64 length,
                                    vec3 point) {
  (void)point;
  (void)n;
  (void)c;
  (void)length;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_pixels, 0u, lane_row(g, tally, lane)) + (tally->stream - 1u);
    keep(g, tally->kept + CLRAY_KEPT_pixels_radiance + lane, at, weights->lane[lane],
         g->views[tally->view].weight_scale, g->views[tally->view].weight_limit);
  }
}

static void detector_pixels_flush(const Buffers* g, const Tally* tally, u32 n) {
  (void)n;
  const u32 covered = (u32)tally->kept[CLRAY_KEPT_pixels_covered];
  if (covered) atomic_add(g->counts + sum_row(g, CLRAY_FIRST_pixels, 1u, tally->view) + (tally->stream - 1u), covered);
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_pixels, 0u, lane_row(g, tally, lane)) + (tally->stream - 1u);
    hand_over(g, at, tally->kept + CLRAY_KEPT_pixels_radiance + lane, 1u);
  }
}

#endif
