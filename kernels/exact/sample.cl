// SPDX-License-Identifier: Apache-2.0
// Tiles that are not solved are sampled: a point of each replicate in each tile sees the face in front there. The faces
// of a tile are few, so they are asked one after the other. For an observer elsewhere the point is then carried by its
// face into the beam of the light, where the faces that may shade the tile are asked. What a point brings stands for
// the whole tile.
#ifndef CLRAY_EXACT_SAMPLE_CL
#define CLRAY_EXACT_SAMPLE_CL

#include "exact/bins.cl"
#include "exact/integrals.cl"
#include "shared/philox.h"

/// What the work-items of a sampling read and add to.
typedef struct Sampled {
#define CLRAY_BUFFER(type, name) type* name;
  CLRAY_SAMPLE_BUFFERS(CLRAY_BUFFER)
#undef CLRAY_BUFFER
} Sampled;

#define CLRAY_TOGETHER 8u  // points of a tile that are asked together

/// The points of some replicates in a tile, and what each sees so far.
typedef struct Points {
  f64 x[CLRAY_TOGETHER], y[CLRAY_TOGETHER], depth[CLRAY_TOGETHER];
  i64 order[CLRAY_TOGETHER], face[CLRAY_TOGETHER];  // -1: nothing
} Points;

/// What of a face its points are held against.
typedef struct Outline {
  f64 x[3], y[3], dx[3], dy[3], depth0, slope_x, slope_y;
} Outline;

CLRAY_FN Outline outline_of(const CLRAY_GLOBAL ClrayFace* face) {
  Outline o;
  for (u32 i = 0; i < 3u; ++i) {
    const u32 j = i == 2u ? 0u : i + 1u;
    o.x[i] = face->x[i];
    o.y[i] = face->y[i];
    o.dx[i] = face->x[j] - face->x[i];
    o.dy[i] = face->y[j] - face->y[i];
  }
  o.depth0 = face->depth0;
  o.slope_x = face->slope_x;
  o.slope_y = face->slope_y;
  return o;
}

/// Whether a place lies within a face. Without branches, so that compilers take several points at once.
CLRAY_FN u32 outline_holds(const Outline* o, f64 x, f64 y) {
  const f64 a0 = o->dy[0] * (x - o->x[0]), a1 = o->dy[1] * (x - o->x[1]), a2 = o->dy[2] * (x - o->x[2]);
  const f64 s0 = fma(o->dx[0], y - o->y[0], -a0), s1 = fma(o->dx[1], y - o->y[1], -a1);
  const f64 s2 = fma(o->dx[2], y - o->y[2], -a2);
  return (s0 >= 0.0) & (s1 >= 0.0) & (s2 >= 0.0);
}

CLRAY_FN f64 outline_depth(const Outline* o, f64 x, f64 y) {
  return fma(o->slope_y, y - o->y[0], fma(o->slope_x, x - o->x[0], o->depth0));
}

/// A face shows itself to the points that it is nearest to. Of faces in one place the first in order is seen.
CLRAY_FN void show_face(const CLRAY_GLOBAL ClrayFace* face, u32 own, Points* p) {
  const Outline o = outline_of(face);
  const f64 margin = face->margin;
  const i64 order = (i64)face->order;
  for (u32 k = 0; k < CLRAY_TOGETHER; ++k) {
    const f64 depth = outline_depth(&o, p->x[k], p->y[k]), gap = depth - p->depth[k];
    const u32 alike = (gap >= -margin) & (gap <= margin) & (order < p->order[k]);
    const u32 seen = outline_holds(&o, p->x[k], p->y[k]) & ((gap > margin) | alike);
    p->depth[k] = seen ? depth : p->depth[k];
    p->order[k] = seen ? order : p->order[k];
    p->face[k] = seen ? (i64)own : p->face[k];
  }
}

/// Those points in the beam of the light.
typedef struct LitPoints {
  f64 x[CLRAY_TOGETHER], y[CLRAY_TOGETHER], depth[CLRAY_TOGETHER], margin[CLRAY_TOGETHER];
  i64 order[CLRAY_TOGETHER], own[CLRAY_TOGETHER], dark[CLRAY_TOGETHER];
} LitPoints;

/// A face of that beam shades the points before which it lies. Of faces in one place the first in order is lit, as it
/// is the one that is seen.
CLRAY_FN void shade_points(const CLRAY_GLOBAL ClrayFace* face, u32 own, LitPoints* p) {
  const Outline o = outline_of(face);
  const f64 own_margin = face->margin;
  const i64 order = (i64)face->order;
  for (u32 k = 0; k < CLRAY_TOGETHER; ++k) {
    const f64 gap = outline_depth(&o, p->x[k], p->y[k]) - p->depth[k];
    const f64 margin = own_margin > p->margin[k] ? own_margin : p->margin[k];
    const u32 inside = outline_holds(&o, p->x[k], p->y[k]) & ((i64)own != p->own[k]);
    const u32 alike = (gap >= -margin) & (order < p->order[k]);
    p->dark[k] = (inside & ((gap > margin) | alike)) ? 1 : p->dark[k];
  }
}

/// Of some points of a tile those that see nothing lit see nothing.
static void shade_tile(const Sampled* g, u32 tile, Points* seen) {
  LitPoints p;
  for (u32 k = 0; k < CLRAY_TOGETHER; ++k) {
    const u32 face = seen->face[k] < 0 ? 0u : (u32)seen->face[k];
    const CLRAY_GLOBAL ClrayCarried* carried = g->carried + face;
    p.dark[k] = seen->face[k] < 0 || carried->there == CLRAY_NOT_THERE;
    const CLRAY_GLOBAL ClrayFace* own = g->lit_faces + (p.dark[k] ? 0u : carried->there);
    const f64 dx = seen->x[k] - g->faces[face].x[0], dy = seen->y[k] - g->faces[face].y[0];
    const f64 step_x = fma(carried->xx, dx, carried->xy * dy), step_y = fma(carried->yx, dx, carried->yy * dy);
    p.x[k] = own->x[0] + step_x;
    p.y[k] = own->y[0] + step_y;
    p.depth[k] = fma(own->slope_y, step_y, fma(own->slope_x, step_x, own->depth0));
    p.margin[k] = own->margin;
    p.order[k] = (i64)own->order;
    p.own[k] = (i64)carried->there;
  }
  const u32 first = g->shaded[2u * tile], count = g->shaded[2u * tile + 1u];
  for (u32 k = 0; k < count; ++k) {
    const u32 blocker = g->blockers[first + k];
    shade_points(g->lit_faces + blocker, blocker, &p);
  }
  for (u32 k = 0; k < CLRAY_TOGETHER; ++k) seen->face[k] = p.dark[k] ? -1 : seen->face[k];
}

CLRAY_FN f64 uniform53(u32 high, u32 low) {
  return fma((f64)(high >> 6), 134217728.0, (f64)(low >> 5)) * 1.1102230246251565e-16;
}

/// Adds what a point brings: A and its moments of path length, and its place in each histogram.
static void add_sample(const Sampled* g, u32 own, u32 replicate, f64 x, f64 y, f64 area) {
  const CLRAY_GLOBAL ClrayFace* face = g->faces + own;
  const CLRAY_GLOBAL ClraySampling* s = g->sampling;
  const f64 path = face->path_m + face_path(face, x, y), tau = (path - s->path_middle_m) * s->inv_path_per_m;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const f64 w = g->weights[(u64)own * CLRAY_LANES + lane] * area * face->bin_scale;
    if (w == 0.0) continue;
    volatile CLRAY_GLOBAL i64* row = g->sums + ((u64)lane * s->replicates + replicate) * 3u;
    const i64 q[3] = {convert_long_rte(w), convert_long_rte(w * tau), convert_long_rte(w * tau * tau)};
    for (u32 k = 0; k < 3u; ++k) atomic_add_i64(row + k, q[k]);
    for (u32 n = 0; n < CLRAY_BINNINGS; ++n) {
      const CLRAY_GLOBAL ClrayBinning* b = g->binnings + n;
      const f64 u = (path - b->first_m) * b->per_metre;
      const i64 bin = bin_of((i64)b->bins, u);
      const u64 row = (u64)lane * s->replicates + replicate, width = b->bins + 2u;
      const u64 begin = b->offset * s->replicates + row * width;  // lint: integer
      const u64 at = begin + (u64)(bin + 1);
      atomic_add_i64(g->bins + at, q[0]);
      atomic_inc(g->hits + at);
    }
  }
}

/// The points of CLRAY_TOGETHER replicates in one tile.
static void sample_item(const Sampled* g, u32 item) {
  const CLRAY_GLOBAL ClraySampling* s = g->sampling;
  const u32 groups = max((s->replicates + CLRAY_TOGETHER - 1u) / CLRAY_TOGETHER, 1u);
  const u32 number = item / groups, first = (item - number * groups) * CLRAY_TOGETHER;
  const CLRAY_GLOBAL ClrayTile* tile = g->tiles + number;
  Points p;
  for (u32 k = 0; k < CLRAY_TOGETHER; ++k) {
    const u32 counter[4] = {number, first + k, s->epoch, s->round};
    u32 random[4];
    philox4x32(s->key0, s->key1, counter, random);
    p.x[k] = fma(uniform53(random[0], random[1]), tile->x1 - tile->x0, tile->x0);
    p.y[k] = fma(uniform53(random[2], random[3]), tile->y1 - tile->y0, tile->y0);
    p.depth[k] = -1e300;
    p.order[k] = p.face[k] = -1;
  }
  for (u32 k = 0; k < tile->count; ++k) {
    const u32 own = g->listed[tile->first + k];
    show_face(g->faces + own, own, &p);
  }
  const f64 area = (tile->x1 - tile->x0) * (tile->y1 - tile->y0);
  if (CLRAY_CARRY && s->elsewhere != 0u) shade_tile(g, number, &p);
  for (u32 k = 0; k < CLRAY_TOGETHER && first + k < s->replicates; ++k) {
    f64 mean = 0.0;
    for (u32 lane = 0; lane < CLRAY_LANES && p.face[k] >= 0; ++lane)
      mean += g->weights[(u64)p.face[k] * CLRAY_LANES + lane];
    g->values[number * s->replicates + first + k] = mean * area;
    if (s->adds != 0u && mean != 0.0) add_sample(g, (u32)p.face[k], first + k, p.x[k], p.y[k], area);
  }
}

#endif
