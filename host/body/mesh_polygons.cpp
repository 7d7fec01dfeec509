// SPDX-License-Identifier: Apache-2.0
// Merges neighbours that lie exactly in one plane into polygons, and walks round these. Two triangles with a common
// edge lie in one plane if their four corners do. The test is exact, so it holds from neighbour to neighbour.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "body/mesh_exact.hpp"
#include "body/mesh_store.hpp"
#include "shared/portable.h"

namespace clray {

namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

class Merger {
 public:
  explicit Merger(const HalfEdges::Store& store) : store_(store), mesh_(store.mesh) {}

  std::vector<MeshPolygon> merge() {
    axis_.resize(mesh_.n_faces());
    for (const auto face : mesh_.faces()) {
      const Corners p = corners(face);
      axis_[at(face)] = area_axis(p[0], p[1], p[2]);
    }
    parent_.resize(mesh_.n_faces());
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (const auto edge : mesh_.edges()) {
      if (!mesh_.is_boundary(edge) && one_plane(mesh_.halfedge_handle(edge, 0), mesh_.halfedge_handle(edge, 1))) {
        const std::uint32_t a = root(mesh_.face_handle(mesh_.halfedge_handle(edge, 0)));
        const std::uint32_t b = root(mesh_.face_handle(mesh_.halfedge_handle(edge, 1)));
        parent_[std::max(a, b)] = std::min(a, b);
      }
    }
    collect();
    return std::move(polygons_);
  }

 private:
  using Corners = std::array<Vec3, 3>;

  static std::size_t at(FaceHandle face) { return static_cast<std::size_t>(face.idx()); }
  std::uint32_t root(FaceHandle face) { return find_root(parent_, static_cast<std::uint32_t>(face.idx())); }

  Vec3 from(HalfedgeHandle half) const { return to_vec3(mesh_.point(mesh_.from_vertex_handle(half))); }

  Corners corners(FaceHandle face) const {
    const auto half = mesh_.halfedge_handle(face), next = mesh_.next_halfedge_handle(half);
    return {from(half), from(next), from(mesh_.next_halfedge_handle(next))};
  }

  bool one_plane(HalfedgeHandle half, HalfedgeHandle back) const {
    const FaceHandle a = mesh_.face_handle(half), b = mesh_.face_handle(back);
    if (axis_[at(a)] < 0 || axis_[at(b)] < 0) return false;
    if (!(mesh_.property(store_.label, a) == mesh_.property(store_.label, b))) return false;
    const Corners p = corners(a), q = corners(b);
    const Vec3 far = to_vec3(mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(back))));
    if (side_of_plane(p[0], p[1], p[2], far) != 0) return false;
    // Both look to the same side; otherwise one is folded onto the other.
    return turn_sign(p[0], p[1], p[2], axis_[at(a)]) == turn_sign(q[0], q[1], q[2], axis_[at(a)]);
  }

  void collect() {
    number_.assign(mesh_.n_faces(), HalfEdges::kNone);
    for (const auto face : mesh_.faces()) {
      if (axis_[at(face)] < 0) continue;
      const std::uint32_t first = root(face);
      if (first == at(face)) {
        number_[first] = static_cast<std::uint32_t>(polygons_.size());
        polygons_.emplace_back();
      }
      number_[at(face)] = number_[first];
      polygons_[number_[first]].triangles.push_back(mesh_.property(store_.origin, face));
    }
    loops_.resize(polygons_.size());
    std::vector<bool> walked(mesh_.n_halfedges(), false);
    for (const auto half : mesh_.halfedges()) {
      if (!on_outline(half) || walked[static_cast<std::size_t>(half.idx())]) continue;
      walk(half, walked);
    }
    for (std::size_t p = 0; p < polygons_.size(); ++p) {
      std::vector<Loop>& loops = loops_[p];
      std::stable_sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) { return a.area > b.area; });
      for (Loop& loop : loops) polygons_[p].loops.push_back(std::move(loop.vertices));
    }
  }

  std::uint32_t number(HalfedgeHandle half) const {
    return mesh_.is_boundary(half) ? HalfEdges::kNone : number_[at(mesh_.face_handle(half))];
  }

  bool on_outline(HalfedgeHandle half) const {
    return number(half) != HalfEdges::kNone && number(half) != number(mesh_.opposite_halfedge_handle(half));
  }

  // Along the outline with the polygon on the left.
  void walk(HalfedgeHandle start, std::vector<bool>& walked) {
    const FaceHandle face = mesh_.face_handle(start);
    const Corners p = corners(face);
    const int axis = axis_[at(face)], i = (axis + 1) % 3, j = (axis + 2) % 3;
    const Vec3 origin = from(start);
    Loop loop;
    HalfedgeHandle half = start;
    do {
      walked[static_cast<std::size_t>(half.idx())] = true;
      loop.vertices.push_back(mesh_.property(store_.point, mesh_.from_vertex_handle(half)));
      const Vec3 a = from(half) - origin;
      half = mesh_.next_halfedge_handle(half);
      while (!on_outline(half)) half = mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(half));
      const Vec3 b = from(half) - origin;
      loop.area += difference_of_products(a[i], b[j], a[j], b[i]);
    } while (half != start);
    loop.area *= turn_sign(p[0], p[1], p[2], axis);
    std::rotate(loop.vertices.begin(), std::min_element(loop.vertices.begin(), loop.vertices.end()),
                loop.vertices.end());
    loops_[number(start)].push_back(std::move(loop));
  }

  struct Loop {
    double area = 0.0;  // as projected; of a hole negative
    std::vector<std::uint32_t> vertices;
  };

  const HalfEdges::Store& store_;
  const OpenMeshT& mesh_;
  std::vector<int> axis_;  // along which each face has an area
  std::vector<std::uint32_t> parent_, number_;
  std::vector<MeshPolygon> polygons_;
  std::vector<std::vector<Loop>> loops_;  // of each polygon
};

}  // namespace

std::vector<MeshPolygon> HalfEdges::polygons() const {
  return Merger(*store_).merge();
}

}  // namespace clray
