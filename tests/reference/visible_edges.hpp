// SPDX-License-Identifier: Apache-2.0
// The judge of exact visibility for larger soups: visible areas by walks along edges, in long double. The visible part
// of a triangle is bounded by its own edges, by edges of triangles in front of it, and by the lines along which
// triangles pass through one another. Along each of these segments the visible face on either side is found from the
// upper envelope of the depths of all triangles, and Green's theorem makes areas of the segments. It shares no formula
// with kernels/ or host/, and no step with the scanlines of visible_area.hpp.
#pragma once

#include <vector>

#include "visible_area.hpp"

namespace clray_reference {

/// The area across z in which each triangle is seen from far up the z axis. Triangles are in general position: none lie
/// in one plane, and no edges coincide.
std::vector<long double> visible_areas_by_edges(const std::vector<SoupTriangle>& soup);

}  // namespace clray_reference
