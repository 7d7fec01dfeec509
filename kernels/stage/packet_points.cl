// SPDX-License-Identifier: Apache-2.0
// The points of a work-item of packets: of each replicate those that lie in one small square of the unit square
// (math/sobol_place.cl), and their order along Morton's curve of their places in the beam.
#ifndef CLRAY_PACKET_POINTS_CL
#define CLRAY_PACKET_POINTS_CL

#if CLRAY_PACKET

#define CLRAY_PACKET_CELLS 256u  // points of each replicate that a work-item carries, at most
#define CLRAY_PACKET_ITEM (CLRAY_PACKET_RAYS * CLRAY_PACKET_CELLS)

/// A ray of the beam that waits for a packet: where it starts, its share, the replicate and its point.
typedef struct BeamPoint {
  f64 u, v, share;
  u32 replicate, index;
} BeamPoint;

/// Draws the points of one replicate that are a work-item's.
static void packet_points(const Buffers* g, const Sampler* s, u32 view, u32 first_point, u32 points, u32 part,
                          u32 chunk, BeamPoint* out) {
  const __global ClrayView* from = g->views + view;
  const u32 cells = min(chunk, points - part * chunk);
  const u32 bits = 31u - clz(max(points, 1u)), own_bits = 31u - clz(max(chunk, 1u));
  const bool whole = points == 1u << bits && chunk == 1u << own_bits && (first_point & (points - 1u)) == 0u;
  const u32 a = whole ? (bits - own_bits + 1u) / 2u : 0u, b = whole ? bits - own_bits - a : 0u;
  u32 start = first_point + chunk * part;
  if (whole)
    start = first_index(s, first_point, a, b, (even_bits(part) << 1) << (31u - a),
                        (even_bits(part >> 1) << 1) << (31u - b));
  for (u32 n = 0; n < cells; ++n) {
    const u32 index = whole ? start ^ (superset_sum(n << b) << a) : start + n;
    f64 u[2] = {unit_from_bits(scramble_reversed(index, s->words[2])),
                unit_from_bits(scramble_reversed(superset_sum(index), s->words[3]))};
    out[n].share = 1.0;
    if (CLRAY_STRATA && from->strips != 0u) out[n].share = strata_place(g->strata, from, u);
    out[n].u = u[0];
    out[n].v = u[1];
    out[n].replicate = s->replicate;
    out[n].index = index;
  }
}

/// The low 12 bits of x, each followed by a free one.
static u32 spread_bits(u32 x) {
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}

/// Puts points in the order of their places along Morton's curve: order[k] is the k-th.
static void packet_sort(const BeamPoint* points, u32 count, u32* order) {
  u32 keys[CLRAY_PACKET_ITEM], other[CLRAY_PACKET_ITEM];
  for (u32 k = 0; k < count; ++k) {
    keys[k] = spread_bits((u32)(points[k].u * 4096.0)) | (spread_bits((u32)(points[k].v * 4096.0)) << 1);
    order[k] = k;
  }
  for (u32 pass = 0; pass < 3u; ++pass) {
    u32 end[256] = {0};
    for (u32 k = 0; k < count; ++k) ++end[(keys[k] >> (8u * pass)) & 255u];
    for (u32 k = 1; k < 256u; ++k) end[k] += end[k - 1u];
    for (u32 k = count; k-- > 0u;) other[--end[(keys[order[k]] >> (8u * pass)) & 255u]] = order[k];
    for (u32 k = 0; k < count; ++k) order[k] = other[k];
  }
}

#endif

#endif
