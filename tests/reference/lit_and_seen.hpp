// SPDX-License-Identifier: Apache-2.0
// The judge of exact visibility in two directions: how much of each triangle is lit from one direction and seen from
// another. It works in the plane of the triangle, on which every other triangle casts a shadow along each direction; no
// beam has a frame here. Scanlines in long double measure what no shadow covers. For soups of some tens of triangles.
// It shares no formula with kernels/ or host/.
#pragma once

#include <vector>

#include "visible_area.hpp"

namespace clray_reference {

/// The area, m², of each triangle that is lit from `source` and seen from `observer` (unit vectors), both on the same
/// side of it. Triangles are in general position: none lie in one plane.
std::vector<long double> lit_and_seen_areas(const std::vector<SoupTriangle>& soup, const std::array<double, 3>& source,
                                            const std::array<double, 3>& observer);

/// Of each triangle the cosine of the angle between its normal (either side) and a direction.
std::vector<long double> cosines(const std::vector<SoupTriangle>& soup, const std::array<double, 3>& direction);

}  // namespace clray_reference
