// SPDX-License-Identifier: Apache-2.0
// From a public Scene to the reference tracer's triangles: meshes with rigid transforms, Lambert and
// Ashikhmin-Shirley only. Throws std::invalid_argument for anything else.
#pragma once

#include "clray/scene.hpp"
#include "tracer.hpp"

namespace clray_reference {

/// The scene's triangles in the body frame, in the order of its components and their meshes.
Body body_of(const clray::Scene& scene);

inline V3 vector_of(const clray::Vec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace clray_reference
