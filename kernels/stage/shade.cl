// SPDX-License-Identifier: Apache-2.0
// Stage 3, shade and connect: what a lit surface, or a mirror that the path left, sends toward each connection. Weights
// are f·mu_o per unit of light arriving along the path: the light of a beam element dA·mu_i is already in the share of
// the beam that the ray stands for (docs/physics.md, section 1).
#ifndef CLRAY_SHADE_CL
#define CLRAY_SHADE_CL

CLRAY_FN const __global ClrayConnection* connection_of(const Buffers* g, const Tally* tally, u32 c) {
  return g->connections + tally->view * CLRAY_CONNECTIONS + c;
}

/// Path length from a point to a connection in direction o, relative to the reference point.
CLRAY_FN f64 length_toward(const Buffers* g, vec3 point, vec3 o) {
  return v3_dot(o, v3_sub(point, v3_load(g->pass->reference)));
}

/// Whether a lit surface faces direction o.
CLRAY_FN i32 faces(const Surface* surface, vec3 o) {
  return surface->lit && surface->mu > 0.0 && v3_dot(surface->normal, o) > 0.0;
}

/// Whether something hides connection c from a surface that faces it. On the first bounce of a monostatic view what is
/// lit is seen: no shadow ray.
CLRAY_WAY i32 hides(const Buffers* g, const Surface* surface, const Path* path, u32 view, u32 bounce, u32 c,
                    const __global ClrayConnection* connection) {
  if (!CLRAY_SHADOW || !(connection->shadow || bounce > 0u)) return 0;
  if (CLRAY_PACKET && path->known && bounce == 0u && c < CLRAY_HIDDEN) return (path->hidden >> c) & 1u;
  return shadowed(g, surface, view, v3_load(connection->direction));
}

/// Weights toward connection c, per lane: 0 when the surface does not see it.
CLRAY_WAY i32 shade(const Buffers* g, const Surface* surface, const Path* path, u32 view, u32 bounce, u32 c,
                    const __global ClrayConnection* connection, Light* weights) {
  const vec3 o = v3_load(connection->direction);
  if (!faces(surface, o)) return 0;
  const BrdfAngles angles = brdf_angles(surface->normal, surface->toward, o);
  if (hides(g, surface, path, view, bounce, c, connection)) return 0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 f = brdf_eval(lane_material(g, lane, surface->material), g->tables, angles);
    weights->lane[lane] = path->throughput.lane[lane] * (f * angles.mu_o);
  }
  return 1;
}

/// Whether what the first surface of a path sends counts elsewhere: by rays from pixels, or solved (docs/exact.md).
/// What curved shapes send, and faces that they may shade, is not solved.
CLRAY_FN i32 counts_elsewhere(const Buffers* g, u32 view, u32 primitive) {
  if (!CLRAY_SKIP_FIRST) return 0;
  if (!CLRAY_CURVED) return 1;
  return !(g->unsolved[view * g->pass->unsolved_words + (primitive >> 5)] >> (primitive & 31u) & 1u);
}

/// The stage: records the light that each connection receives from a surface.
CLRAY_WAY void stage_shade(const Buffers* g, Tally* tally, u32 bounce, const Surface* surface, const Path* path) {
  if (bounce == 0u && counts_elsewhere(g, tally->view, surface->primitive)) return;
  for (u32 c = 0; CLRAY_CONNECT && c < CLRAY_CONNECTIONS; ++c) {
    const __global ClrayConnection* connection = connection_of(g, tally, c);
    Light weights;
    if (!shade(g, surface, path, tally->view, bounce, c, connection, &weights)) continue;
    const f64 out = length_toward(g, surface->point, v3_load(connection->direction));
    record_connect(g, tally, c, &weights, path->length - out, surface->point);
  }
}

/// Light that leaves the body from a mirror: a connection receives it through its cone. Returns 1 if no connection has
/// a cone.
static u32 shade_mirror(const Buffers* g, Tally* tally, const Path* path, const Ray* ray, const Surface* last) {
  if (!(CLRAY_CONNECT && CLRAY_DELTA && path->delta)) return 0u;
  u32 blind = 1u;
  for (u32 c = 0; c < CLRAY_CONNECTIONS; ++c) {
    const __global ClrayConnection* connection = connection_of(g, tally, c);
    const vec3 o = v3_load(connection->direction);
    const vec3 chord = v3_sub(ray->d, o);
    if (connection->acceptance_chord2 > 0.0) blind = 0u;
    if (!(v3_dot(chord, chord) <= connection->acceptance_chord2)) continue;
    const Light weights = light_scaled(&path->throughput, connection->inv_solid_angle);
    record_connect(g, tally, c, &weights, path->length - length_toward(g, last->point, o), last->point);
  }
  return blind;
}

#endif
