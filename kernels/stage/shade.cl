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
/// Directional reflectance from the material's table: cubic through four neighbours (Lagrange).
static f64 lane_reflectance(const Buffers *g, const __global ClrayMaterial *m, f64 mu) {
  const f64 x = f64_min(f64_max(mu, 0.0), 1.0) * (f64)(CLRAY_REFLECTANCE_NODES - 1);
  const i32 k = min(max((i32)floor(x) - 1, 0), CLRAY_REFLECTANCE_NODES - 4);
  const __global f64 *y = g->tables + m->reflectance + k;
  const f64 s = x - (f64)k;
  const f64 a = s, b = s - 1.0, c = s - 2.0, d = s - 3.0;
  const f64 l0 = -(b * c * d) / 6.0, l1 = (a * c * d) / 2.0, l2 = -(a * b * d) / 2.0, l3 = (a * b * c) / 6.0;
  return fma(l0, y[0], fma(l1, y[1], fma(l2, y[2], l3 * y[3])));
}

/// Chooses where the path goes on: 1 and the ray with the path's throughput after the reflection, or 0 when all that
/// is left is absorbed. Lanes share the direction, drawn for lane 0.
static i32 stage_scatter(const Buffers *g, const Sampler *sampler, u32 bounce, const Surface *surface, Path *path,
                         Ray *ray, f64 *roulette) {
  f64 u[4];
  sampler_draw(sampler, g->directions, bounce + 1u, 0u, 4u, u);
  *roulette = u[3];
  vec3 t, b;
  v3_frame(surface->normal, &t, &b);
  const vec3 wi = v3(v3_dot(surface->toward, t), v3_dot(surface->toward, b), surface->mu);
  const __global ClrayMaterial *first = lane_material(g, 0u, surface->material);
  if (!surface->lit || !(surface->mu > 0.0)) return 0;
  const BrdfSample sample = brdf_sample(first, g->tables, wi, u[0], u[1], u[2]);
  if (!sample.ok) return 0;
  const vec3 wo = v3_unit(v3_fma(sample.wo.x, t, v3_fma(sample.wo.y, b, v3_scale(sample.wo.z, surface->normal))));
  f64 largest = path->throughput[0] *= sample.weight;
#if CLRAY_LANES > 1
  const BrdfAngles angles = brdf_angles(surface->normal, surface->toward, wo);
  for (u32 lane = 1; lane < CLRAY_LANES; ++lane) {
    const __global ClrayMaterial *m = lane_material(g, lane, surface->material);
    const f64 weight = sample.delta ? brdf_sample(m, g->tables, wi, u[0], u[1], u[2]).weight
                                    : brdf_eval(m, g->tables, angles) * angles.mu_o / sample.pdf;
    path->throughput[lane] *= weight;
    largest = f64_max(largest, path->throughput[lane]);
  }
#endif
  path->delta = (u32)sample.delta;
  *ray = ray_from(surface, wo);
  return largest > 0.0;
}

/// Russian roulette on the largest throughput, from the third bounce on: survives with probability q and is raised by
/// 1/q, so the mean stays. Returns whether the path lives; gain[lane] is what it won or lost.
static i32 stage_roulette(u32 bounce, f64 u, Path *path, f64 *gain) {
  f64 largest = 0.0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    largest = f64_max(largest, path->throughput[lane]);
    gain[lane] = 0.0;
  }
  if (bounce < 2u || largest >= 1.0) return 1;
  const f64 q = f64_max(largest, 0.05);
  const i32 lives = u < q;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 before = path->throughput[lane];
    path->throughput[lane] = lives ? before / q : 0.0;
    gain[lane] = path->throughput[lane] - before;
  }
  return lives;
}
#endif

#endif
