// SPDX-License-Identifier: Apache-2.0
// pressure: momentum and angular momentum that light leaves on the body, per component, in units of the share of the
// beam (times the lever scale). Light of share phi hands over phi·d on arrival and takes phi'·d' along when it leaves
// (docs/physics.md, section 4); absorbed light that is re-radiated thermally pushes with 2/3 of its share against the
// normal. Settings: the keys of its row.
#ifndef CLRAY_DETECTOR_PRESSURE_CL
#define CLRAY_DETECTOR_PRESSURE_CL

#define CLRAY_PRESSURE_THERMAL 2u  // key

/// One exchange of momentum `push` (away from the light is along the ray) at a surface.
static void pressure_record(const Buffers* g, Tally* tally, u32 n, u32 lane, const Surface* surface, vec3 push) {
  const f64 scale = g->pass->unit_scale;
  const vec3 lever = v3_scale(g->pass->inv_lever_per_m, v3_sub(surface->point, v3_load(g->pass->reference)));
  const vec3 torque = v3_cross(lever, push);
  const f64 values[6] = {push.x, push.y, push.z, torque.x, torque.y, torque.z};
  const u32 d = CLRAY_FIRST_pressure + n;
  const u64 at = sum_row(g, d, 0u, lane_row(g, tally, lane)) + surface->component * 6u;
#ifdef CLRAY_KEPT_pressure_push
  i64* own =
      tally->kept + CLRAY_KEPT_pressure_push + (n * CLRAY_LANES + lane) * sum_width(g, d, 0u) + surface->component * 6u;
  for (u32 k = 0; k < 6u; ++k) keep(g, own + k, at + k, values[k], scale, CLRAY_UNIT_LIMIT);
#else
  for (u32 k = 0; k < 6u; ++k) accumulate(g->sums, g->wide, at + k, values[k], scale, CLRAY_UNIT_LIMIT, g->counters);
#endif
}

/// Momentum of the light that arrives, less what the reflected light and the heat radiated along the normal take along.
static void detector_pressure_scatter(const Buffers* g, Tally* tally, u32 n, u32 bounce, const Surface* surface,
                                      const Path* path, const Scattering* s) {
  if (CLRAY_SKIP_PUSH && bounce == 0u) return;  // it is solved (docs/exact.md)
  const __global f64* settings = g->settings + g->detectors[CLRAY_FIRST_pressure + n].settings;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 before = s->before.lane[lane];
    vec3 push = v3_fma(-path->throughput.lane[lane], s->out, v3_scale(-before, surface->toward));
    if (settings[CLRAY_PRESSURE_THERMAL] != 0.0) {
      const f64 emissivity = lane_material(g, lane, surface->material)->emissivity;
      const f64 heat = before * (1.0 - surface_reflectance(g, lane, surface)) * emissivity;
      push = v3_fma(-0.66666666666666667 * heat, surface->normal, push);
    }
    pressure_record(g, tally, n, lane, surface, push);
  }
}

static void detector_pressure_flush(const Buffers* g, const Tally* tally, u32 n) {
#ifdef CLRAY_KEPT_pressure_push
  const u32 size = sum_width(g, CLRAY_FIRST_pressure + n, 0u);
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_pressure + n, 0u, lane_row(g, tally, lane));
    hand_over(g, at, tally->kept + CLRAY_KEPT_pressure_push + (n * CLRAY_LANES + lane) * size, size);
  }
#endif
}

#endif
