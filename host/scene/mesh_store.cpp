// SPDX-License-Identifier: Apache-2.0
// OpenMesh holds the mesh (a half-edge structure, metres, double) and gives its area and degenerate triangles.
// Edges are not counted here: copied vertices would show as boundaries that the file does not have.
#include "scene/mesh_store.hpp"

// GCC 12 sees the temporary inside OpenMesh's Property.hh as unset when it inlines push_back.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "scene/mesh_quiet.hpp"

namespace clray {

namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  EdgeAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
};
using Store = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

// OpenMesh walks all edges of a vertex for every face that joins it; a fresh copy after this many faces keeps
// a fan of a million triangles from taking a million million steps.
constexpr std::uint32_t kMaxValence = 512;

class Builder {
 public:
  Builder(const std::vector<Vec3>& vertices, std::size_t triangles)
      : vertices_(vertices), instance_(vertices.size()), uses_(vertices.size(), 0) {
    store_.reserve(vertices.size(), triangles + triangles / 2, triangles);
  }

  void add(const std::array<std::uint32_t, 3>& t) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
      Store::VertexHandle shared[3] = {handle(t[0]), handle(t[1]), handle(t[2])};
      if (store_.add_face(shared, 3).is_valid()) return;
    }
    ++copied_;
    Store::VertexHandle own[3] = {copy(t[0]), copy(t[1]), copy(t[2])};
    if (!store_.add_face(own, 3).is_valid()) {
      throw Error(ErrorCode::bug, "OpenMesh refused a triangle with vertices of its own");
    }
  }

  const Store& store() const { return store_; }
  std::uint64_t copied() const { return copied_; }

 private:
  Store::VertexHandle copy(std::uint32_t v) {
    return store_.add_vertex(Store::Point(vertices_[v].x, vertices_[v].y, vertices_[v].z));
  }

  Store::VertexHandle handle(std::uint32_t v) {
    if (uses_[v]++ % kMaxValence == 0) instance_[v] = copy(v);
    return instance_[v];
  }

  const std::vector<Vec3>& vertices_;
  Store store_;
  std::vector<Store::VertexHandle> instance_;
  std::vector<std::uint32_t> uses_;
  std::uint64_t copied_ = 0;
};

// No higher over its longest edge than four units in the last place of its coordinates: corners that lie on a line
// in decimal need not do so once each is rounded to double.
bool is_degenerate(const Store::Point& a, const Store::Point& b, const Store::Point& c, double twice_area) {
  double largest = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (const Store::Point* p : {&a, &b, &c}) largest = std::max(largest, std::fabs((*p)[k]));
  }
  const double longest = std::sqrt(std::max({(b - a).sqrnorm(), (c - b).sqrnorm(), (a - c).sqrnorm()}));
  return twice_area <= 4.0 * 0x1p-52 * largest * longest;
}

}  // namespace

StoreReport store_and_measure(const std::vector<Vec3>& vertices,
                              const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const QuietOpenMesh quiet;
  Builder builder(vertices, triangles.size());
  for (const auto& t : triangles) builder.add(t);
  const Store& store = builder.store();
  StoreReport report;
  report.copied_faces = builder.copied();
  double sum = 0.0, lost = 0.0;  // compensated (Neumaier 1974): ten million terms keep all digits
  for (const auto face : store.faces()) {
    const auto edge = store.halfedge_handle(face);
    const double area = store.calc_sector_area(edge);
    const auto next = store.next_halfedge_handle(edge);
    if (is_degenerate(store.point(store.from_vertex_handle(edge)), store.point(store.to_vertex_handle(edge)),
                      store.point(store.to_vertex_handle(next)), 2.0 * area)) {
      ++report.degenerate;
    }
    const double total = sum + area;
    lost += sum >= area ? (sum - total) + area : (area - total) + sum;
    sum = total;
  }
  report.area_m2 = sum + lost;
  return report;
}

}  // namespace clray
