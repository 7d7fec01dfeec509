// SPDX-License-Identifier: Apache-2.0
// The views of a pass: for every orientation the rectangle that rays start from, the directions that hits are connected
// to, and where hinged parts stand. Body frame, metres.
#pragma once

#include "pipeline/plan.hpp"

namespace clray {

/// Fills views, connections, instances, nodes, areas and (for pictures) the image axes of a pass.
void build_views(const Scene& scene, const Geometry& geometry, PassPlan* plan);

/// Where the parts of the body stand in an orientation.
std::vector<RigidMotion> motions_of(const Scene& scene, const Geometry& geometry, const Orientation& orientation);

/// Least and greatest path length (relative to the reference point) of one bounce in view v toward connection c.
void path_extent(const Scene& scene, const Geometry& geometry, const PassPlan& plan, std::size_t v, std::uint32_t c,
                 double* low, double* high);

/// Unit vector at an azimuth (from +x toward +y) and an elevation (from the xy plane), degrees; exact at right angles.
Vec3 direction_from_degrees(double azimuth_deg, double elevation_deg);

}  // namespace clray
