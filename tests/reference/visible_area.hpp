// SPDX-License-Identifier: Apache-2.0
// The judge of exact visibility: the visible area of triangles seen from far up the z axis, by scanlines, in long
// double. Between two neighbouring heights at which anything changes (corners, crossings of edges, and of the lines
// along which triangles pass through one another) the visible length is linear in y, so the midpoint rule is exact.
// Quadratic in the number of triangles and more: for small soups. It shares no formula with kernels/ or host/.
#pragma once

#include <array>
#include <vector>

namespace clray_reference {

struct SoupTriangle {
  std::array<std::array<double, 3>, 3> corners;
};

/// The area across z in which each triangle is seen. Triangles are in general position: none lie in one plane.
std::vector<long double> visible_areas(const std::vector<SoupTriangle>& soup);

}  // namespace clray_reference
