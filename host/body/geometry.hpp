// SPDX-License-Identifier: Apache-2.0
// From a scene's components to primitives, trees and exact bounds. Static components share one part, in the body
// frame; each hinged component is a part of its own, which a view carries into place. Primitives are ranked in a
// canonical order of their content, so no result depends on their place in a file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "body/bvh.hpp"
#include "clray/result.hpp"
#include "shared/abi.h"

namespace clray {

using Point = std::array<double, 3>;

/// A set of primitives that move together.
struct Part {
  int hinged_component = -1;  ///< -1: static
  std::uint32_t root = 0;     ///< in Geometry::nodes
  BoxFrame frame;
  Box box;                            ///< in the part's frame (hinge at angle 0)
  std::vector<Point> points;          ///< vertices of its triangles
  std::vector<std::uint32_t> shapes;  ///< offsets in Geometry::shapes of its analytic shapes
  std::vector<int> shape_rows;        ///< their rows in shape.def
};

/// A rigid motion body -> part: x_part = rotation·x + translation.
struct RigidMotion {
  std::array<double, 9> rotation{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Point translation{{0, 0, 0}};

  /// Where a point of the part is in the body.
  Point back(const Point& part) const;
};

struct Geometry {
  std::vector<ClrayPrimitive> primitives;
  std::vector<double> shapes;
  std::vector<ClrayNode> nodes;
  /// What the leaves hold, where a face stands in several: numbers of primitives. Empty: each primitive in its order.
  std::vector<std::uint32_t> leaves;
  std::vector<Part> parts;      ///< static part first, if there is one
  std::vector<int> shape_rows;  ///< rows of shape.def in use, ascending
  std::vector<std::uint32_t> part_of_component;
  std::uint32_t stack_needed = 1;  ///< of the deepest tree
  bool trees = true;               ///< false: there are no nodes, and no ray can be traced
  bool single = false;             ///< one component, and no faces in one place
  bool shared_planes = false;      ///< faces overlap in one plane
  std::uint64_t conflicts = 0;     ///< such faces that overlap one of another material which looks the same way
  MeshReport report;
  Point centre{{0, 0, 0}};  ///< of the bounding sphere over all hinge angles
  double radius = 0.0;
  double extent = 0.0;  ///< longest side of the box around it, over all hinge angles

  /// Whether the body is convex, so that it hides no part of itself. The first answer takes time for a mesh, so ask
  /// only if it matters.
  bool convex() const;

 private:
  mutable std::optional<bool> convex_{};
};

/// How materials are ordered where faces of several lie in one place: the rank of each, by content. Nothing else of a
/// material matters to the geometry.
std::vector<std::uint32_t> material_ranks(const Scene& scene);

/// What trees hold. Without them no ray can be traced.
enum class TreeFaces { none, whole, pieces };

/// Builds everything that does not depend on the view. Throws Error(input) if nothing can be hit.
Geometry build_geometry(const Scene& scene, TreeFaces faces = TreeFaces::pieces);

/// Fills Geometry::leaves where it is empty, with each primitive in its order.
void list_leaves(Geometry* geometry);

/// Where a hinged part stands in a view.
RigidMotion part_motion(const Scene& scene, const Part& part, const Vec3& source, const Vec3& observer);

/// A matrix, by rows, times a vector.
Point rotated(const std::array<double, 9>& matrix, const Point& x);

/// Least and greatest x·direction over an analytic shape, whose numbers stand at `data` in Geometry::shapes.
void shape_extent(const Geometry& geometry, int row, std::uint32_t data, const RigidMotion& motion,
                  const Point& direction, double* low, double* high);

/// The area of a primitive, m².
double primitive_area(const Geometry& geometry, const ClrayPrimitive& primitive);

/// Least and greatest x·direction over the body with its parts in place (exact up to rounding).
void body_extent(const Geometry& geometry, const std::vector<RigidMotion>& motions, const Point& direction, double* low,
                 double* high);

}  // namespace clray
