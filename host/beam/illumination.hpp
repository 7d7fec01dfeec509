// SPDX-License-Identifier: Apache-2.0
// The views of a scene: times, how the body stands, where light comes from and how strong it is, who looks from where
// and how far away. A motion makes views, and so does a grid of light directions. What follows does not ask where a
// view came from. A pass computes its own (host/pass).
#pragma once

#include <vector>

#include "clray/result.hpp"

namespace clray {

/// The instants of the scene's motion (one without motion), or those of its pass that are traced. Ranges that are not
/// known at a time are 0.
std::vector<Orientation> views_of_motion(const Scene& scene);

/// Directions of the light on a grid, body frame: elevations (from the xy plane) from -90 to 90 degrees inclusive,
/// azimuths (from +x toward +y) from 0 to 360 exclusive, one at the poles. Everything else is as where the motion
/// starts; an observer at the source moves with it.
std::vector<Orientation> views_of_grid(const Scene& scene, int azimuths, int elevations);

/// Unit vector at an azimuth (from +x toward +y) and an elevation (from the xy plane), degrees; exact at right angles.
Vec3 direction_from_degrees(double azimuth_deg, double elevation_deg);

}  // namespace clray
