// SPDX-License-Identifier: Apache-2.0
// Stage 3, shade: what a lit surface sends toward each connection, and (with bounces, mirrors or radiation pressure)
// where the path goes on. Weights are f·mu_o per unit of light arriving along the path: the light of a beam element
// dA·mu_i is already in the share of the beam that the ray stands for (PHYSICS section 1).
#ifndef CLRAY_SHADE_CL
#define CLRAY_SHADE_CL

static const __global ClrayMaterial *lane_material(const Buffers *g, u32 lane, u32 material) {
  return g->materials + (g->pass->first_lane + lane) * CLRAY_MATERIALS + material;
}

#if CLRAY_CONNECT
/// Weights toward connection `c`, per lane; 0 when the surface does not see it. On the first bounce of a monostatic view
/// what is lit is seen: no shadow ray.
static i32 stage_shade(const Buffers *g, const Surface *surface, const Path *path, u32 view, u32 bounce, u32 c,
                       f64 *weights) {
  const __global ClrayConnection *connection = g->connections + view * CLRAY_CONNECTIONS + c;
  const vec3 o = v3_load(connection->direction);
  if (!surface->lit || !(surface->mu > 0.0) || !(v3_dot(surface->normal, o) > 0.0)) return 0;
  const BrdfAngles angles = brdf_angles(surface->normal, surface->toward, o);
#if CLRAY_SHADOW
  if ((connection->shadow || bounce > 0u) && shadowed(g, surface, view, o)) return 0;
#endif
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 f = brdf_eval(lane_material(g, lane, surface->material), g->tables, angles);
    weights[lane] = path->throughput[lane] * (f * angles.mu_o);
  }
  return 1;
}
#endif

#if CLRAY_SCATTER
/// The largest throughput over the lanes.
static f64 path_largest(const Path *path) {
  f64 largest = 0.0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) largest = f64_max(largest, path->throughput[lane]);
  return largest;
}

/// Directional reflectance from the material's table: linear between nodes that the host set as close as it takes.
static f64 lane_reflectance(const Buffers *g, const __global ClrayMaterial *m, f64 mu) {
  const __global f64 *nodes = g->tables + m->reflectance + 1;
  const u32 count = (u32)nodes[-1];
  u32 low = 0u, high = count - 1u;
  while (high - low > 1u) {
    const u32 middle = (low + high) / 2u;
    if (nodes[middle] <= mu)
      low = middle;
    else
      high = middle;
  }
  const __global f64 *values = nodes + count;
  const f64 share = f64_min(f64_max((mu - nodes[low]) / (nodes[high] - nodes[low]), 0.0), 1.0);
  return fma(share, values[high] - values[low], values[low]);
}

#if CLRAY_LANES > 1
/// Carries products and densities of all lanes through a reflection toward wo, and the throughputs that follow from
/// them. A common power of two keeps both in range over any number of bounces; no throughput depends on it.
static void scatter_lanes(const Buffers *g, const Surface *surface, vec3 wo, f64 hero_pdf, Path *path) {
  const BrdfAngles angles = brdf_angles(surface->normal, surface->toward, wo);
  f64 sum = 0.0, largest = 0.0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const __global ClrayMaterial *m = lane_material(g, lane, surface->material);
    path->product[lane] *= brdf_eval(m, g->tables, angles) * angles.mu_o / hero_pdf;
    path->density[lane] *= brdf_pdf(m, g->tables, angles) / hero_pdf;
    sum += path->density[lane];
    largest = f64_max(largest, path->density[lane]);
  }
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane)
    path->throughput[lane] = path->share * (path->product[lane] / (sum / (f64)CLRAY_LANES));
  if (largest <= CLRAY_TWO_TO_32) return;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    path->product[lane] *= CLRAY_TWO_TO_MINUS_32;
    path->density[lane] *= CLRAY_TWO_TO_MINUS_32;
  }
}
#endif

/// Chooses where the path goes on: 1 and the ray with the path's throughput after the reflection, or 0 when all that
/// is left is absorbed. The lane that samples is chosen by the first bounce's lobe coordinate, whose rest then chooses
/// the lobe: an even choice that stays stratified.
static i32 stage_scatter(const Buffers *g, const Sampler *sampler, u32 bounce, const Surface *surface, Path *path,
                         Ray *ray, f64 *roulette) {
  f64 u[4];
  sampler_draw(sampler, g->directions, bounce + 1u, 0u, 4u, u);
  *roulette = u[3];
  u32 hero = 0u;
#if CLRAY_LANES > 1
  if (bounce == 0u) {
    const f64 x = u[0] * (f64)CLRAY_LANES;
    path->hero = min((u32)x, CLRAY_LANES - 1u);
    u[0] = x - (f64)path->hero;
  }
  hero = path->hero;
#endif
  if (!surface->lit || !(surface->mu > 0.0)) return 0;
  vec3 t, b;
  v3_frame(surface->normal, &t, &b);
  const vec3 wi = v3(v3_dot(surface->toward, t), v3_dot(surface->toward, b), surface->mu);
  const BrdfSample sample =
      brdf_sample(lane_material(g, hero, surface->material), g->tables, wi, u[0], u[1], u[2]);
  if (!sample.ok) return 0;
  const vec3 wo = v3_unit(v3_fma(sample.wo.x, t, v3_fma(sample.wo.y, b, v3_scale(sample.wo.z, surface->normal))));
#if CLRAY_LANES > 1
  scatter_lanes(g, surface, wo, sample.pdf, path);
#else
  path->throughput[0] *= sample.weight;
#endif
  path->delta = (u32)sample.delta;
  *ray = ray_from(surface, wo);
  return path_largest(path) > 0.0;
}

/// Russian roulette, from the third bounce on, on the largest part of its share that the path still carries: it survives
/// with probability q and is raised by 1/q, so the mean stays. The share itself has no say: a path that stands for little
/// of the beam is as likely to go on as any. Returns whether the path lives; gain[lane] is what it won or lost.
static i32 stage_roulette(u32 bounce, f64 u, Path *path, f64 *gain) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) gain[lane] = 0.0;
  const f64 left = path_largest(path) / path->share;
  if (bounce < 2u || left >= 1.0) return 1;
  const f64 q = f64_max(left, 0.05);
  const i32 lives = u < q;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 before = path->throughput[lane];
    path->throughput[lane] = lives ? before / q : 0.0;
    gain[lane] = path->throughput[lane] - before;
#if CLRAY_LANES > 1
    path->product[lane] /= q;
#endif
  }
  return lives;
}
#endif

#endif
