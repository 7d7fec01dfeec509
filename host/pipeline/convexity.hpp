// SPDX-License-Identifier: Apache-2.0
// Whether a set of triangles can hide any part of itself from outside.
#pragma once

#include <vector>

namespace clray {

/// `triangles`: nine numbers each. True if they lie in one plane, or form one closed, consistently wound surface of
/// the topology of a sphere that is convex along every edge (locally convex closed surfaces are convex: van Heijenoort
/// 1952). False also where it cannot tell: more than 2·10⁶ triangles.
bool convex_triangles(const std::vector<double>& triangles);

}  // namespace clray
