// SPDX-License-Identifier: Apache-2.0
// Where a point of the unit square lies in a stratified beam (host/beam/strata.hpp): its first coordinate
// chooses a strip and the place across it, the second a piece of that strip and the place along it. The map of a piece
// onto its part of a cell keeps areas, so a ray's weight is constant within it.
#ifndef CLRAY_STRATA_CL
#define CLRAY_STRATA_CL

#include "shared/abi.h"

/// Finds the stratum that u in (0,1) falls in, among `count` from `first` on. *place: where in it, in (0,1); *size: its
/// width, 1 … 2^32.
static u32 strata_choose(const __global ClrayStratum* strata, u32 first, u32 count, f64 u, f64* place, f64* size) {
  const __global ClrayStratum* s = strata + first;
  const f64 x = u * CLRAY_TWO_TO_32;
  u32 k = s[min((u32)(u * (f64)count), count - 1u)].guide;
  while (k + 1u < count && x > (f64)s[k].last + 1.0) ++k;
  const f64 start = k == 0u ? 0.0 : (f64)s[k - 1u].last + 1.0;
  *size = (f64)s[k].last + 1.0 - start;
  *place = f64_min(f64_max((x - start) / *size, 0.0), 1.0);
  return first + k;
}

/// A point of the unit square on the line x + r·y = s that has the share q of the square on its lower side. `along` in
/// (0,1) says where on the line.
static void strata_square(f64 q, f64 along, f64 r, f64* x, f64* y) {
  const f64 rest = 1.0 - q, corner = 0.5 * r;
  f64 s = q + corner;
  if (q < corner) s = sqrt(2.0 * r * q);
  if (rest < corner) s = 1.0 + r - sqrt(2.0 * r * rest);
  f64 low = 0.0, high = 1.0;
  if (r > 0.0) {
    low = f64_max((s - 1.0) / r, 0.0);
    high = f64_min(s / r, 1.0);
  }
  *y = fma(along, high - low, low);
  *x = f64_min(f64_max(fma(-r, *y, s), 0.0), 1.0);
}

/// Moves u to where its stratum lies in the beam's rectangle. Returns the ray's share of the beam.
static f64 strata_place(const __global ClrayStratum* strata, const __global ClrayView* view, f64 u[2]) {
  f64 across, along, strip_size, piece_size;
  const u32 strip = strata_choose(strata, view->first_stratum, view->strips, u[0], &across, &strip_size);
  const u32 piece = strata_choose(strata, strata[strip].a, strata[strip].b, u[1], &along, &piece_size);
  const u32 a = strata[piece].a, b = strata[piece].b;
  const f64 from = (f64)(b & 0xffffu), to = (f64)(b >> 16) + 1.0;
  const f64 r =
      (f64)((a >> CLRAY_PIECE_STEEPNESS_SHIFT) & (2u * CLRAY_PIECE_STEEPNESS - 1u)) / (f64)CLRAY_PIECE_STEEPNESS;
  f64 x, y;
  if (a & CLRAY_PIECE_REVERSE) along = 1.0 - along;
  strata_square(fma(across, to - from, from) / (f64)CLRAY_PIECE_PARTS, along, r, &x, &y);
  if (a & CLRAY_PIECE_SWAP) {
    const f64 t = x;
    x = y;
    y = t;
  }
  if (a & CLRAY_PIECE_FLIP_U) x = 1.0 - x;
  if (a & CLRAY_PIECE_FLIP_V) y = 1.0 - y;
  const u32 cell = a & CLRAY_PIECE_CELL, grid = view->grid;
  u[0] = ((f64)(cell % max(grid, 1u)) + x) / (f64)grid;
  u[1] = ((f64)(cell / max(grid, 1u)) + y) / (f64)grid;
  return (to - from) / (strip_size * piece_size) * view->share_scale;
}

#endif
