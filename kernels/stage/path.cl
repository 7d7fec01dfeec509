// SPDX-License-Identifier: Apache-2.0
// One path from its start to its end: the four stages in their order, bounce by bounce. What the scene does not need
// (connections, scattering, energy books, pressure, mirrors) is not compiled.
#ifndef CLRAY_PATH_CL
#define CLRAY_PATH_CL

#if CLRAY_PRESSURE
/// Momentum of the light that arrives, less what the reflected light (throughput after[lane] toward `out`) and the
/// heat radiated back along the normal take along.
static void path_pressure(const Buffers *g, Tally *tally, const Surface *surface, const f64 *before, const f64 *after,
                          vec3 out) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    vec3 push = v3_fma(-after[lane], out, v3_scale(-before[lane], surface->toward));
#if CLRAY_THERMAL
    const __global ClrayMaterial *m = lane_material(g, lane, surface->material);
    const f64 reflectance = surface->lit ? lane_reflectance(g, m, surface->mu) : 0.0;
    const f64 heat = before[lane] * (1.0 - reflectance) * m->emissivity;
    push = v3_fma(-0.66666666666666667 * heat, surface->normal, push);
#endif
    detector_pressure_record(g, tally, lane, surface, push);
  }
}
#endif

#if CLRAY_ENERGY
static void path_absorbed(const Buffers *g, Tally *tally, const Surface *surface, const Path *path) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const __global ClrayMaterial *m = lane_material(g, lane, surface->material);
    const f64 reflectance = surface->lit ? lane_reflectance(g, m, surface->mu) : 0.0;
    record_book(g, tally, lane, CLRAY_BOOK_ABSORBED, path->throughput[lane] * (1.0 - reflectance));
  }
}
#endif

/// The path left the body for good: mirrors reach a connection through its cone, everything enters the books.
static void path_escape(const Buffers *g, Tally *tally, const Path *path, const Ray *ray, const Surface *last,
                        u32 bounce) {
  ++tally->escaped;
  if (bounce == 0u) return;
#if CLRAY_ENERGY
  record_books(g, tally, CLRAY_BOOK_REFLECTED, path->throughput);
#endif
#if CLRAY_DELTA && CLRAY_CONNECT
  if (!path->delta) return;
  i32 connected = 0;
  for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
    const __global ClrayConnection *connection = g->connections + tally->view * CLRAY_CONNECTIONS + c;
    const vec3 o = v3_load(connection->direction);
    const vec3 chord = v3_sub(ray->d, o);
    if (connection->acceptance_chord2 > 0.0) connected = 1;
    if (!(v3_dot(chord, chord) <= connection->acceptance_chord2)) continue;
    f64 weights[CLRAY_LANES];
    for (u32 lane = 0; lane < CLRAY_LANES; ++lane)
      weights[lane] = path->throughput[lane] * connection->inv_solid_angle;
    stage_record(g, tally, c, weights, path->length - v3_dot(v3_sub(last->point, v3_load(g->pass->reference)), o));
  }
#if CLRAY_ENERGY
  if (!connected) record_books(g, tally, CLRAY_BOOK_UNCONNECTED, path->throughput);
#endif
#endif
}

static void trace_path(const Buffers *g, Sampler *sampler, Tally *tally) {
  Path path;
  Surface surface;
  Ray ray = stage_generate(g, sampler, tally, &path);
  const vec3 reference = v3_load(g->pass->reference);
  surface.point = ray.o;
  ++tally->started;
  for (u32 bounce = 0; bounce <= CLRAY_MAX_BOUNCES; ++bounce) {
    const vec3 before = surface.point;
    if (!stage_intersect(g, &ray, tally->view, &surface)) {
      path_escape(g, tally, &path, &ray, &surface, bounce);
      return;
    }
    if (bounce == CLRAY_MAX_BOUNCES) break;
    path.length += bounce == 0u ? -v3_dot(v3_load(g->views[tally->view].toward), v3_sub(surface.point, reference))
                                : v3_length(v3_sub(surface.point, before));
#if CLRAY_PIXELS
    if (bounce == 0u) ++tally->covered;
#endif
#if CLRAY_CONNECT
    for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
      const __global ClrayConnection *connection = g->connections + tally->view * CLRAY_CONNECTIONS + c;
      f64 weights[CLRAY_LANES];
      if (!stage_shade(g, &surface, &path, tally->view, bounce, c, weights)) continue;
      const f64 out = v3_dot(v3_load(connection->direction), v3_sub(surface.point, reference));
      stage_record(g, tally, c, weights, path.length - out);
    }
#endif
#if CLRAY_SCATTER
    f64 carried[CLRAY_LANES], gain[CLRAY_LANES], roulette;
    for (u32 lane = 0; lane < CLRAY_LANES; ++lane) carried[lane] = path.throughput[lane];
#if CLRAY_ENERGY
    if (bounce == 0u) record_books(g, tally, CLRAY_BOOK_INCIDENT, carried);
    path_absorbed(g, tally, &surface, &path);
#endif
    const i32 goes_on = stage_scatter(g, sampler, bounce, &surface, &path, &ray, &roulette);
    const i32 lives = goes_on && stage_roulette(bounce, roulette, &path, gain);
    if (!lives) {
      for (u32 lane = 0; lane < CLRAY_LANES; ++lane) path.throughput[lane] = 0.0;
    }
#if CLRAY_PRESSURE
    path_pressure(g, tally, &surface, carried, path.throughput, ray.d);
#endif
#if CLRAY_ENERGY
    if (goes_on) record_books(g, tally, CLRAY_BOOK_ROULETTE, gain);
#endif
    if (!lives) {
      ++tally->killed;
      return;
    }
#else
    break;
#endif
  }
  ++tally->capped;
#if CLRAY_ENERGY
  record_books(g, tally, CLRAY_BOOK_TRUNCATED, path.throughput);
#endif
}

#endif
