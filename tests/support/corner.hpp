// SPDX-License-Identifier: Apache-2.0
// Two plates at a right angle: the floor z = 0, x >= 0 and the wall x = 0, z >= 0, with their common edge along y.
// Light from within the angle reaches both whole, and all of both is seen. Closed forms of one and two reflections from
// Lambert plates: the form factor of rectangles with a common edge (Howell's catalogue, C-14). m, m²/sr.
#pragma once

#include "support/scenes.hpp"

namespace clray_test {

constexpr double kFloor = 2.0, kWall = 1.5, kEdge = 1.0;  ///< lengths from the common edge, and the edge's

MeshPtr floor_mesh();
MeshPtr wall_mesh();

/// Monostatic from s, with the exact method as far as it goes and so many rays.
clray::Scene corner(const clray::Material& floor, const clray::Material& wall, const clray::Vec3& s, int bounces,
                    int log2_rays = 12);

/// Share of the light of the floor that meets the wall.
double form_factor();

/// A of one and of two reflections in a corner of Lambert plates, both within the angle of source and observer.
struct CornerLight {
  double first = 0.0, second = 0.0;
};
CornerLight corner_light(double floor_rho, double wall_rho, const clray::Vec3& s, const clray::Vec3& o);

}  // namespace clray_test
