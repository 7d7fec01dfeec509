// SPDX-License-Identifier: Apache-2.0
// The histogram of a visible piece over path length, exactly: u, the place among the bins, is linear over the face, so
// the share of a bin is the area of the piece between two parallel lines. The two chains of corners from the least u to
// the greatest bound it; between two corners or borders the width is linear, so each step adds a trapezium.
#ifndef CLRAY_EXACT_BINS_CL
#define CLRAY_EXACT_BINS_CL

#include "exact/integrals.cl"
#include "math/atomic64.cl"

#define CLRAY_ONE_BIN 1e-9  // of a bin: a face whose delays span less goes whole into one

/// Where the numbers of a piece go.
typedef struct Histogram {
  volatile __global i64* row;  // of the first lane: below, bins, above
  u64 lanes, lane_stride;      // numbers between the rows of two lanes
  const __global f64* weight;  // of each lane, per area
  f64 scale;                   // integers per m² of weight 1
  i64 bins;
} Histogram;

/// Adds an area to the bin that holds u; borders belong to the bin above them.
static void histogram_add(const Histogram* h, i64 bin, f64 area) {
  const u64 at = bin < 0 ? 0u : (u64)(bin >= h->bins ? h->bins + 1 : bin + 1);
  for (u64 lane = 0; lane < h->lanes; ++lane) {
    const i64 q = convert_long_rte(area * h->weight[lane] * h->scale);
    if (q != 0) atomic_add_i64(h->row + lane * h->lane_stride + at, q);  // lint: integer
  }
}

/// The bin that holds u: -1 below the first, `bins` above the last.
CLRAY_FN i64 bin_of(i64 bins, f64 u) { return u < 0.0 ? -1 : (u >= (f64)bins ? bins : (i64)floor(u)); }

/// One side of a piece, walked from the least u to the greatest.
typedef struct Chain {
  u32 at, to, step, corners;  // from corner `at` toward corner `to`
} Chain;

CLRAY_FN u32 chain_next(const Chain* c) { return (c->at + c->step) % max(c->corners, 1u); }

/// Goes on until the segment's end lies above u, or the chain is at its end.
CLRAY_FN void chain_pass(Chain* c, const f64* u, f64 low) {
  while (c->at != c->to && u[chain_next(c)] <= low) c->at = chain_next(c);
}

/// t at u on the chain's segment.
CLRAY_FN f64 chain_place(const Chain* c, const f64* u, const f64* t, f64 at) {
  if (c->at == c->to) return t[c->at];
  const u32 next = chain_next(c);
  if (at == u[next]) return t[next];
  const f64 share = (at - u[c->at]) / (u[next] - u[c->at]);
  return fma(share, t[next] - t[c->at], t[c->at]);
}

/// Adds a piece of a face. `u_corner` and `per_metre`: u at the face's first corner, and bins per metre of path.
static void histogram_piece(const Histogram* h, const __global ClrayFace* face, const Fragment* f, f64 area,
                            f64 u_corner, f64 per_metre) {
  const f64 u0 = fma(per_metre, face->path[1], u_corner), u1 = fma(per_metre, face->path[2], u_corner);
  const f64 low = f64_min(u_corner, f64_min(u0, u1)), high = f64_max(u_corner, f64_max(u0, u1));
  if (high - low < CLRAY_ONE_BIN) {
    histogram_add(h, bin_of(h->bins, fma(0.5, high - low, low)), area);
    return;
  }
  // t: x or y, whichever changes less along the lines of equal u … their Jacobian is the slope of the other.
  const f64 gx = per_metre * face->path_x, gy = per_metre * face->path_y;
  const u32 along_x = fabs(gy) >= fabs(gx) ? 1u : 0u;
  const f64 jacobian = along_x ? fabs(gy) : fabs(gx);
  f64 u[CLRAY_FRAGMENT_CORNERS], t[CLRAY_FRAGMENT_CORNERS];
  Chain a = {0u, 0u, 1u, f->corners}, b = {0u, 0u, f->corners - 1u, f->corners};
  for (u32 i = 0; i < f->corners; ++i) {
    u[i] = fma(per_metre, face_path(face, f->x[i], f->y[i]), u_corner);
    t[i] = along_x ? f->x[i] : f->y[i];
    if (u[i] < u[a.at]) a.at = i;
    if (u[i] > u[a.to]) a.to = i;
  }
  b.at = a.at;
  b.to = a.to;
  const f64 end = u[a.to];
  i64 bin = bin_of(h->bins, u[a.at]);
  if (bin == bin_of(h->bins, end)) {
    histogram_add(h, bin, area);
    return;
  }
  f64 at = u[a.at], part = 0.0;
  while (at < end) {
    chain_pass(&a, u, at);
    chain_pass(&b, u, at);
    const f64 border = bin < 0 ? 0.0 : (f64)(bin + 1);
    f64 to = bin >= h->bins ? end : f64_min(end, border);
    if (a.at != a.to) to = f64_min(to, u[chain_next(&a)]);
    if (b.at != b.to) to = f64_min(to, u[chain_next(&b)]);
    const f64 w0 = fabs(chain_place(&a, u, t, at) - chain_place(&b, u, t, at));
    const f64 w1 = fabs(chain_place(&a, u, t, to) - chain_place(&b, u, t, to));
    part = fma(0.5 * (w0 + w1), to - at, part);
    at = to;
    if (bin < h->bins && at >= border) {
      histogram_add(h, bin, part / jacobian);
      part = 0.0;
      ++bin;
    }
  }
  histogram_add(h, bin, part / jacobian);
}

#endif
