// SPDX-License-Identifier: Apache-2.0
// What HalfEdges holds: an OpenMesh mesh and what else is known of its triangles. Only the files that implement
// HalfEdges include it.
#pragma once

#include "body/mesh_half_edges.hpp"

// GCC 12 sees the temporary inside OpenMesh's Property.hh as unset when it inlines push_back.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <utility>
#include <vector>

namespace clray {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  EdgeAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
};
using OpenMeshT = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

struct HalfEdges::Store {
  OpenMeshT mesh;
  OpenMesh::VPropHandleT<std::uint32_t> point;   // index of the point, the first of equal ones
  OpenMesh::VPropHandleT<bool> shared;           // another vertex is at the same point
  OpenMesh::FPropHandleT<std::uint32_t> origin;  // index of the triangle
  OpenMesh::FPropHandleT<FaceLabel> label;
  OpenMesh::FPropHandleT<bool> refused;
  std::vector<std::string> slots;  // of the Mesh, if it is of one
  std::vector<std::uint32_t> refused_triangles, collapsed_triangles;
  std::vector<std::pair<int, int>> touching;  // faces that share an edge which the mesh cannot share
  std::size_t triangles = 0;                  // collapsed ones included
};

inline Vec3 to_vec3(const OpenMesh::Vec3d& p) {
  return Vec3(p[0], p[1], p[2]);
}

}  // namespace clray
