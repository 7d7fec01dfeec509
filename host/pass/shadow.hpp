// SPDX-License-Identifier: Apache-2.0
// The Earth's shadow: how much of the Sun's disk a body sees past the Earth's ellipsoid (docs/physics.md, section 10).
#pragma once

#include "clray/scene.hpp"

namespace clray::pass {

/// The share of the Sun's disk that is seen from a place, in [0,1]: 0 in the umbra, 1 outside the penumbra. Earth-fixed
/// vectors, m; `sun_m` leads from the Earth's centre to the Sun's. The disk is of even brightness, the Earth an
/// ellipsoid without atmosphere.
double sun_share(const Vec3& place_m, const Vec3& sun_m);

/// The same for a disk and an ellipsoid of other sizes.
double visible_share(const Vec3& place_m, const Vec3& sun_m, double sun_radius_m, double radius_m, double flattening);

}  // namespace clray::pass
