// SPDX-License-Identifier: Apache-2.0
// One face in one tile: the part of the face that no other face hides. What hides it is cut out of it, the largest
// faces first: they leave the least to cut, and of nested faces the last leaves nothing to the others. Fragments wait
// on a stack with the place in the tile's list from which others are still to be cut out of them, so no lists of pieces
// are kept. Where the stack is full the work-item stops, and the host goes on after the fragments that it has done
// (host/pipeline/exact_pass.cpp).
#ifndef CLRAY_EXACT_LEAF_CL
#define CLRAY_EXACT_LEAF_CL

#include "exact/bins.cl"
#include "exact/integrals.cl"
#include "exact/occlusion.cl"

#define CLRAY_MOST_CUT 7u       // corners of a fragment that is cut by four edges: more are halved first
#define CLRAY_SLIVER 1e-15      // of the face's part in the tile: smaller pieces are left out
#define CLRAY_ROUNDING 8.9e-16  // of the beam's size: what corners may be off
#define CLRAY_SHORT_EDGE 0.1    // of the margin: a shorter edge has no direction

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

/// Cuts away what of a fragment is outside a tile. Returns 0 where it has too many corners.
CLRAY_FN u32 fragment_in_tile(Fragment* f, const CLRAY_GLOBAL ClrayTile* tile) {
  Fragment inside, rest;
  u32 room = 1u;
  const Line lines[4] = {
      line_between(tile->x0, tile->y0, tile->x1, tile->y0), line_between(tile->x1, tile->y0, tile->x1, tile->y1),
      line_between(tile->x1, tile->y1, tile->x0, tile->y1), line_between(tile->x0, tile->y1, tile->x0, tile->y0)};
  for (u32 k = 0; k < 4u && f->corners >= 3u; ++k) {
    room &= fragment_cut(f, lines[k], &inside, &rest);
    *f = inside;
  }
  return room;
}

CLRAY_FN void fragment_of_face(const CLRAY_GLOBAL ClrayFace* face, Fragment* f) {
  f->corners = 0u;
  for (u32 i = 0; i < 3u; ++i) fragment_add(f, face->x[i], face->y[i]);
  fragment_close(f);
}

CLRAY_FN void fragment_of_piece(const CLRAY_GLOBAL ClrayPiece* piece, Fragment* f) {
  f->corners = 0u;
  for (u32 i = 0; i < piece->corners; ++i) fragment_add(f, piece->x[i], piece->y[i]);
  fragment_close(f);
}

#define CLRAY_INSIDE 1u
#define CLRAY_OUTSIDE 2u

/// Whether a fragment has corners inside and outside a line. An edge of no length has everything inside.
CLRAY_FN u32 fragment_sides(const Fragment* f, Line l, f64 short_edge) {
  if (fabs(l.dx) + fabs(l.dy) < short_edge) return CLRAY_INSIDE;
  f64 low = 0.0, high = 0.0;
  for (u32 i = 0; i < f->corners; i += CLRAY_FRAGMENT_BLOCK) {
    const f64 a = line_side(l, f->x[i], f->y[i]), b = line_side(l, f->x[i + 1u], f->y[i + 1u]);
    const f64 c = line_side(l, f->x[i + 2u], f->y[i + 2u]), d = line_side(l, f->x[i + 3u], f->y[i + 3u]);
    low = f64_min(low, f64_min(f64_min(a, b), f64_min(c, d)));
    high = f64_max(high, f64_max(f64_max(a, b), f64_max(c, d)));
  }
  return (high > 0.0 ? CLRAY_INSIDE : 0u) | (low < 0.0 ? CLRAY_OUTSIDE : 0u);
}

CLRAY_FN Line fragment_edge(const Fragment* f, u32 k) {
  const u32 next = k + 1u == f->corners ? 0u : k + 1u;
  return line_between(f->x[k], f->y[k], f->x[next], f->y[next]);
}

CLRAY_FN Line face_edge(const CLRAY_GLOBAL ClrayFace* face, u32 k) {
  const u32 next = k == 2u ? 0u : k + 1u;
  return line_between(face->x[k], face->y[k], face->x[next], face->y[next]);
}

#define CLRAY_APART 0x80000000u

/// Which edges of a face cut a fragment (a bit each), or CLRAY_APART.
CLRAY_FN u32 cutting_face_edges(const Fragment* f, const CLRAY_GLOBAL ClrayFace* face, f64 short_edge) {
  u32 cutting = 0u;
  for (u32 k = 0; k < 3u; ++k) {
    const u32 sides = fragment_sides(f, face_edge(face, k), short_edge);
    if ((sides & CLRAY_INSIDE) == 0u) return CLRAY_APART;
    if ((sides & CLRAY_OUTSIDE) != 0u) cutting |= 1u << k;
  }
  return cutting;
}

/// The same of a polygon.
CLRAY_FN u32 cutting_edges(const Fragment* f, const Fragment* polygon, f64 short_edge) {
  u32 cutting = 0u;
  for (u32 k = 0; k < polygon->corners; ++k) {
    const u32 sides = fragment_sides(f, fragment_edge(polygon, k), short_edge);
    if ((sides & CLRAY_INSIDE) == 0u) return CLRAY_APART;
    if ((sides & CLRAY_OUTSIDE) != 0u) cutting |= 1u << k;
  }
  return cutting;
}

/// Whether an edge of a fragment has a polygon outside.
CLRAY_FN u32 outside_an_edge(const Fragment* f, const Fragment* polygon, f64 short_edge) {
  for (u32 k = 0; k < f->corners; ++k) {
    if ((fragment_sides(polygon, fragment_edge(f, k), short_edge) & CLRAY_INSIDE) == 0u) return 1u;
  }
  return 0u;
}

#define CLRAY_CUT_NOTHING 0u
#define CLRAY_CUT_DONE 1u
#define CLRAY_CUT_FULL 2u

/// Cuts a polygon out of a fragment along those of its edges that cut it; what is left waits. CLRAY_CUT_NOTHING: they
/// do not overlap, the fragment is as it was. CLRAY_CUT_FULL: no room is left for the pieces.
static u32 cut_out(const Fragment* f, const Fragment* polygon, u32 cutting, f64 short_edge, f64 sliver2,
                   Waiting* waiting, f64* lost) {
  Fragment buffers[2];
  const Fragment* hidden = f;
  const u32 before = waiting->count;
  f64 dropped = 0.0;
  u32 own = 0u;
  for (u32 k = 0; k < polygon->corners; ++k) {
    if ((cutting >> k & 1u) == 0u) continue;
    const Line edge = fragment_edge(polygon, k);
    const u32 sides = fragment_sides(hidden, edge, short_edge);
    if ((sides & CLRAY_INSIDE) == 0u) {
      waiting->count = before;
      return CLRAY_CUT_NOTHING;
    }
    if ((sides & CLRAY_OUTSIDE) == 0u) continue;
    if (waiting->count == waiting->room) return CLRAY_CUT_FULL;
    Fragment* outside = waiting->fragment + waiting->count;
    if (!fragment_cut(hidden, edge, buffers + own, outside)) return CLRAY_CUT_FULL;
    if (outside->corners != 0u) {
      const f64 area2 = fragment_area2(outside);
      outside->next = f->next;
      if (area2 > sliver2) ++waiting->count;
      if (!(area2 > sliver2)) dropped += fabs(area2);
    }
    if (buffers[own].corners == 0u) {
      waiting->count = before;
      return CLRAY_CUT_NOTHING;
    }
    hidden = buffers + own;
    own = 1u - own;
  }
  if (fragment_area2(hidden) <= sliver2) {
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
  fragment_close(a);
  fragment_close(b);
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
    const __global ClrayListed* listed = g->lists + tile->first + k;
    if (listed->nearest < farthest || listed->box[0] >= e.x1 || listed->box[1] <= e.x0 || listed->box[2] >= e.y1 ||
        listed->box[3] <= e.y0 || listed->face == own)
      continue;
    const __global ClrayFace* front = g->faces + listed->face;
    u32 cutting = cutting_face_edges(f, front, short_edge);
    if (cutting == CLRAY_APART) continue;
    f64 h[3];
    const u32 where = hides(front, face, tile->margin, h);
    if (where == CLRAY_NOWHERE) continue;
    if (where == CLRAY_EVERYWHERE && cutting == 0u) return CLRAY_PIECE_GONE;  // all of it is hidden
    Fragment polygon;
    hiding_part(front, where, h, &polygon);
    if (polygon.corners == 0u) continue;
    if (where == CLRAY_PARTLY) cutting = cutting_edges(f, &polygon, short_edge);
    if (cutting == CLRAY_APART || outside_an_edge(f, &polygon, short_edge)) continue;
    if (f->corners > CLRAY_MOST_CUT) {
      if (waiting->count + 2u > waiting->room) return CLRAY_PIECE_FULL;
      f->next = k;
      halve(f, waiting->fragment + waiting->count, waiting->fragment + waiting->count + 1u);
      waiting->count += 2u;
      return CLRAY_PIECE_GONE;
    }
    f->next = k + 1u;
    const u32 cut = cut_out(f, &polygon, cutting, short_edge, sliver2, waiting, lost);
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
    histogram_piece(&h, face, f, area, (face->path_m - b->first_m) * b->per_metre, b->per_metre);
  }
}

/// Notes a lit piece for observers elsewhere, in two where it has many corners. Returns 0 where there is no room.
static u32 carry_piece(const Exact* g, u32 own, const Fragment* f) {
  Fragment part[2];
  u32 count = 1u;
  part[0] = *f;
  if (f->corners > CLRAY_PIECE_CORNERS) {
    halve(f, part, part + 1);
    count = 2u;
  }
  const u32 room = g->lit_count[1], at = atomic_add(g->lit_count, count);
  for (u32 k = 0; k < count && at + k < room; ++k) {
    CLRAY_GLOBAL ClrayPiece* piece = g->lit + at + k;
    piece->face = own;
    piece->off = 0.0;
    const u32 corners = at + count <= room ? part[k].corners : 0u;  // of a piece in two there is room for all or none
    piece->corners = corners;
    for (u32 i = 0; i < CLRAY_PIECE_CORNERS; ++i) {
      piece->x[i] = i < corners ? part[k].x[i] : 0.0;
      piece->y[i] = i < corners ? part[k].y[i] : 0.0;
    }
  }
  return at + count <= room ? 1u : 0u;
}

/// Notes what is visible of a fragment. Returns 0 where there is no room for it.
static u32 take_piece(const Exact* g, u32 own, u32 seen, const Fragment* f, Kept* kept) {
  const __global ClrayFace* face = g->faces + own;
  if (CLRAY_CARRY && !seen && face->carried && !carry_piece(g, own, f)) return 0u;
  const f64 area = 0.5 * fragment_area2(f);
  keep_piece(face, f, area, kept);
  if (seen || CLRAY_FROM_SOURCE) add_to_bins(g, own, f, area);
  return 1u;
}

/// One face in one tile, or (seen) one lit piece of it in a tile of an observer's view. Its fragments are taken one
/// after the other; those before the `skip`-th add nothing. Returns how many were done; *full is 1 where the stack had
/// no more room for the next, or the lit pieces had none.
static u32 exact_item(const Exact* g, u32 item, u32 seen, Fragment* stack, u32 room, u32 skip, u32* full) {
  const __global ClrayTile* tile = g->tiles + g->items[2u * item];
  const u32 own = g->items[2u * item + 1u];
  const __global ClrayFace* face = g->faces + own;
  Waiting waiting = {stack, 0u, room};
  Kept kept;
  for (u32 k = 0; k < CLRAY_FACE_SUMS; ++k) kept.sum[k] = 0;
  if (CLRAY_CARRY && seen) fragment_of_piece(g->pieces + item, stack);
  if (!(CLRAY_CARRY && seen)) fragment_of_face(face, stack);
  const f64 off = fma(CLRAY_ROUNDING, tile->size, CLRAY_CARRY && seen ? g->pieces[item].off : 0.0);
  *full = fragment_in_tile(stack, tile) ? 0u : 1u;
  stack[0].next = 0u;
  if (stack[0].corners >= 3u) waiting.count = 1u;
  const f64 whole2 = waiting.count == 1u ? fragment_area2(stack) : 0.0;
  u32 done = 0u;
  while (waiting.count > 0u && !*full) {
    Fragment f = stack[--waiting.count];
    f64 lost = 0.0;
    const u32 end = cut_all(g, tile, own, CLRAY_SLIVER * whole2, &f, &waiting, &lost);
    if (end == CLRAY_PIECE_FULL) *full = 1u;
    if (end == CLRAY_PIECE_VISIBLE && done >= skip) {
      if (!take_piece(g, own, seen, &f, &kept)) *full = 1u;
      lost = fma(off, extent_size(fragment_extent(&f)), lost);
    }
    if (!*full && done++ >= skip) kept.sum[CLRAY_FACE_LOST] += convert_long_rte(lost * face->area_scale);
  }
  for (u32 k = 0; k < CLRAY_FACE_SUMS; ++k) {
    if (kept.sum[k] != 0) atomic_add_i64(g->sums + (u64)own * CLRAY_FACE_SUMS + k, kept.sum[k]);
  }
  return done;
}

#endif
