// SPDX-License-Identifier: Apache-2.0
// caustics: what pixels receive of the light that meets a mirror first. A picture's own paths start at its pixels and
// connect each surface to the source, which they cannot do through a mirror. Here paths start at the light. Only those
// that meet a mirror first are followed (stage/scatter.cl). What a later surface sends toward the picture's observer is
// added to the pixel in which that surface is seen. Both sets of paths together have all light except that which leaves
// from a mirror. Its powers are `unseen`, in units of the share of the beam.
// Settings, for each view: the picture's axes right and up (3, 3), their coordinates at its left and top edges (m, from
// the body's origin), and pixels per m.
#ifndef CLRAY_DETECTOR_CAUSTICS_CL
#define CLRAY_DETECTOR_CAUSTICS_CL

#define CLRAY_CAUSTICS_RADIANCE 0u
#define CLRAY_CAUSTICS_UNSEEN 1u
#define CLRAY_CAUSTICS_SETTINGS 9u
#define CLRAY_CAUSTICS_POWERS 2u  // by mirrors alone; by a mirror after another surface

static void detector_caustics_connect(const Buffers* g, Tally* tally, u32 n, u32 c, const Light* weights, f64 length,
                                      vec3 point) {
  (void)c;
  (void)length;
  const u32 d = CLRAY_FIRST_caustics + n;
  const __global f64* frame = g->settings + g->detectors[d].settings + CLRAY_CAUSTICS_SETTINGS * tally->view;
  const f64 x = (v3_dot(v3_load(frame), point) - frame[6]) * frame[8];
  const f64 y = (frame[7] - v3_dot(v3_load(frame + 3), point)) * frame[8];
  if (!(x >= 0.0 && x < (f64)g->pass->width && y >= 0.0 && y < (f64)g->pass->height)) return;
  const u32 row = (u32)y, column = (u32)x;
  const u64 pixel = (u64)row * g->pass->width + column;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    if (weights->lane[lane] == 0.0) continue;
    accumulate(g->sums, g->wide, sum_row(g, d, CLRAY_CAUSTICS_RADIANCE, lane_row(g, tally, lane)) + pixel,
               weights->lane[lane], g->views[tally->view].weight_scale, g->views[tally->view].weight_limit,
               g->counters);
  }
}

static void detector_caustics_escape(const Buffers* g, Tally* tally, u32 n, const Path* path, u32 blind) {
  if (!blind) return;
  const u32 power = path->mirrors ? 0u : 1u;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_caustics + n, CLRAY_CAUSTICS_UNSEEN, lane_row(g, tally, lane)) + power;
    keep(g, tally->kept + CLRAY_KEPT_caustics_unseen + lane * CLRAY_CAUSTICS_POWERS + power, at,
         path->throughput.lane[lane], g->pass->unit_scale, CLRAY_UNIT_LIMIT);
  }
}

static void detector_caustics_flush(const Buffers* g, const Tally* tally, u32 n) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_caustics + n, CLRAY_CAUSTICS_UNSEEN, lane_row(g, tally, lane));
    hand_over(g, at, tally->kept + CLRAY_KEPT_caustics_unseen + lane * CLRAY_CAUSTICS_POWERS, CLRAY_CAUSTICS_POWERS);
  }
}

#endif
