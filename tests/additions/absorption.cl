// SPDX-License-Identifier: Apache-2.0
// absorption: a detector for scripts/test-additions, which adds it to a scratch copy. Light that meets each component
// at a given bounce, and light that each absorbs in all: shares of the beam, so areas in m². A component's numbers lie
// in the order [lane][component].
#ifndef CLRAY_DETECTOR_ABSORPTION_CL
#define CLRAY_DETECTOR_ABSORPTION_CL

#define CLRAY_ABSORPTION_LIT 0u
#define CLRAY_ABSORPTION_ABSORBED 1u
#define CLRAY_ABSORPTION_BOUNCE 0u  // key

static u32 absorption_detector(u32 n) {
  return CLRAY_FIRST_absorption + n;
}

/// Place of a lane's first number among those that the work-item keeps.
static u32 absorption_kept(const Buffers* g, u32 n, u32 sum, u32 lane) {
  const u32 first = sum == CLRAY_ABSORPTION_LIT ? CLRAY_KEPT_absorption_lit : CLRAY_KEPT_absorption_absorbed;
  return first + (n * CLRAY_LANES + lane) * sum_width(g, absorption_detector(n), sum);
}

static void absorption_add(const Buffers* g, Tally* tally, u32 n, u32 sum, u32 lane, u32 component, f64 share) {
  const u64 at = sum_row(g, absorption_detector(n), sum, lane_row(g, tally, lane)) + component;
  keep(g, tally->kept + absorption_kept(g, n, sum, lane) + component, at, share, g->pass->unit_scale, CLRAY_UNIT_LIMIT);
}

static void detector_absorption_hit(const Buffers* g, Tally* tally, u32 n, u32 bounce, const Surface* surface,
                                    const Path* path) {
  const __global f64* settings = g->settings + g->detectors[absorption_detector(n)].settings;
  if ((f64)bounce != settings[CLRAY_ABSORPTION_BOUNCE]) return;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane)
    absorption_add(g, tally, n, CLRAY_ABSORPTION_LIT, lane, surface->component, path->throughput.lane[lane]);
}

static void detector_absorption_scatter(const Buffers* g, Tally* tally, u32 n, u32 bounce, const Surface* surface,
                                        const Path* path, const Scattering* s) {
  (void)bounce;
  (void)path;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 absorbed = s->before.lane[lane] * (1.0 - surface_reflectance(g, lane, surface));
    absorption_add(g, tally, n, CLRAY_ABSORPTION_ABSORBED, lane, surface->component, absorbed);
  }
}

static void detector_absorption_flush(const Buffers* g, const Tally* tally, u32 n) {
  for (u32 sum = 0; sum < 2u; ++sum) {
    for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
      const u64 at = sum_row(g, absorption_detector(n), sum, lane_row(g, tally, lane));
      const i64* own = tally->kept + absorption_kept(g, n, sum, lane);
      hand_over(g, at, own, sum_width(g, absorption_detector(n), sum));
    }
  }
}

#endif
