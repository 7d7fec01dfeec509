// SPDX-License-Identifier: Apache-2.0
// Convex polygons across the beam: what is left of a face while others are cut out of it. Corners run counter-clockwise
// as seen from the source.
#ifndef CLRAY_EXACT_FRAGMENT_CL
#define CLRAY_EXACT_FRAGMENT_CL

#include "shared/abi.h"

#define CLRAY_FRAGMENT_CORNERS 12u

#define CLRAY_FRAGMENT_BLOCK 4u  // corners that are compared with a line at once

/// The corners beyond the last, up to a whole block, repeat the first.
typedef struct Fragment {
  f64 x[CLRAY_FRAGMENT_CORNERS], y[CLRAY_FRAGMENT_CORNERS];
  u32 corners;
  u32 next;  // place in the tile's list of the first face that was not yet cut out of it
} Fragment;

/// A line with its inner side to the left of (dx, dy).
typedef struct Line {
  f64 x, y, dx, dy;
} Line;

CLRAY_FN Line line_between(f64 ax, f64 ay, f64 bx, f64 by) {
  Line l;
  l.x = ax;
  l.y = ay;
  l.dx = bx - ax;
  l.dy = by - ay;
  return l;
}

/// Positive inside, and zero on the line: the distance from it times the length of (dx, dy).
CLRAY_FN f64 line_side(Line l, f64 x, f64 y) {
  const f64 across = l.dy * (x - l.x);
  return fma(l.dx, y - l.y, -across);
}

/// Appends a corner, but for one that repeats the last: an edge of no length would make a line without direction.
/// Returns 0 where there is no room.
CLRAY_FN u32 fragment_add(Fragment* f, f64 x, f64 y) {
  const u32 n = f->corners;
  if (n > 0u && f->x[n - 1u] == x && f->y[n - 1u] == y) return 1u;
  if (n == CLRAY_FRAGMENT_CORNERS) return 0u;
  f->x[n] = x;
  f->y[n] = y;
  f->corners = n + 1u;
  return 1u;
}

/// Leaves out a last corner that repeats the first, and everything where no area is left; fills the last block.
CLRAY_FN void fragment_close(Fragment* f) {
  u32 n = f->corners;
  if (n > 1u && f->x[n - 1u] == f->x[0] && f->y[n - 1u] == f->y[0]) --n;
  f->corners = n < 3u ? 0u : n;
  for (; n % CLRAY_FRAGMENT_BLOCK != 0u; ++n) {
    f->x[n] = f->x[0];
    f->y[n] = f->y[0];
  }
}

/// Cuts a fragment along a line. Both sides take the same new corners, so no area is lost between them. Returns 0 where
/// a side has too many corners.
CLRAY_FN u32 fragment_cut(const Fragment* f, Line l, Fragment* inside, Fragment* outside) {
  const u32 n = f->corners;
  u32 room = 1u;
  inside->corners = outside->corners = 0u;
  f64 x0 = f->x[n - 1u], y0 = f->y[n - 1u], side0 = line_side(l, x0, y0);
  for (u32 i = 0; i < n; ++i) {
    const f64 x = f->x[i], y = f->y[i], side = line_side(l, x, y);
    if ((side > 0.0 && side0 < 0.0) || (side < 0.0 && side0 > 0.0)) {
      const f64 at = side0 / (side0 - side);
      const f64 cx = fma(at, x - x0, x0), cy = fma(at, y - y0, y0);
      room &= fragment_add(inside, cx, cy) & fragment_add(outside, cx, cy);
    }
    if (side >= 0.0) room &= fragment_add(inside, x, y);
    if (side <= 0.0) room &= fragment_add(outside, x, y);
    x0 = x;
    y0 = y;
    side0 = side;
  }
  fragment_close(inside);
  fragment_close(outside);
  return room;
}

/// Twice the area.
CLRAY_FN f64 fragment_area2(const Fragment* f) {
  f64 sum = 0.0;
  for (u32 i = 1; i + 1u < f->corners; ++i) {
    const f64 ax = f->x[i] - f->x[0], ay = f->y[i] - f->y[0];
    const f64 bx = f->x[i + 1u] - f->x[0], by = f->y[i + 1u] - f->y[0];
    sum += difference_of_products(ax, by, bx, ay);
  }
  return sum;
}

typedef struct Extent {
  f64 x0, x1, y0, y1;
} Extent;

CLRAY_FN Extent fragment_extent(const Fragment* f) {
  Extent e = {f->x[0], f->x[0], f->y[0], f->y[0]};
  for (u32 i = 1; i < f->corners; ++i) {
    e.x0 = f64_min(e.x0, f->x[i]);
    e.x1 = f64_max(e.x1, f->x[i]);
    e.y0 = f64_min(e.y0, f->y[i]);
    e.y1 = f64_max(e.y1, f->y[i]);
  }
  return e;
}

#endif
