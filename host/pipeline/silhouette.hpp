// SPDX-License-Identifier: Apache-2.0
// Where in the beam a body can be: the beam's rectangle is cut into a grid of equal cells; cells that nothing of the
// body projects into are left out (their rays must miss), and the others are put in order of the path length that light
// takes by way of them. The first Sobol dimension runs along that order, so its strata are strata of the delay
// histogram (sorting as in array-RQMC, L'Ecuyer, Lécot & Tuffin 2008). A cell has one or more slots, which are equally
// likely and cut it into columns: half of all slots go to cells alike, half to steps of path alike, so that delays
// which little of the body returns are not starved. The order and the slots only steer efficiency; a ray's weight is
// its slot's area, and no cell is missed (all tests err outward), so the estimate is unbiased. Plain fp64 without
// contraction: the same cells on every host. What it gains is measured in docs/error.md.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/geometry.hpp"
#include "shared/portable.h"

namespace clray {

/// A beam's rectangle: axes u, v across the beam, toward its source; corner and size along u and v, m.
struct BeamGrid {
  vec3 u, v, toward;
  vec3 path;  ///< path length by way of x is -path·x
  double u0, v0, size_u, size_v;
  std::uint32_t cells;  ///< along each edge; a power of two
};

/// Cells along an edge for a pass of `views` views: at most 2^18 cells in all, 8 … 512 along an edge.
std::uint32_t grid_cells(std::size_t views);

/// Two numbers a slot, in order of path length: row·grid + column of its cell, and its place among the cell's slots <<
/// 16 | their number. Empty if that is not worth its cost (all of the rectangle is then sampled evenly).
std::vector<std::uint32_t> silhouette_cells(const Geometry& geometry, const std::vector<RigidMotion>& motions,
                                            const BeamGrid& grid);

}  // namespace clray
