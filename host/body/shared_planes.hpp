// SPDX-License-Identifier: Apache-2.0
// Faces that lie in one plane and overlap: two sheets back to back, a panel on the wall of a box, a face that a file
// holds twice. A ray meets all of them at one distance, which rounding must not decide. Such faces are found here,
// once, whatever their order, and get one set of coefficients of their plane; the device takes the distance from those
// and chooses by which face looks at the ray (kernels/stage/intersect.cl). Part frames, metres.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "body/bvh.hpp"
#include "body/plane_overlaps.hpp"
#include "shared/abi.h"

namespace clray {

/// A flat face: a triangle, or a flat part of an analytic shape. Faces are numbered in canonical order.
struct FlatFace {
  std::uint32_t primitive = 0;  ///< its place in the canonical order
  std::uint32_t part = 0;       ///< of an analytic shape
  std::uint32_t frame = 0;      ///< faces of different frames move against each other and are never compared
  std::uint32_t material = 0;
};

/// What the device needs of one face that shares its plane: see CLRAY_PLANE_* in abi.h.
struct SharedPlane {
  std::uint32_t primitive = 0, part = 0;
  std::array<double, CLRAY_PLANE_SIZE> record{};
};

struct SharedPlanes {
  std::vector<SharedPlane> faces;  ///< ascending primitive, then part
  std::uint64_t conflicts = 0;     ///< faces that overlap one of another material which looks the same way
  std::uint64_t compared = 0;      ///< pairs of faces whose outlines were compared
};

/// Gives the outlines of faces.
class FaceSource {
 public:
  virtual ~FaceSource() = default;
  virtual void outline(const FlatFace& face, FaceOutline* out) const = 0;
};

/// Finds the faces of `faces` that overlap another in the same plane. Two planes are one where the corners of either
/// face lie on that of the other to 32 roundings of the coordinates.
SharedPlanes find_shared_planes(const std::vector<FlatFace>& faces, const FaceSource& source);

}  // namespace clray
