// SPDX-License-Identifier: Apache-2.0
// Where in the beam a body can be: the beam's rectangle is cut into a grid of equal cells, and the body is drawn into
// it with a depth buffer. A cell that stays empty cannot be met by any ray (all tests err outward); of the others the
// surface nearest to the source at the cell's centre is kept, to steer sampling (strata.hpp). Lengths in m, in the
// beam's axes (u, v, toward the source). Plain fp64 without contraction: the same cells on every host.
#pragma once

#include <cstdint>
#include <vector>

#include "body/geometry.hpp"
#include "shared/portable.h"

namespace clray {

/// A beam's rectangle: axes u, v across the beam, toward its source; corner and size along u and v, m.
struct BeamGrid {
  vec3 u, v, toward;
  double u0, v0, size_u, size_v;
  std::uint32_t cells;  ///< along each edge; a power of two
};

/// What a cell shows to the source.
struct BeamCell {
  enum State : std::uint8_t { empty, touched, centred };
  State state = empty;          ///< centred: the surface is the one at the cell's centre
  std::uint32_t primitive = 0;  ///< index into Geometry::primitives
  double w = 0.0;               ///< of the surface, along `toward`, at the centre (touched: somewhere near)
  bool back = false;            ///< the source sees the surface's back
  vec3 normal{};                ///< of any length, beam's axes, on the source's side; zero where not known
};

/// Cells along an edge: 64, for finer ones gain nothing (docs/sampling.md), or fewer where there are more than 4096
/// `views`: at most 2^24 cells in all, at least 8 along an edge.
std::uint32_t grid_cells(std::size_t views);

/// The grid's cells by rows, or none where drawing them would take more than about a second.
std::vector<BeamCell> silhouette_cells(const Geometry& geometry, const std::vector<RigidMotion>& motions,
                                       const BeamGrid& grid);

}  // namespace clray
