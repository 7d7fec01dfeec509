// SPDX-License-Identifier: Apache-2.0
// Whether a surface can hide any part of itself from outside.
#pragma once

#include <cstdint>
#include <vector>

#include "body/mesh_half_edges.hpp"

namespace clray {

/// `triangles`: nine numbers each. True if they lie in one plane, or form one closed, consistently wound surface that
/// is convex along every edge and has one summit (closed surfaces convex in every place are convex: van Heijenoort
/// 1952). False also if it cannot tell: with more than 2·10⁶ triangles. A few faces are tried first, since a point in
/// front of one of them settles the question without building anything.
bool convex_triangles(const std::vector<double>& triangles);

/// Fills `closed` and `convex` of the parts; `part_of` gives the part of each face of the half-edge mesh.
void judge_parts(const HalfEdges::Store& store, const std::vector<std::uint32_t>& part_of,
                 std::vector<MeshPart>& parts);

}  // namespace clray
