// SPDX-License-Identifier: Apache-2.0
// Builds the half-edge mesh and finds its parts. The edges are sorted and OpenMesh's kernel is linked from that, since
// its add_face() walks round a vertex for every face that joins it: a fan of 10^5 triangles would take 10^10 steps.
#include "body/mesh_half_edges.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include "body/mesh_convexity.hpp"
#include "body/mesh_store.hpp"
#include "clray/error.hpp"
#include "scene/mesh/point_index.hpp"

namespace clray {

namespace {

constexpr std::uint32_t kNone = HalfEdges::kNone;
using Triangle = std::array<std::uint32_t, 3>;

/// One side of a triangle, filed under its lower vertex. Side 3f + k goes from corner k of face f to the next.
struct Side {
  std::uint32_t high;
  std::uint32_t side;
  bool forward;  // low to high
};

std::uint32_t next_side(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}
std::uint32_t previous_side(std::uint32_t side) {
  return side % 3 == 0 ? side + 2 : side - 1;
}

class Builder {
 public:
  Builder(HalfEdges::Store& store, const std::vector<Vec3>& points) : store_(store), points_(points) {}

  void build(const std::vector<Triangle>& triangles, const std::vector<FaceLabel>& labels) {
    store_.mesh.add_property(store_.point);
    store_.mesh.add_property(store_.shared);
    store_.mesh.add_property(store_.origin);
    store_.mesh.add_property(store_.label);
    store_.mesh.add_property(store_.refused);
    store_.triangles = triangles.size();
    weld(triangles);
    sort_sides();
    refuse();
    pair_sides();
    make_vertices();
    link();
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const OpenMesh::FaceHandle face(static_cast<int>(f));
      store_.mesh.property(store_.origin, face) = origin_[f];
      store_.mesh.property(store_.label, face) = labels.empty() ? FaceLabel() : labels[origin_[f]];
      store_.mesh.property(store_.refused, face) = refused_[f];
      if (refused_[f]) store_.refused_triangles.push_back(origin_[f]);
    }
  }

 private:
  void weld(const std::vector<Triangle>& triangles) {
    PointIndex index(points_.size());
    std::vector<std::uint32_t> number(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      number[i] = index.number(points_[i]);
      if (number[i] == first_.size()) first_.push_back(i);
    }
    faces_.reserve(triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const Triangle w{number[triangles[t][0]], number[triangles[t][1]], number[triangles[t][2]]};
      if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) {
        store_.collapsed_triangles.push_back(t);
        continue;
      }
      faces_.push_back(w);
      origin_.push_back(t);
    }
    refused_.assign(faces_.size(), false);
  }

  std::uint32_t vertex(std::uint32_t side) const { return faces_[side / 3][side % 3]; }

  // Sides by their lower vertex (a counting sort), then by the higher one, direction and place.
  void sort_sides() {
    const auto count = static_cast<std::uint32_t>(3 * faces_.size());
    start_.assign(first_.size() + 1, 0);
    for (std::uint32_t s = 0; s < count; ++s) ++start_[std::min(vertex(s), vertex(next_side(s))) + 1];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    sides_.resize(count);
    std::vector<std::uint32_t> at(start_.begin(), start_.end() - 1);
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t a = vertex(s), b = vertex(next_side(s));
      sides_[at[std::min(a, b)]++] = {std::max(a, b), s, a < b};
    }
    for (std::size_t v = 0; v + 1 < start_.size(); ++v) {
      std::sort(sides_.begin() + start_[v], sides_.begin() + start_[v + 1], [](const Side& x, const Side& y) {
        return x.high != y.high ? x.high < y.high : x.forward != y.forward ? x.forward : x.side < y.side;
      });
    }
  }

  // Calls back with the range of sides of each edge.
  template <typename Call>
  void each_edge(const Call& call) const {
    for (std::size_t v = 0; v + 1 < start_.size(); ++v) {
      for (std::uint32_t i = start_[v]; i < start_[v + 1];) {
        std::uint32_t end = i + 1;
        while (end < start_[v + 1] && sides_[end].high == sides_[i].high) ++end;
        call(i, end);
        i = end;
      }
    }
  }

  // A directed edge has room for one face. The first face that wants it gets it, unless that face is itself refused.
  void refuse() {
    std::vector<std::uint32_t> contested;  // faces
    each_edge([&](std::uint32_t i, std::uint32_t end) {
      for (std::uint32_t k = i; k < end; ++k) {
        const bool before = k > i && sides_[k - 1].forward == sides_[k].forward;
        const bool after = k + 1 < end && sides_[k + 1].forward == sides_[k].forward;
        if (before || after) contested.push_back(sides_[k].side / 3);
      }
    });
    std::sort(contested.begin(), contested.end());
    contested.erase(std::unique(contested.begin(), contested.end()), contested.end());
    std::unordered_set<std::uint64_t> taken;
    for (const std::uint32_t f : contested) {
      std::uint64_t key[3];
      bool free = true;
      for (std::uint32_t k = 0; k < 3; ++k) {
        key[k] = std::uint64_t{faces_[f][k]} << 32 | faces_[f][(k + 1) % 3];
        free = free && taken.count(key[k]) == 0;
      }
      refused_[f] = !free;
      if (free) taken.insert(key, key + 3);
    }
  }

  void pair_sides() {
    twin_.assign(sides_.size(), kNone);
    each_edge([&](std::uint32_t i, std::uint32_t end) {
      std::uint32_t one[2] = {kNone, kNone};
      for (std::uint32_t k = i; k < end; ++k) {
        if (!refused_[sides_[k].side / 3]) one[sides_[k].forward] = sides_[k].side;
        if (k > i && (end - i > 2 || refused_[sides_[k].side / 3] || refused_[sides_[i].side / 3]))
          store_.touching.emplace_back(sides_[i].side / 3, sides_[k].side / 3);
      }
      if (one[0] == kNone || one[1] == kNone) return;
      twin_[one[0]] = one[1];
      twin_[one[1]] = one[0];
    });
    sides_ = {};
    start_ = {};
  }

  // The faces at a point are grouped by the edges that they share there. Each group has a vertex of its own.
  void make_vertices() {
    handle_.assign(3 * faces_.size(), kNone);
    std::vector<std::uint32_t> made(first_.size(), kNone);
    store_.mesh.reserve(first_.size(), 2 * faces_.size(), faces_.size());
    for (std::uint32_t s = 0; s < handle_.size(); ++s) {
      if (handle_[s] != kNone) continue;
      const std::uint32_t point = vertex(s);
      const Vec3& p = points_[first_[point]];
      const auto v = store_.mesh.new_vertex(OpenMeshT::Point(p.x, p.y, p.z));
      store_.mesh.property(store_.point, v) = first_[point];
      store_.mesh.property(store_.shared, v) = made[point] != kNone;
      if (made[point] != kNone)
        store_.mesh.property(store_.shared, OpenMesh::VertexHandle(static_cast<int>(made[point]))) = true;
      made[point] = static_cast<std::uint32_t>(v.idx());
      for (std::uint32_t t = s; t != kNone && handle_[t] == kNone; t = twin_[previous_side(t)])
        handle_[t] = made[point];
      for (std::uint32_t t = twin_[s]; t != kNone && handle_[next_side(t)] == kNone; t = twin_[next_side(t)])
        handle_[next_side(t)] = made[point];
    }
    first_ = {};
  }

  void link() {
    OpenMeshT& mesh = store_.mesh;
    const auto count = static_cast<std::uint32_t>(handle_.size());
    const auto vertex_of = [&](std::uint32_t side) { return OpenMesh::VertexHandle(static_cast<int>(handle_[side])); };
    std::vector<OpenMesh::HalfedgeHandle> half(count);
    for (std::uint32_t s = 0; s < count; ++s) {
      half[s] = twin_[s] < s ? mesh.opposite_halfedge_handle(half[twin_[s]])
                             : mesh.new_edge(vertex_of(s), vertex_of(next_side(s)));
    }
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const auto face = mesh.new_face();
      mesh.set_halfedge_handle(face, half[3 * f]);
      for (std::uint32_t s = 3 * f; s < 3 * f + 3; ++s) {
        mesh.set_face_handle(half[s], face);
        mesh.set_next_halfedge_handle(half[s], half[next_side(s)]);
        mesh.set_halfedge_handle(vertex_of(s), half[s]);
      }
    }
    // A vertex on a boundary keeps its outgoing half-edge of the hole. These half-edges follow each other round it.
    for (std::uint32_t s = 0; s < count; ++s) {
      if (twin_[s] == kNone) mesh.set_halfedge_handle(vertex_of(next_side(s)), mesh.opposite_halfedge_handle(half[s]));
    }
    for (std::uint32_t s = 0; s < count; ++s) {
      if (twin_[s] == kNone)
        mesh.set_next_halfedge_handle(mesh.opposite_halfedge_handle(half[s]), mesh.halfedge_handle(vertex_of(s)));
    }
  }

  HalfEdges::Store& store_;
  const std::vector<Vec3>& points_;
  std::vector<std::uint32_t> first_;   // of each distinct point: its first index
  std::vector<Triangle> faces_;        // in distinct points
  std::vector<std::uint32_t> origin_;  // of each face: its triangle
  std::vector<bool> refused_;
  std::vector<Side> sides_;
  std::vector<std::uint32_t> start_;   // of each point: its first side in sides_
  std::vector<std::uint32_t> twin_;    // of each side: the one that goes back along it
  std::vector<std::uint32_t> handle_;  // of each side: the vertex it starts from
};

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

std::vector<FaceLabel> labels_of(const Mesh& mesh) {
  std::vector<FaceLabel> labels(mesh.triangle_slot.size());
  for (std::size_t t = 0; t < labels.size(); ++t) labels[t].slot = mesh.triangle_slot[t];
  return labels;
}

}  // namespace

HalfEdges::HalfEdges(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                     const std::vector<FaceLabel>& labels)
    : store_(std::make_unique<Store>()) {
  if (triangles.size() > 0x7fffffffu / 6) {  // OpenMesh numbers half-edges in int
    throw Error(ErrorCode::input, "more than 3.5e8 triangles; fewer were expected");
  }
  Builder(*store_, points).build(triangles, labels);
}

HalfEdges::HalfEdges(const Mesh& mesh) : HalfEdges(mesh.vertices, mesh.triangles, labels_of(mesh)) {
  store_->slots = mesh.material_slots;
}

HalfEdges::~HalfEdges() = default;

const std::vector<std::uint32_t>& HalfEdges::refused() const {
  return store_->refused_triangles;
}

const std::vector<std::uint32_t>& HalfEdges::collapsed() const {
  return store_->collapsed_triangles;
}

std::vector<MeshPart> HalfEdges::parts(std::vector<std::uint32_t>* part_of) const {
  const OpenMeshT& mesh = store_->mesh;
  std::vector<std::uint32_t> parent(mesh.n_faces());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto join = [&](int a, int b) {
    const std::uint32_t x = find_root(parent, static_cast<std::uint32_t>(a)),
                        y = find_root(parent, static_cast<std::uint32_t>(b));
    parent[std::max(x, y)] = std::min(x, y);
  };
  for (const auto edge : mesh.edges()) {
    const auto half = mesh.halfedge_handle(edge, 0), back = mesh.halfedge_handle(edge, 1);
    if (!mesh.is_boundary(edge)) join(mesh.face_handle(half).idx(), mesh.face_handle(back).idx());
  }
  for (const auto& [a, b] : store_->touching) join(a, b);
  std::vector<std::uint32_t> number(mesh.n_faces());
  std::vector<MeshPart> parts;
  for (std::uint32_t f = 0; f < number.size(); ++f) {
    number[f] = parent[f] == f ? static_cast<std::uint32_t>(parts.size()) : number[find_root(parent, f)];
    if (parent[f] == f) parts.emplace_back();
    ++parts[number[f]].triangles;
  }
  judge_parts(*store_, number, parts);
  if (part_of != nullptr) {
    part_of->assign(store_->triangles, kNone);
    for (std::uint32_t f = 0; f < number.size(); ++f)
      (*part_of)[store_->mesh.property(store_->origin, OpenMesh::FaceHandle(static_cast<int>(f)))] = number[f];
  }
  return parts;
}

}  // namespace clray
