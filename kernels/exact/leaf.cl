// SPDX-License-Identifier: Apache-2.0
// One face in one tile: the part of the face that no other face hides. What hides it is cut out of it, nearest first.
// Fragments wait on a stack with the place in the tile's list from which others are still to be cut out of them, so no
// lists of pieces are kept. Where the stack is full the work-item stops, and the host goes on after the pieces that it
// has counted (host/pipeline/exact_pass.cpp).
#ifndef CLRAY_EXACT_LEAF_CL
#define CLRAY_EXACT_LEAF_CL

#include "exact/bins.cl"
#include "exact/integrals.cl"
#include "exact/occlusion.cl"

#define CLRAY_MOST_CUT 7u         // corners of a fragment that is cut by four edges: more are halved first
#define CLRAY_SLIVER 1e-15        // of the face's part in the tile: smaller pieces are left out
#define CLRAY_ROUNDING 8.9e-16    // of the beam's size: what corners may be off
#define CLRAY_SHORT_EDGE 0.1      // of the margin: a shorter edge has no direction

/// What the work-items of an exact pass read and add to.
typedef struct Exact {
#define CLRAY_BUFFER(type, name) type* name;
  CLRAY_EXACT_BUFFERS(CLRAY_BUFFER)
#undef CLRAY_BUFFER
} Exact;

/// Fragments that wait.
typedef struct Waiting {
  Fragment* fragment;
  u32 count, room;
} Waiting;

/// The part of a face inside a tile; 0 corners where there is none.
CLRAY_FN u32 face_in_tile(const CLRAY_GLOBAL ClrayFace* face, const CLRAY_GLOBAL ClrayTile* tile, Fragment* f) {
  Fragment other, rest;
  u32 room = 1u;
  f->corners = 0u;
  for (u32 i = 0; i < 3u; ++i) fragment_add(f, face->x[i], face->y[i]);
  const Line lines[4] = {line_between(tile->x0, tile->y0, tile->x1, tile->y0),
                         line_between(tile->x1, tile->y0, tile->x1, tile->y1),
                         line_between(tile->x1, tile->y1, tile->x0, tile->y1),
                         line_between(tile->x0, tile->y1, tile->x0, tile->y0)};
  for (u32 k = 0; k < 4u && f->corners >= 3u; ++k) {
    room &= fragment_cut(f, lines[k], &other, &rest);
    *f = other;
  }
  return room;
}

/// Whether every corner of a fragment lies outside one edge of a polygon, so that they do not overlap.
CLRAY_FN u32 apart(const Fragment* f, const Fragment* polygon, f64 short_edge) {
  for (u32 k = 0; k < polygon->corners; ++k) {
    const u32 next = k + 1u == polygon->corners ? 0u : k + 1u;
    const Line edge = line_between(polygon->x[k], polygon->y[k], polygon->x[next], polygon->y[next]);
    if (fabs(edge.dx) + fabs(edge.dy) < short_edge) continue;
    u32 outside = 1u;
    for (u32 i = 0; i < f->corners && outside; ++i) outside = line_side(edge, f->x[i], f->y[i]) <= 0.0 ? 1u : 0u;
    if (outside) return 1u;
  }
  return 0u;
}

/// The same of a face's triangle.
CLRAY_FN u32 apart_from_face(const Fragment* f, const CLRAY_GLOBAL ClrayFace* face, f64 short_edge) {
  for (u32 k = 0; k < 3u; ++k) {
    const u32 next = k == 2u ? 0u : k + 1u;
    const Line edge = line_between(face->x[k], face->y[k], face->x[next], face->y[next]);
    if (fabs(edge.dx) + fabs(edge.dy) < short_edge) continue;
    u32 outside = 1u;
    for (u32 i = 0; i < f->corners && outside; ++i) outside = line_side(edge, f->x[i], f->y[i]) <= 0.0 ? 1u : 0u;
    if (outside) return 1u;
  }
  return 0u;
}

#define CLRAY_CUT_NOTHING 0u
#define CLRAY_CUT_DONE 1u
#define CLRAY_CUT_FULL 2u

/// Cuts a polygon out of a fragment; what is left waits. CLRAY_CUT_NOTHING: they do not overlap, the fragment is as it
/// was. CLRAY_CUT_FULL: no room is left for the pieces.
static u32 cut_out(const Fragment* f, const Fragment* polygon, f64 short_edge, f64 sliver2, Waiting* waiting,
                   f64* lost) {
  Fragment hidden = *f, inside, outside;
  const u32 before = waiting->count;
  f64 dropped = 0.0;
  for (u32 k = 0; k < polygon->corners; ++k) {
    const u32 next = k + 1u == polygon->corners ? 0u : k + 1u;
    const Line edge = line_between(polygon->x[k], polygon->y[k], polygon->x[next], polygon->y[next]);
    if (fabs(edge.dx) + fabs(edge.dy) < short_edge) continue;
    if (!fragment_cut(&hidden, edge, &inside, &outside)) return CLRAY_CUT_FULL;
    if (outside.corners != 0u) {
      const f64 area2 = fragment_area2(&outside);
      if (area2 > sliver2) {
        if (waiting->count == waiting->room) return CLRAY_CUT_FULL;
        outside.next = f->next;
        waiting->fragment[waiting->count++] = outside;
      } else {
        dropped += fabs(area2);
      }
    }
    if (inside.corners == 0u) {
      waiting->count = before;
      return CLRAY_CUT_NOTHING;
    }
    hidden = inside;
  }
  if (fragment_area2(&hidden) <= sliver2) {
    waiting->count = before;
    return CLRAY_CUT_NOTHING;
  }
  *lost += dropped;
  return CLRAY_CUT_DONE;
}

/// How far rounding may move the line along which two faces cross, per unit of rounding: the length of an edge over
/// the difference of its distances, the greatest.
CLRAY_FN f64 crossing_slope(const CLRAY_GLOBAL ClrayFace* front, const f64* h) {
  f64 greatest = 0.0;
  for (u32 i = 0; i < 3u; ++i) {
    const u32 j = i == 2u ? 0u : i + 1u;
    if (!((h[i] > 0.0 && h[j] < 0.0) || (h[i] < 0.0 && h[j] > 0.0))) continue;
    const f64 length = fabs(front->x[j] - front->x[i]) + fabs(front->y[j] - front->y[i]);
    greatest = f64_max(greatest, length / fabs(h[i] - h[j]));
  }
  return greatest;
}

CLRAY_FN f64 nearest_to_beam_end(const CLRAY_GLOBAL ClrayFace* face, const Fragment* f) {
  f64 least = face_depth(face, f->x[0], f->y[0]);
  for (u32 i = 1; i < f->corners; ++i) least = f64_min(least, face_depth(face, f->x[i], f->y[i]));
  return least + face->depth0;
}

/// Halves a fragment of many corners by a diagonal.
CLRAY_FN void halve(const Fragment* f, Fragment* a, Fragment* b) {
  const u32 middle = f->corners / 2u;
  a->corners = b->corners = 0u;
  a->next = b->next = f->next;
  for (u32 i = 0; i <= middle; ++i) fragment_add(a, f->x[i], f->y[i]);
  for (u32 i = middle; i <= f->corners; ++i) {
    const u32 k = i == f->corners ? 0u : i;
    fragment_add(b, f->x[k], f->y[k]);
  }
}

#define CLRAY_PIECE_VISIBLE 0u
#define CLRAY_PIECE_GONE 1u
#define CLRAY_PIECE_FULL 2u

/// Cuts what hides a fragment of a face out of it, from f->next on. CLRAY_PIECE_GONE: nothing of it is left as it was,
/// its pieces wait.
static u32 cut_all(const Exact* g, const __global ClrayTile* tile, u32 own, f64 sliver2, Fragment* f, Waiting* waiting,
                   f64* lost) {
  const __global ClrayFace* face = g->faces + own;
  const f64 farthest = nearest_to_beam_end(face, f) - face->margin, short_edge = CLRAY_SHORT_EDGE * tile->margin;
  const Extent e = fragment_extent(f);
  for (u32 k = f->next; k < tile->count; ++k) {
    const u32 other = g->lists[tile->first + k];
    const __global ClrayFace* front = g->faces + other;
    if (front->nearest < farthest) return CLRAY_PIECE_VISIBLE;  // so are all that follow
    if (other == own || front->box[0] >= e.x1 || front->box[1] <= e.x0 || front->box[2] >= e.y1 ||
        front->box[3] <= e.y0)
      continue;
    if (apart_from_face(f, front, short_edge)) continue;
    f64 h[3];
    const u32 where = hides(front, face, tile->margin, h);
    if (where == CLRAY_NOWHERE) continue;
    Fragment polygon;
    hiding_part(front, where, h, &polygon);
    if (polygon.corners == 0u || (where == CLRAY_PARTLY && apart(f, &polygon, short_edge))) continue;
    if (f->corners > CLRAY_MOST_CUT) {
      if (waiting->count + 2u > waiting->room) return CLRAY_PIECE_FULL;
      f->next = k;
      halve(f, waiting->fragment + waiting->count, waiting->fragment + waiting->count + 1u);
      waiting->count += 2u;
      return CLRAY_PIECE_GONE;
    }
    f->next = k + 1u;
    const u32 cut = cut_out(f, &polygon, short_edge, sliver2, waiting, lost);
    if (cut == CLRAY_CUT_NOTHING) continue;
    if (where == CLRAY_PARTLY)
      *lost = fma(2.0 * CLRAY_ROUNDING * tile->size * crossing_slope(front, h), extent_size(e), *lost);
    return cut == CLRAY_CUT_DONE ? CLRAY_PIECE_GONE : CLRAY_PIECE_FULL;
  }
  return CLRAY_PIECE_VISIBLE;
}

/// Adds a visible piece of a face to the histograms of the detectors.
static void add_to_bins(const Exact* g, u32 own, const Fragment* f, f64 area) {
  const __global ClrayFace* face = g->faces + own;
  for (u32 n = 0; n < CLRAY_BINNINGS; ++n) {
    const __global ClrayBinning* b = g->binnings + n;
    Histogram h;
    h.bins = (i64)b->bins;
    h.lanes = CLRAY_LANES;
    h.lane_stride = b->bins + 2u;
    h.row = g->bins + b->offset + (u64)face->view * CLRAY_LANES * (b->bins + 2u);
    h.weight = g->weights + (u64)own * CLRAY_LANES;
    h.scale = face->bin_scale;
    histogram_piece(&h, face, f, area, (face->path_m - b->first_m) * b->per_metre, -2.0 * b->per_metre);
  }
}

/// One face in one tile. Pieces are counted from 0, and those before `skip` are left out. Returns how many there were;
/// *full is 1 where the stack had no more room.
static u32 exact_item(const Exact* g, u32 item, Fragment* stack, u32 room, u32 skip, u32* full) {
  const __global ClrayTile* tile = g->tiles + g->items[2u * item];
  const u32 own = g->items[2u * item + 1u];
  const __global ClrayFace* face = g->faces + own;
  Waiting waiting = {stack, 0u, room};
  Kept kept;
  for (u32 k = 0; k < CLRAY_FACE_SUMS; ++k) kept.sum[k] = 0;
  kept.lost = 0.0;
  u32 pieces = 0u;
  *full = face_in_tile(face, tile, stack) ? 0u : 1u;
  stack[0].next = 0u;
  if (stack[0].corners >= 3u) waiting.count = 1u;
  const f64 whole2 = waiting.count == 1u ? fragment_area2(stack) : 0.0;
  while (waiting.count > 0u && !*full) {
    Fragment f = stack[--waiting.count];
    f64 lost = 0.0;
    const u32 end = cut_all(g, tile, own, CLRAY_SLIVER * whole2, &f, &waiting, &lost);
    if (end == CLRAY_PIECE_FULL) {
      *full = 1u;
      break;
    }
    if (pieces >= skip) kept.lost += lost;
    if (end == CLRAY_PIECE_GONE) continue;
    if (pieces++ < skip) continue;
    const f64 area = 0.5 * fragment_area2(&f);
    kept.lost = fma(CLRAY_ROUNDING * tile->size, extent_size(fragment_extent(&f)), kept.lost);
    keep_piece(face, &f, area, &kept);
    add_to_bins(g, own, &f, area);
  }
  kept.sum[CLRAY_FACE_LOST] = convert_long_rte(kept.lost * face->area_scale);
  kept.sum[CLRAY_FACE_PIECES] = (i64)(pieces > skip ? pieces - skip : 0u);
  for (u32 k = 0; k < CLRAY_FACE_SUMS; ++k) {
    if (kept.sum[k] != 0) atomic_add_i64(g->sums + (u64)own * CLRAY_FACE_SUMS + k, kept.sum[k]);
  }
  return pieces;
}

#endif
