// SPDX-License-Identifier: Apache-2.0
// Primitives before they have their places in the tree, and which of their flat faces share a plane. Part frames,
// metres.
#pragma once

#include <cstdint>
#include <vector>

#include "body/bvh.hpp"
#include "body/shared_planes.hpp"

namespace clray {

/// A triangle with its nine coordinates, or an analytic shape with its record (abi.h).
struct RawPrimitive {
  std::uint32_t data = 0;  ///< offset in the numbers
  std::uint32_t size = 0;  ///< how many: 9 of a triangle, more of a shape
  std::uint32_t shape = 0, material = 0, component = 0, part = 0;
  std::uint32_t planes = CLRAY_NO_PLANES;  ///< offset of its planes' records in a list of them
};

/// Parts that a primitive's list of planes has room for.
std::uint32_t parts_of(const RawPrimitive& raw);

/// A box around a primitive, of which the numbers of all are given.
Box box_of(const RawPrimitive& raw, const std::vector<double>& numbers);
/// The nine numbers of a triangle; null for an analytic shape.
const double* corners_of(const RawPrimitive& raw, const std::vector<double>& numbers);

/// Whether all are triangles whose numbers follow one another.
bool are_triangles(const std::vector<RawPrimitive>& raw);
/// The numbers of primitives in another order: those of raw[order[0]] first. Some may be left out. `raw` may be empty
/// where are_triangles() holds.
std::vector<double> in_order(const std::vector<double>& numbers, const std::vector<RawPrimitive>& raw,
                             const std::vector<std::uint32_t>& order);
/// Primitives in another order, each with the place that its numbers had.
std::vector<RawPrimitive> in_order(const std::vector<RawPrimitive>& raw, const std::vector<std::uint32_t>& order);

/// The canonical order of primitives, materials and components left out: negative where `a` comes first, 0 where they
/// are the same.
int compared(const RawPrimitive& a, const RawPrimitive& b, const std::vector<double>& numbers);

/// Drops each primitive that is the same as the one before, of the same material. The numbers stand in the order of the
/// primitives; afterwards each says where its own are.
void drop_copies(std::vector<RawPrimitive>* raw, std::vector<double>* numbers);

/// Faces of primitives in canonical order that overlap in one plane.
SharedPlanes shared_planes_of(const std::vector<RawPrimitive>& primitives, const std::vector<double>& numbers);

}  // namespace clray
