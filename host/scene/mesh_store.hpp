// SPDX-License-Identifier: Apache-2.0
// The mesh as OpenMesh holds it: a half-edge structure in double that every triangle enters, checked and measured.
// Hides OpenMesh, whose headers are slow to compile, from the rest of host/scene.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// What OpenMesh measures.
struct StoreReport {
  double area_m2 = 0.0;
  std::uint64_t degenerate = 0;    ///< triangles no higher than the rounding of their coordinates
  std::uint64_t copied_faces = 0;  ///< entered with copied vertices: non-manifold, flipped or double ones
};

/// Enters all triangles into an OpenMesh mesh and measures it. Every triangle is kept: what a half-edge
/// structure cannot share an edge or vertex with enters with copies of its vertices.
StoreReport store_and_measure(const std::vector<Vec3>& vertices,
                              const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clray
