// SPDX-License-Identifier: Apache-2.0
// See from_scene.hpp. Defaults of absent keys are those that `clray --list brdf` prints.
#include "from_scene.hpp"

#include <stdexcept>

namespace clray_reference {
namespace {

Real key(const clray::Material& m, const char* name, Real otherwise) {
  const auto it = m.parameters.find(name);
  return it == m.parameters.end() ? otherwise : static_cast<Real>(it->second);
}

Material material_of(const clray::Material& m) {
  Material out;
  out.two_sided = m.two_sided;
  if (m.model == "lambert") {
    out.rho = key(m, "rho", 1);
  } else if (m.model == "ashikhmin-shirley") {
    out.model = Material::Model::ashikhmin_shirley;
    out.rho = key(m, "rho", 0.5L);
    out.d = key(m, "d", 0.5L);
    out.n = key(m, "n", 50);
    out.f0 = key(m, "f0", out.rho);
  } else {
    throw std::invalid_argument("the reference tracer does not know the model " + m.model);
  }
  return out;
}

V3 placed(const clray::Transform& t, const clray::Vec3& v) {
  const V3 turned = rotated(static_cast<Real>(t.scale) * vector_of(v), unit(vector_of(t.axis)), t.angle_rad);
  return turned + vector_of(t.translate);
}

}  // namespace

Body body_of(const clray::Scene& scene) {
  Body body;
  for (const clray::Material& m : scene.materials) body.materials.push_back(material_of(m));
  for (const clray::Component& component : scene.components) {
    if (component.shape != "mesh" || component.hinge)
      throw std::invalid_argument("the reference tracer knows fixed meshes only");
    const clray::Mesh& mesh = *component.mesh;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      const std::size_t slot = mesh.triangle_slot.empty() ? 0 : mesh.triangle_slot[i];
      body.triangles.push_back({placed(component.transform, mesh.vertices[t[0]]),
                                placed(component.transform, mesh.vertices[t[1]]),
                                placed(component.transform, mesh.vertices[t[2]]), component.materials.at(slot)});
    }
  }
  return body;
}

}  // namespace clray_reference
