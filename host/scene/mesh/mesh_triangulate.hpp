// SPDX-License-Identifier: Apache-2.0
// Splits a polygon into triangles that keep its winding and, where it is plane and simple, its area.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// What became of a polygon.
enum class Triangulation {
  exact,     ///< the triangles cover the polygon once
  crossing,  ///< the outline crosses itself or has no plane: a fan from its first corner
};

/// Concave polygons with more corners than this are refused: ear clipping takes seconds for them.
constexpr std::size_t kMaxConcaveCorners = 100000;

/// Appends the triangles (corner positions 0 … n-1 of the polygon, n-2 triangles) to `triangles`.
/// Throws Error(input) without context for a concave polygon of too many corners.
Triangulation triangulate(const std::vector<Vec3>& corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clray
