// SPDX-License-Identifier: Apache-2.0
// The buffers of an exact pass, in the order of the kernel's arguments. One row makes the argument, the member of Exact
// (exact/leaf.cl) and the host's binding (host/pipeline/exact_pass.cpp). X(type, name)
#ifndef CLRAY_EXACT_BUFFERS_H
#define CLRAY_EXACT_BUFFERS_H

// What a pass reads: faces of all views, the weights of each face's lanes, tiles, their lists of faces (the
// largest first), items (a tile and a face each), the windows of delay detectors, and where lit pieces are taken up
// again one for each item. Then what it adds to: sums of each face, bins, items that are not finished (their number,
// then an item and its fragments each), and lit pieces for observers elsewhere (their number and what there is room
// for; more are not kept).
#define CLRAY_EXACT_BUFFERS(X)                 \
  X(const CLRAY_GLOBAL ClrayFace, faces)       \
  X(const CLRAY_GLOBAL f64, weights)           \
  X(const CLRAY_GLOBAL ClrayTile, tiles)       \
  X(const CLRAY_GLOBAL ClrayListed, lists)     \
  X(const CLRAY_GLOBAL u32, items)             \
  X(const CLRAY_GLOBAL ClrayBinning, binnings) \
  X(const CLRAY_GLOBAL ClrayPiece, pieces)     \
  X(volatile CLRAY_GLOBAL i64, sums)           \
  X(volatile CLRAY_GLOBAL i64, bins)           \
  X(volatile CLRAY_GLOBAL u32, unfinished)     \
  X(CLRAY_GLOBAL ClrayPiece, lit)              \
  X(volatile CLRAY_GLOBAL u32, lit_count)

// What the sampling of a view's tiles reads: faces, weights, tiles, their lists of faces, windows, and what the points
// are for. For an observer elsewhere: where each face is in the beam of the light, the faces of that beam, which of
// them may shade each tile (the first and the number in the list behind). Then what it writes: what each point brings,
// sums of each lane and replicate, bins, and hits of the bins.
#define CLRAY_SAMPLE_BUFFERS(X)                 \
  X(const CLRAY_GLOBAL ClrayFace, faces)        \
  X(const CLRAY_GLOBAL f64, weights)            \
  X(const CLRAY_GLOBAL ClrayTile, tiles)        \
  X(const CLRAY_GLOBAL u32, listed)             \
  X(const CLRAY_GLOBAL ClrayCarried, carried)   \
  X(const CLRAY_GLOBAL ClrayFace, lit_faces)    \
  X(const CLRAY_GLOBAL u32, shaded)             \
  X(const CLRAY_GLOBAL u32, blockers)           \
  X(const CLRAY_GLOBAL ClrayBinning, binnings)  \
  X(const CLRAY_GLOBAL ClraySampling, sampling) \
  X(CLRAY_GLOBAL f64, values)                   \
  X(volatile CLRAY_GLOBAL i64, sums)            \
  X(volatile CLRAY_GLOBAL i64, bins)            \
  X(volatile CLRAY_GLOBAL u32, hits)

#endif
