// SPDX-License-Identifier: Apache-2.0
// Which faces of one plane overlap, and which of those look the same way with different materials. Outlines are swept
// along one axis of the plane in stripes along the other. A pair is compared only where that can still change what is
// known of one of the two, so a million faces in one place cost a million comparisons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clray {

/// The outline of a face: a convex polygon, seen counter-clockwise from its front, less a round hole.
struct FaceOutline {
  std::vector<std::array<double, 3>> corners;
  std::array<double, 3> centre{{0.0, 0.0, 0.0}};  ///< of the hole
  double hole_radius = 0.0;                       ///< 0: no hole
};

/// A face in its plane.
struct PlaneFace {
  FaceOutline outline;
  bool front = true;  ///< looks along the plane's normal
  std::uint32_t material = 0;
};

/// What is found, one entry a face.
struct PlaneOverlaps {
  std::vector<char> shared;       ///< it overlaps another
  std::vector<char> conflicting;  ///< one of another material that looks the same way
  std::uint64_t compared = 0;     ///< pairs whose outlines were compared
};

/// Finds them among `count` faces of a plane with this normal.
PlaneOverlaps find_overlaps(const PlaneFace* faces, std::size_t count, const std::array<double, 3>& normal);

}  // namespace clray
