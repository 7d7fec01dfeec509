// SPDX-License-Identifier: Apache-2.0
// What a visible piece of a face adds: area, first moments, and moments of path length. That is linear over a face, so
// the integrals of a convex polygon are closed forms; sums over the triangles from its first corner (docs/exact.md).
// Every piece enters as integers, so their order cannot change a bit.
#ifndef CLRAY_EXACT_INTEGRALS_CL
#define CLRAY_EXACT_INTEGRALS_CL

#include "exact/fragment.cl"

/// The sums of a face that one work-item keeps; scales are those of the face.
typedef struct Kept {
  i64 sum[CLRAY_FACE_SUMS];
} Kept;

/// Depth over a face, from its first corner.
CLRAY_FN f64 face_depth(const CLRAY_GLOBAL ClrayFace* face, f64 x, f64 y) {
  return fma(face->slope_x, x - face->x[0], face->slope_y * (y - face->y[0]));
}

/// Path length over a face, from its first corner.
CLRAY_FN f64 face_path(const CLRAY_GLOBAL ClrayFace* face, f64 x, f64 y) {
  return fma(face->path_x, x - face->x[0], face->path_y * (y - face->y[0]));
}

/// Half the perimeter of the box around a fragment.
CLRAY_FN f64 extent_size(Extent e) { return e.x1 - e.x0 + (e.y1 - e.y0); }

/// Adds a visible piece of a face to what the work-item keeps.
CLRAY_FN void keep_piece(const CLRAY_GLOBAL ClrayFace* face, const Fragment* f, f64 area, Kept* kept) {
  // Moments about the face's first corner, of triangles (p0, pi, pj) with areas a: with s = p0 + pi + pj,
  // ∫p = a·s/3 and ∫d² = a·(s_d² + Σd²)/12.
  const f64 x0 = f->x[0] - face->x[0], y0 = f->y[0] - face->y[0], d0 = face_path(face, f->x[0], f->y[0]);
  f64 mx = 0.0, my = 0.0, md = 0.0, mdd = 0.0;
  for (u32 i = 1; i + 1u < f->corners; ++i) {
    const f64 ax = f->x[i] - face->x[0], ay = f->y[i] - face->y[0], da = face_path(face, f->x[i], f->y[i]);
    const f64 bx = f->x[i + 1u] - face->x[0], by = f->y[i + 1u] - face->y[0];
    const f64 db = face_path(face, f->x[i + 1u], f->y[i + 1u]);
    const f64 a = 0.5 * difference_of_products(ax - x0, by - y0, bx - x0, ay - y0);
    const f64 d = d0 + da + db;
    mx = fma(a, x0 + ax + bx, mx);
    my = fma(a, y0 + ay + by, my);
    md = fma(a, d, md);
    mdd = fma(a, fma(d, d, fma(d0, d0, fma(da, da, db * db))), mdd);
  }
  const f64 s = face->area_scale, third = 0.33333333333333333;
  const f64 length = s * face->inv_length, path = s * face->inv_path;
  kept->sum[CLRAY_FACE_PIECES] += 1;
  kept->sum[CLRAY_FACE_AREA] += convert_long_rte(area * s);
  kept->sum[CLRAY_FACE_X] += convert_long_rte(mx * third * length);
  kept->sum[CLRAY_FACE_Y] += convert_long_rte(my * third * length);
  kept->sum[CLRAY_FACE_PATH] += convert_long_rte(md * third * path);
  kept->sum[CLRAY_FACE_PATH2] += convert_long_rte(mdd * 0.083333333333333333 * path * face->inv_path);
}

#endif
