// SPDX-License-Identifier: Apache-2.0
// Stages 4 and 5, scatter and roulette: where the path goes on from a surface, what it then carries, and whether it is
// followed. Both are empty if no path of the scene is followed beyond its first surface.
#ifndef CLRAY_SCATTER_CL
#define CLRAY_SCATTER_CL

/// Carries products and densities of all lanes through a reflection toward wo, and the throughputs that follow from
/// them. A common power of two keeps both in range over any number of bounces; no throughput depends on it.
CLRAY_FN void scatter_lanes(const Buffers* g, const Surface* surface, vec3 wo, f64 hero_pdf, Path* path) {
  const BrdfAngles angles = brdf_angles(surface->normal, surface->toward, wo);
  f64 sum = 0.0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const __global ClrayMaterial* m = lane_material(g, lane, surface->material);
    path->product.lane[lane] *= brdf_eval(m, g->tables, angles) * angles.mu_o / hero_pdf;
    path->density.lane[lane] *= brdf_pdf(m, g->tables, angles) / hero_pdf;
    sum += path->density.lane[lane];
  }
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane)
    path->throughput.lane[lane] = path->share * (path->product.lane[lane] / (sum / (f64)CLRAY_LANES));
  if (light_largest(&path->density) <= CLRAY_TWO_TO_32) return;
  path->product = light_scaled(&path->product, CLRAY_TWO_TO_MINUS_32);
  path->density = light_scaled(&path->density, CLRAY_TWO_TO_MINUS_32);
}

/// Draws a direction for the path and gives it the throughput after the reflection. Returns 0 if all of it is absorbed.
/// The lobe coordinate of the first bounce chooses the lane that samples, and what is left of it chooses the lobe, so
/// that the choice is even and stays stratified.
CLRAY_WAY u32 scatter(const Buffers* g, f64 u[4], u32 bounce, const Surface* surface, Path* path, Ray* ray) {
  if (CLRAY_LANES > 1 && bounce == 0u) {
    const f64 x = u[0] * (f64)CLRAY_LANES;
    path->hero = min((u32)x, CLRAY_LANES - 1u);
    u[0] = x - (f64)path->hero;
  }
  if (!surface->lit || !(surface->mu > 0.0)) return 0u;
  vec3 t, b;
  v3_frame(surface->normal, &t, &b);
  const vec3 wi = v3(v3_dot(surface->toward, t), v3_dot(surface->toward, b), surface->mu);
  const __global ClrayMaterial* hero = lane_material(g, path->hero, surface->material);
  const BrdfSample sample = brdf_sample(hero, g->tables, wi, u[0], u[1], u[2]);
  if (!sample.ok) return 0u;
  const vec3 wo = v3_unit(v3_fma(sample.wo.x, t, v3_fma(sample.wo.y, b, v3_scale(sample.wo.z, surface->normal))));
  if (CLRAY_LANES > 1)
    scatter_lanes(g, surface, wo, sample.pdf, path);
  else
    path->throughput.lane[0] *= sample.weight;
  path->delta = (u32)sample.delta;
  *ray = ray_from(surface, wo);
  return light_largest(&path->throughput) > 0.0;
}

/// The stage: chooses where the path goes on.
static Scattering stage_scatter(const Buffers* g, const Sampler* sampler, u32 bounce, const Surface* surface,
                                Path* path, Ray* ray) {
  Scattering s;
  s.before = path->throughput;
  s.gain = light_even(0.0);
  s.goes_on = 0u;
  s.roulette = 0.0;
  if (CLRAY_SCATTER) {
    f64 u[4];
    sampler_draw(sampler, g->directions, bounce + 1u, 0u, 4u, u);
    s.goes_on = scatter(g, u, bounce, surface, path, ray);
    path->mirrors = (bounce == 0u || path->mirrors) && path->delta;
    if (CLRAY_MIRRORS_FIRST && bounce == 0u && !path->mirrors) s.goes_on = 0u;
    s.roulette = u[3];
  }
  s.out = ray->d;
  return s;
}

/// The stage: Russian roulette, from the third bounce on. The path survives with probability q and is raised by 1/q, so
/// the mean stays. q is what the path still carries (its largest lane) over its share of the beam, so that a path with
/// a small share is as likely to go on as any. Returns whether the path lives; a dead path carries nothing.
static i32 stage_roulette(u32 bounce, Path* path, Scattering* s) {
  if (!CLRAY_SCATTER) return 0;
  const f64 left = light_largest(&path->throughput) / path->share;
  if (s->goes_on && (bounce < 2u || left >= 1.0)) return 1;
  const f64 q = f64_max(left, 0.05);
  const i32 lives = s->goes_on && s->roulette < q;
  const Light before = path->throughput;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    path->throughput.lane[lane] = lives ? before.lane[lane] / q : 0.0;
    if (CLRAY_LANES > 1) path->product.lane[lane] /= q;
  }
  if (s->goes_on) s->gain = light_gain(&path->throughput, &before);
  return lives;
}

#endif
