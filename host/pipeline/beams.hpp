// SPDX-License-Identifier: Apache-2.0
// The beams of a pass: for every orientation the rectangle that rays start from, the directions that hits are connected
// to, and where hinged parts stand. Body frame, metres.
#pragma once

#include "pipeline/plan.hpp"

namespace clray {

/// Where the rays of a pass start, what hits are connected to, and where hinged parts stand. Strata come later.
Beams build_beams(const Scene& scene, const Geometry& geometry, const PassRequest& request);

/// Where the parts of the body stand in an orientation.
std::vector<RigidMotion> motions_of(const Scene& scene, const Geometry& geometry, const Orientation& orientation);

/// Path lengths of one bounce over all views.
PathRange path_range(const Scene& scene, const Geometry& geometry, const PassRequest& request, const Beams& beams);

}  // namespace clray
