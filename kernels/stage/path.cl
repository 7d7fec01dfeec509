// SPDX-License-Identifier: Apache-2.0
// Paths from their start to their end: generate, then at each surface intersect, shade, scatter, roulette, with the
// scene's detectors looking on (stage/record.cl). Stages and hooks that the scene does not need are empty.
#ifndef CLRAY_PATH_CL
#define CLRAY_PATH_CL

/// Length of the path's last segment. The first one begins at the plane across the beam through the reference point.
static f64 piece_length(const Buffers* g, const Tally* tally, u32 bounce, vec3 from, vec3 to) {
  if (bounce > 0u) return v3_length(v3_sub(to, from));
  return -v3_dot(v3_load(g->views[tally->view].toward), v3_sub(to, v3_load(g->pass->reference)));
}

/// What becomes of a path where its ray ends: at `surface`, or, where it met nothing, in the open. `before`: where the
/// ray began, from the second on. Returns whether the path goes on, as `ray`.
CLRAY_WAY i32 pass_surface(const Buffers* g, Sampler* sampler, Tally* tally, u32 bounce, i32 met, vec3 before,
                           Path* path, Ray* ray, Surface* surface) {
  if (!met) {
    ++tally->escaped;
    if (bounce > 0u) record_escape(g, tally, path, shade_mirror(g, tally, path, ray, surface));
    return 0;
  }
  if (!CLRAY_SCATTER || bounce < g->pass->max_bounces) {
    path->length += piece_length(g, tally, bounce, before, surface->point);
    record_hit(g, tally, bounce, surface, path);
    stage_shade(g, tally, bounce, surface, path);
  }
  if (!CLRAY_SCATTER || bounce == g->pass->max_bounces) {
    ++tally->capped;
    record_end(g, tally, path);
    return 0;
  }
  Scattering scattering = stage_scatter(g, sampler, bounce, surface, path, ray);
  const i32 lives = stage_roulette(bounce, path, &scattering);
  record_scatter(g, tally, bounce, surface, path, &scattering);
  if (!lives) ++tally->killed;
  return lives;
}

/// Follows a path from its start. `known`: whether its first ray is traced; then `met` says whether it hits anything,
/// and `surface` what.
CLRAY_WAY void follow_path(const Buffers* g, Sampler* sampler, Tally* tally, Path* path, Ray ray, u32 known, i32 met,
                           Surface* surface) {
  vec3 before = ray.o;
  ++tally->started;
  for (u32 bounce = 0;; ++bounce) {
    if (bounce > 0u || !known) {
      Hit hit;
      met = stage_intersect(g, &ray, tally->view, &hit);
      if (met) *surface = stage_surface(g, &ray, &hit);
    }
    if (!pass_surface(g, sampler, tally, bounce, met, before, path, &ray, surface)) return;
    before = surface->point;
  }
}

/// Traces the paths of a work-item: every `parts`-th point of a block from the part-th on.
CLRAY_WAY void trace_paths(const Buffers* g, Sampler* sampler, Tally* tally, u32 first_point, u32 points, u32 part,
                           u32 parts) {
  for (u32 k = part; k < points; k += parts) {
#if CLRAY_PLACED
    sampler->index = placed_index(sampler, first_point, points, k);
#else
    sampler->index = first_point + k;
#endif
    Path path;
    Surface surface;
    const Ray ray = stage_generate(g, sampler, tally, &path);
    follow_path(g, sampler, tally, &path, ray, 0u, 0, &surface);
  }
}

#endif
