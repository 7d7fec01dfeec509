// SPDX-License-Identifier: Apache-2.0
// A half-edge view of triangles: which are neighbours, and what follows from that. It is OpenMesh's mesh, in double,
// whose headers stay behind it. Building it takes most of a second and about 100 MB for 10^6 triangles, so it is built
// where something is asked of it, never on loading.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// The material and component of a triangle. Neighbours with different labels are never merged.
struct FaceLabel {
  std::uint32_t slot = 0;       ///< material slot
  std::uint32_t component = 0;  ///< of the scene
  bool operator==(const FaceLabel& o) const { return slot == o.slot && component == o.component; }
};

/// Triangles that hang together by their edges.
struct MeshPart {
  std::uint64_t triangles = 0;
  bool closed = false;  ///< every edge has two triangles of one winding
  bool convex = false;  ///< closed, wound outward, convex along every edge, and once round itself
};

/// Neighbours in exactly one plane, of one label and one winding, as one polygon.
struct MeshPolygon {
  std::vector<std::uint32_t> triangles;           ///< ascending
  std::vector<std::vector<std::uint32_t>> loops;  ///< vertices; the outline counter-clockwise, then holes clockwise
};

class HalfEdges {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// Points of equal coordinates are one vertex here. `labels`: one a triangle, or none.
  HalfEdges(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
            const std::vector<FaceLabel>& labels = {});
  /// A mesh with its slots.
  explicit HalfEdges(const Mesh& mesh);
  ~HalfEdges();
  HalfEdges(const HalfEdges&) = delete;
  HalfEdges& operator=(const HalfEdges&) = delete;

  /// Triangles that share a directed edge with an earlier one. They have vertices of their own here, so that none is
  /// lost. Ascending.
  const std::vector<std::uint32_t>& refused() const;
  /// Triangles with two corners in one point, which are not here; ascending.
  const std::vector<std::uint32_t>& collapsed() const;

  /// The part of each triangle (kNone for collapsed ones) in `part_of`, if wanted; parts in order of their first
  /// triangle.
  std::vector<MeshPart> parts(std::vector<std::uint32_t>* part_of = nullptr) const;

  /// All triangles that have an area, merged as far as they go, in order of their first triangle. Vertices are indices
  /// of the points, the first of those that are equal.
  std::vector<MeshPolygon> polygons() const;

  /// The same surface in about `most` triangles or fewer, as far as its topology allows, for pictures of it. Vertices
  /// where refused triangles or several sheets meet stay in place.
  Mesh preview(std::size_t most) const;

  struct Store;

 private:
  std::unique_ptr<Store> store_;
};

}  // namespace clray
