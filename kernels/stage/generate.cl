// SPDX-License-Identifier: Apache-2.0
// Stage 1, generate: a primary ray of a view. The rays of a beam fill the rectangle that bounds the body across the
// direction to the source, or those strata of it that the body can be in (host/beam/strata.hpp). The rays of a
// picture fill their pixel.
#ifndef CLRAY_GENERATE_CL
#define CLRAY_GENERATE_CL

/// A path that stands for this share of the beam or pixel.
static Path path_of(f64 share) {
  Path path;
  path.length = 0.0;
  path.share = share;
  path.throughput = light_even(share);
  path.hero = 0u;
  path.product = light_even(1.0);
  path.density = light_even(1.0);
  path.delta = 0u;
  path.mirrors = 0u;
  path.known = 0u;
  path.hidden = 0u;
  return path;
}

/// The ray of a view that starts at (u, v) of its rectangle.
static Ray primary_ray(const __global ClrayView* view, f64 u, f64 v) {
  Ray ray;
  ray.o = v3_fma(u, v3_load(view->edge_u), v3_fma(v, v3_load(view->edge_v), v3_load(view->corner)));
  ray.d = v3_neg(v3_load(view->toward));
  ray.skip_primitive = 0xffffffffu;
  ray.skip_instance = 0u;
  ray.skip_plane = 0u;
  return ray;
}

static Ray stage_generate(const Buffers* g, Sampler* sampler, const Tally* tally, Path* path) {
  const __global ClrayView* view = g->views + tally->view;
  f64 u[2];
  sampler_draw_first(sampler, g->directions, u);
  if (CLRAY_PIXELS) {
    const u32 pixel = tally->stream - 1u;
    const u32 width = g->pass->width;
    u[0] = ((f64)(pixel % max(width, 1u)) + u[0]) / (f64)width;
    u[1] = ((f64)(pixel / max(width, 1u)) + u[1]) / (f64)g->pass->height;
  }
  f64 share = 1.0;
  if (CLRAY_STRATA && view->strips != 0u) share = strata_place(g->strata, view, u);
  *path = path_of(share);
  return primary_ray(view, u[0], u[1]);
}

#endif
