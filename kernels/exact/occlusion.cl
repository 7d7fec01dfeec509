// SPDX-License-Identifier: Apache-2.0
// Which of two faces is in front. The distances of one face's corners from the other's plane decide, in the body's own
// coordinates, so they are the same numbers whatever the direction of the beam. Distances within `margin` are zero.
#ifndef CLRAY_EXACT_OCCLUSION_CL
#define CLRAY_EXACT_OCCLUSION_CL

#include "exact/fragment.cl"

#define CLRAY_NOWHERE 0u
#define CLRAY_EVERYWHERE 1u
#define CLRAY_PARTLY 2u

/// Distances of the corners of `other` in front of the plane of `face`. Returns bit 0: some are in front, bit 1: some
/// are behind.
CLRAY_FN u32 distances(const CLRAY_GLOBAL ClrayFace* face, const CLRAY_GLOBAL ClrayFace* other, f64 margin, f64* h) {
  const CLRAY_GLOBAL f64* n = face->normal;
  u32 sides = 0u;
  for (u32 i = 0; i < 3u; ++i) {
    const CLRAY_GLOBAL f64* w = other->body + 3u * i;
    const f64 d = fma(n[0], w[0], fma(n[1], w[1], fma(n[2], w[2], -face->offset)));
    h[i] = fabs(d) <= margin ? 0.0 : d;
    sides |= (h[i] > 0.0 ? 1u : 0u) | (h[i] < 0.0 ? 2u : 0u);
  }
  return sides;
}

/// Where `front` hides `face`, as far as both are at one place of the beam: CLRAY_NOWHERE, CLRAY_EVERYWHERE, or
/// CLRAY_PARTLY: where h, the distances of the corners of `front`, is positive. Faces of which one lies in the plane of
/// the other are in one place: the order of the scene decides, in which the first hides the others.
CLRAY_FN u32 hides(const CLRAY_GLOBAL ClrayFace* front, const CLRAY_GLOBAL ClrayFace* face, f64 margin, f64* h) {
  const u32 sides = distances(face, front, margin, h);
  if (sides == 2u) {
    // Behind, unless `face` lies in the plane of `front`: then both are in one place.
    f64 back[3];
    return distances(front, face, margin, back) == 0u && front->order < face->order ? CLRAY_EVERYWHERE : CLRAY_NOWHERE;
  }
  f64 back[3];
  if (sides == 0u || distances(front, face, margin, back) == 0u)
    return front->order < face->order ? CLRAY_EVERYWHERE : CLRAY_NOWHERE;
  return sides == 1u ? CLRAY_EVERYWHERE : CLRAY_PARTLY;
}

/// The part of `front` where it hides the other face, as a polygon across the beam; h as hides() gave it.
CLRAY_FN void hiding_part(const CLRAY_GLOBAL ClrayFace* front, u32 where, const f64* h, Fragment* part) {
  part->corners = 0u;
  for (u32 i = 0; i < 3u; ++i) {
    const u32 j = i == 2u ? 0u : i + 1u;
    if (where == CLRAY_EVERYWHERE || h[i] >= 0.0) fragment_add(part, front->x[i], front->y[i]);
    if (where == CLRAY_EVERYWHERE || !((h[i] > 0.0 && h[j] < 0.0) || (h[i] < 0.0 && h[j] > 0.0))) continue;
    const f64 at = h[i] / (h[i] - h[j]);
    fragment_add(part, fma(at, front->x[j] - front->x[i], front->x[i]),
                 fma(at, front->y[j] - front->y[i], front->y[i]));
  }
  fragment_close(part);
}

#endif
