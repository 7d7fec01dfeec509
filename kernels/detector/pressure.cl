// SPDX-License-Identifier: Apache-2.0
// pressure: momentum and angular momentum that light leaves on the body, per component, in units of the share of the
// beam (times the lever scale). Light of share phi hands over phi·d on arrival and takes phi'·d' along when it leaves
// (PHYSICS section 4); absorbed light that is re-radiated thermally pushes with 2/3 of its share against the normal.
#ifndef CLRAY_DETECTOR_PRESSURE_CL
#define CLRAY_DETECTOR_PRESSURE_CL

/// One exchange of momentum `push` (away from the light is along the ray) at a surface.
static void detector_pressure_record(const Buffers *g, Tally *tally, u32 lane, const Surface *surface, vec3 push) {
  const f64 scale = g->pass->unit_scale;
  const vec3 lever = v3_scale(g->pass->inv_lever_per_m, v3_sub(surface->point, v3_load(g->pass->reference)));
  const vec3 torque = v3_cross(lever, push);
  const f64 values[6] = {push.x, push.y, push.z, torque.x, torque.y, torque.z};
  const u64 row = view_row(g, tally, lane);
  const u64 at = g->pass->pressure + (row * CLRAY_COMPONENTS + surface->component) * 6u;
#if CLRAY_PRESSURE_PRIVATE
  i64 *own = tally->pressure + (lane * CLRAY_COMPONENTS + surface->component) * 6u;
  for (u32 k = 0; k < 6u; ++k) tally_add(g, own + k, at + k, values[k], scale, CLRAY_UNIT_LIMIT);
#else
  for (u32 k = 0; k < 6u; ++k) accumulate(g->sums, g->wide, at + k, values[k], scale, CLRAY_UNIT_LIMIT, g->counters);
#endif
}

#if CLRAY_PRESSURE_PRIVATE
static void detector_pressure_flush(const Buffers *g, const Tally *tally) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 row = view_row(g, tally, lane);
    const u64 at = g->pass->pressure + row * CLRAY_COMPONENTS * 6u;
    const i64 *own = tally->pressure + lane * CLRAY_COMPONENTS * 6u;
    for (u32 k = 0; k < CLRAY_COMPONENTS * 6u; ++k) add_nonzero(g->sums, at + k, own[k]);
  }
}
#endif

#endif
