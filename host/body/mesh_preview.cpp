// SPDX-License-Identifier: Apache-2.0
// A coarser surface for pictures: OpenMesh's decimater collapses the edges that move the surface least (quadric error,
// Garland & Heckbert 1997), never turning a face over by more than a right angle.
#include "body/mesh_store.hpp"
// After the store, which silences a false warning inside OpenMesh.
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace clray {

namespace {

using Decimater = OpenMesh::Decimater::DecimaterT<OpenMeshT>;
using Quadric = OpenMesh::Decimater::ModQuadricT<OpenMeshT>::Handle;
using Flipping = OpenMesh::Decimater::ModNormalFlippingT<OpenMeshT>::Handle;

void decimate(OpenMeshT& mesh, const OpenMesh::VPropHandleT<bool>& shared, std::size_t most) {
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
  mesh.update_face_normals();
  for (const auto vertex : mesh.vertices()) mesh.status(vertex).set_locked(mesh.property(shared, vertex));
  Decimater decimater(mesh);
  Quadric quadric;
  Flipping flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, most);
  mesh.garbage_collection();
}

}  // namespace

Mesh HalfEdges::preview(std::size_t most) const {
  OpenMeshT coarse = store_->mesh;
  if (coarse.n_faces() > most) decimate(coarse, store_->shared, most);
  Mesh mesh;
  mesh.material_slots = store_->slots.empty() ? std::vector<std::string>{""} : store_->slots;
  for (const auto vertex : coarse.vertices()) mesh.vertices.push_back(to_vec3(coarse.point(vertex)));
  for (const auto face : coarse.faces()) {
    std::array<std::uint32_t, 3> corners{};
    auto half = coarse.halfedge_handle(face);
    for (std::uint32_t& corner : corners) {
      corner = static_cast<std::uint32_t>(coarse.from_vertex_handle(half).idx());
      half = coarse.next_halfedge_handle(half);
    }
    mesh.triangles.push_back(corners);
    mesh.triangle_slot.push_back(coarse.property(store_->label, face).slot);
  }
  mesh.report.faces = mesh.report.triangles = mesh.triangles.size();
  return mesh;
}

}  // namespace clray
