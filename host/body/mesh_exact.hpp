// SPDX-License-Identifier: Apache-2.0
// Exact signs of orientation: on which side of a line or a plane a point lies, for any doubles, with no tolerance.
// Source: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997.
#pragma once

#include "clray/scene.hpp"

namespace clray {

/// Sign of (b − a) × (c − a) · (d − a): 1 where d lies on the side from which a, b, c turn counter-clockwise, -1 on the
/// other, 0 exactly where the four lie in one plane.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the component `axis` of (b − a) × (c − a).
int turn_sign(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// The axis along which the projected area of a triangle is largest (but for rounding) and not zero. -1 exactly if its
/// corners lie on one line.
int area_axis(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace clray
