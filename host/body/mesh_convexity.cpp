// SPDX-License-Identifier: Apache-2.0
// Convexity by the edges of the half-edge mesh. Coordinates in m; see mesh_convexity.hpp.
#include "body/mesh_convexity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/mesh_store.hpp"
#include "shared/portable.h"

namespace clray {

namespace {

constexpr std::size_t kMostTriangles = 2000000;
constexpr std::size_t kSamples = 16;
// Rounding of the orientation determinant, relative to the product of the edge lengths (Shewchuk 1997: (7 + 56ε)ε for
// exact differences; doubled for the rounding of vertices that were computed to lie in one plane).
constexpr double kFlat = 1e-14;

vec3 difference(const Vec3& a, const Vec3& b) {
  return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// The plane of a triangle.
struct Plane {
  Vec3 at;
  vec3 normal;

  Plane(const Vec3& a, const Vec3& b, const Vec3& c) : at(a), normal(v3_cross(difference(b, a), difference(c, a))) {}

  /// Positive: x lies beyond the plane, on its outer side. 0: on it, but for rounding.
  double beyond(const Vec3& x) const {
    const vec3 d = difference(x, at);
    const double height = v3_dot(normal, d);
    return std::fabs(height) <= kFlat * v3_length(normal) * v3_length(d) ? 0.0 : height;
  }
};

Plane plane_of(const OpenMeshT& mesh, OpenMesh::HalfedgeHandle half) {
  const auto corner = [&](OpenMesh::HalfedgeHandle h) { return to_vec3(mesh.point(mesh.from_vertex_handle(h))); };
  const auto next = mesh.next_halfedge_handle(half);
  return Plane(corner(half), corner(next), corner(mesh.next_halfedge_handle(next)));
}

// Each triangle's plane is taken from its own first corner, so that the answer does not depend on the edge asked.
bool convex_along(const OpenMeshT& mesh, OpenMesh::EdgeHandle edge) {
  const auto half = mesh.halfedge_handle(edge, 0), back = mesh.halfedge_handle(edge, 1);
  const auto opposite = [&](OpenMesh::HalfedgeHandle h) {
    return to_vec3(mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))));
  };
  const Plane a = plane_of(mesh, mesh.halfedge_handle(mesh.face_handle(half)));
  const Plane b = plane_of(mesh, mesh.halfedge_handle(mesh.face_handle(back)));
  const double height = a.beyond(opposite(back));
  if (height > 0.0 || b.beyond(opposite(half)) > 0.0) return false;
  // The two triangles are folded onto each other: the far vertex is in the plane, on the same side of the edge.
  return height != 0.0 || v3_dot(a.normal, b.normal) > 0.0;
}

// Whether a vertex is a summit: no neighbour lies farther along a direction that is square to no plane of a model. A
// closed surface that is convex along every edge has one summit if it is convex, and more if it winds round itself like
// the walls over a star: as many as the times that its normals cover the sphere.
bool is_summit(const OpenMeshT& mesh, OpenMesh::VertexHandle vertex) {
  const auto height = [&](OpenMesh::VertexHandle v) {
    const OpenMeshT::Point& p = mesh.point(v);
    return std::make_pair(0.5377 * p[0] + 0.6803 * p[1] + 0.4981 * p[2], p[0]);
  };
  const auto own = height(vertex);
  for (const auto neighbour : mesh.vv_range(vertex)) {
    if (height(neighbour) > own) return false;
  }
  return true;
}

}  // namespace

void judge_parts(const HalfEdges::Store& store, const std::vector<std::uint32_t>& part_of,
                 std::vector<MeshPart>& parts) {
  const OpenMeshT& mesh = store.mesh;
  for (MeshPart& part : parts) part.closed = part.convex = true;
  for (const auto face : mesh.faces()) {
    if (mesh.property(store.refused, face)) parts[part_of[static_cast<std::size_t>(face.idx())]].closed = false;
  }
  for (const auto edge : mesh.edges()) {
    auto half = mesh.halfedge_handle(edge, 0);
    if (mesh.is_boundary(half)) half = mesh.halfedge_handle(edge, 1);
    MeshPart& part = parts[part_of[static_cast<std::size_t>(mesh.face_handle(half).idx())]];
    if (mesh.is_boundary(edge)) part.closed = false;
    if (part.convex && part.closed) part.convex = convex_along(mesh, edge);
  }
  std::vector<std::uint64_t> summits(parts.size(), 0);
  for (const auto vertex : mesh.vertices()) {
    auto half = mesh.halfedge_handle(vertex);
    if (mesh.is_boundary(half)) half = mesh.opposite_halfedge_handle(half);
    const std::uint32_t p = part_of[static_cast<std::size_t>(mesh.face_handle(half).idx())];
    if (parts[p].convex && parts[p].closed) summits[p] += is_summit(mesh, vertex);
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
    parts[p].convex = parts[p].convex && parts[p].closed && summits[p] == 1;
}

bool convex_triangles(const std::vector<double>& triangles) {
  const std::size_t count = triangles.size() / 9;
  if (count == 0 || count > kMostTriangles) return false;
  std::vector<Vec3> points(3 * count);
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k] = Vec3(triangles[3 * k], triangles[3 * k + 1], triangles[3 * k + 2]);
  const auto plane = [&](std::size_t t) { return Plane(points[3 * t], points[3 * t + 1], points[3 * t + 2]); };
  const Plane first = plane(0);
  if (std::all_of(points.begin(), points.end(), [&](const Vec3& x) { return first.beyond(x) == 0.0; })) return true;
  // No point of a convex body lies in front of a face. A few faces show that most other bodies are not convex.
  for (std::size_t k = 0; k < kSamples; ++k) {
    const Plane sample = plane(k * count / kSamples);
    const vec3 n = sample.normal;
    const double slack = 1e-9 * v3_length(n);
    const bool before = std::any_of(points.begin(), points.end(), [&](const Vec3& x) {
      const vec3 d = difference(x, sample.at);
      return v3_dot(n, d) > slack * v3_length(d);
    });
    if (before) return false;
  }
  std::vector<std::array<std::uint32_t, 3>> corners(count);
  for (std::uint32_t t = 0; t < count; ++t) corners[t] = {3 * t, 3 * t + 1, 3 * t + 2};
  const HalfEdges half_edges(points, corners);
  const std::vector<MeshPart> parts = half_edges.parts();
  return parts.size() == 1 && parts[0].convex && half_edges.collapsed().empty();
}

}  // namespace clray
