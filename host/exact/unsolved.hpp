// SPDX-License-Identifier: Apache-2.0
// Where curved shapes stand among flat faces: the primitives whose first bounce rays must find, since curved shapes
// reflect it or may shade it. That of all other faces is solved as if no curved shape were there.
#pragma once

#include <cstdint>
#include <vector>

#include "body/geometry.hpp"
#include "shared/portable.h"

namespace clray {

/// A bit for each primitive of each view; 1: its first bounce is not solved.
struct UnsolvedPrimitives {
  std::uint32_t words = 0;  ///< of a view
  std::vector<std::uint32_t> bits;

  bool has(std::size_t view, std::uint32_t primitive) const {
    return !bits.empty() && (bits[view * words + (primitive >> 5)] >> (primitive & 31u) & 1u) != 0;
  }
};

/// Whether a primitive is made of polygons: a face of a mesh, a box, a rectangle.
bool made_of_polygons(const Geometry& geometry, const ClrayPrimitive& primitive);

/// Whether any primitive is, or all are.
bool any_polygons(const Geometry& geometry);
bool all_polygons(const Geometry& geometry);

/// Appends a view to *out: curved shapes, and polygons that one of them may hide from any of the directions that the
/// body is lit and seen from (unit vectors). It takes too many rather than too few: a shape stands for the cells that
/// its rectangle meets, of a grid across the beam.
void add_unsolved(const Geometry& geometry, const std::vector<RigidMotion>& motions, const std::vector<vec3>& toward,
                  UnsolvedPrimitives* out);

}  // namespace clray
