// SPDX-License-Identifier: Apache-2.0
// One path from its start to its end: generate, then at each surface intersect, shade, scatter, roulette, with the
// scene's detectors looking on (stage/record.cl). Stages and hooks that the scene does not need are empty.
#ifndef CLRAY_PATH_CL
#define CLRAY_PATH_CL

/// Length of the path's last segment. The first one begins at the plane across the beam through the reference point.
static f64 piece_length(const Buffers* g, const Tally* tally, u32 bounce, vec3 from, vec3 to) {
  if (bounce > 0u) return v3_length(v3_sub(to, from));
  return -v3_dot(v3_load(g->views[tally->view].toward), v3_sub(to, v3_load(g->pass->reference)));
}

/// Follows a path from its start; `met`: whether its first ray hits anything, and then `surface` is what.
static void follow_path(const Buffers* g, Sampler* sampler, Tally* tally, Path* path, Ray ray, i32 met,
                        Surface* surface) {
  Hit hit;
  ++tally->started;
  const u32 last = CLRAY_SCATTER ? g->pass->max_bounces : 1u;
  for (u32 bounce = 0; bounce <= last; ++bounce) {
    if (!met) {
      ++tally->escaped;
      if (bounce > 0u) record_escape(g, tally, path, shade_mirror(g, tally, path, &ray, surface));
      return;
    }
    const vec3 before = surface->point;
    if (bounce > 0u) *surface = stage_surface(g, &ray, &hit);
    if (bounce == last) break;
    path->length += piece_length(g, tally, bounce, before, surface->point);
    record_hit(g, tally, bounce, surface, path);
    stage_shade(g, tally, bounce, surface, path);
    if (!CLRAY_SCATTER) break;
    Scattering scattering = stage_scatter(g, sampler, bounce, surface, path, &ray);
    const i32 lives = stage_roulette(bounce, path, &scattering);
    record_scatter(g, tally, bounce, surface, path, &scattering);
    if (!lives) {
      ++tally->killed;
      return;
    }
    met = stage_intersect(g, &ray, tally->view, &hit);
  }
  ++tally->capped;
  record_end(g, tally, path);
}

static void trace_path(const Buffers* g, Sampler* sampler, Tally* tally) {
  Path path;
  Hit hit;
  Surface surface;
  const Ray ray = stage_generate(g, sampler, tally, &path);
  const i32 met = stage_intersect(g, &ray, tally->view, &hit);
  if (met) surface = stage_surface(g, &ray, &hit);
  follow_path(g, sampler, tally, &path, ray, met, &surface);
}

#endif
