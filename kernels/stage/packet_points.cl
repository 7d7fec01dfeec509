// SPDX-License-Identifier: Apache-2.0
// The points of a work-item of packets: of each replicate those that lie in one small square of the unit square
// (math/sobol_place.cl), and their order along Morton's curve of their places in the beam.
#ifndef CLRAY_PACKET_POINTS_CL
#define CLRAY_PACKET_POINTS_CL

#if CLRAY_PACKET

#define CLRAY_PACKET_REPLICATES 16u
#define CLRAY_PACKET_CELLS 256u  // points of each replicate that a work-item carries, at most
#define CLRAY_PACKET_DIGIT 11u   // bits that a round of the sort looks at
#define CLRAY_PACKET_ITEM (CLRAY_PACKET_REPLICATES * CLRAY_PACKET_CELLS)

/// A ray of the beam that waits for a packet: where it starts, its share and its point. Those of replicate r stand from
/// r·CLRAY_PACKET_CELLS on.
typedef struct BeamPoint {
  f64 u, v, share;
  u32 index;
} BeamPoint;

/// The low 11 bits of x, each followed by a free one.
static u32 spread_bits(u32 x) {
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}

/// Draws the points of one replicate that are a work-item's, and their places along Morton's curve over the beam, in a
/// grid of squares, 2048 along its longer side.
static void packet_points(const Buffers* g, const Sampler* s, u32 view, u32 first_point, u32 points, u32 part,
                          u32 chunk, BeamPoint* out, u32* place) {
  const __global ClrayView* from = g->views + view;
  const u32 cells = min(chunk, points - part * chunk);
  const u32 bits = 31u - clz(max(points, 1u)), own_bits = 31u - clz(max(chunk, 1u));
  const bool whole = points == 1u << bits && chunk == 1u << own_bits && (first_point & (points - 1u)) == 0u;
  const u32 a = whole ? (bits - own_bits + 1u) / 2u : 0u, b = whole ? bits - own_bits - a : 0u;
  u32 start = first_point + chunk * part;
  if (whole)
    start = first_index(s, first_point, a, b, (even_bits(part) << 1) << (31u - a),
                        (even_bits(part >> 1) << 1) << (31u - b));
  // Compilers make these loops wide.
  u32 index[CLRAY_PACKET_CELLS], first[CLRAY_PACKET_CELLS], second[CLRAY_PACKET_CELLS];
  for (u32 n = 0; n < cells; ++n) index[n] = whole ? start ^ (superset_sum(n << b) << a) : start + n;
  for (u32 n = 0; n < cells; ++n) {
    first[n] = scramble_reversed(index[n], s->words[2]);
    second[n] = scramble_reversed(superset_sum(index[n]), s->words[3]);
  }
  const bool strata = CLRAY_STRATA && from->strips != 0u;
  const f64 side_u = v3_length(v3_load(from->edge_u)), side_v = v3_length(v3_load(from->edge_v));
  const f64 squares = 2048.0 / f64_max(f64_max(side_u, side_v), CLRAY_TWO_TO_MINUS_32 * CLRAY_TWO_TO_MINUS_32);
  for (u32 n = 0; n < cells; ++n) {
    f64 u[2] = {unit_from_bits(first[n]), unit_from_bits(second[n])};
    out[n].share = strata ? strata_place(g->strata, from, u) : 1.0;
    out[n].u = u[0];
    out[n].v = u[1];
    out[n].index = index[n];
    place[n] = spread_bits((u32)(u[0] * (side_u * squares))) | spread_bits((u32)(u[1] * (side_v * squares))) << 1;
  }
}

/// Puts the first `cells` points of each replicate in the order of their places: order[k] is the k-th.
static void packet_sort(const u32* place, u32 replicates, u32 cells, u32* order) {
  u32 other[CLRAY_PACKET_ITEM];
  const u32 last = (1u << CLRAY_PACKET_DIGIT) - 1u;
  u32 count = 0u;
  for (u32 r = 0; r < replicates; ++r) {
    for (u32 n = 0; n < cells; ++n) order[count++] = CLRAY_PACKET_CELLS * r + n;
  }
  for (u32 shift = 0; shift < 2u * CLRAY_PACKET_DIGIT; shift += CLRAY_PACKET_DIGIT) {
    u32 end[1u << CLRAY_PACKET_DIGIT] = {0};
    for (u32 k = 0; k < count; ++k) ++end[(place[order[k]] >> shift) & last];
    for (u32 k = 1; k <= last; ++k) end[k] += end[k - 1u];
    for (u32 k = count; k-- > 0u;) other[--end[(place[order[k]] >> shift) & last]] = order[k];
    for (u32 k = 0; k < count; ++k) order[k] = other[k];
  }
}

#endif

#endif
