// SPDX-License-Identifier: Apache-2.0
// The faces of a body as they are seen from one direction, that of the source or of an observer: triangles across the
// beam that goes there with their depth, nearest first.
// Flat parts of analytic shapes are taken as triangles too; curved shapes are left out. Body frame and beam frame,
// metres.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "body/geometry.hpp"
#include "body/materials.hpp"
#include "shared/abi.h"

namespace clray {

/// What a face of a beam is of the body.
struct FaceOrigin {
  std::uint32_t number = 0;     ///< of the body's triangles, the same in every beam
  std::uint32_t primitive = 0;  ///< in Geometry::primitives
  std::uint32_t material = 0;   ///< column of the material table
  bool lit = true;              ///< false: the black back of a one-sided material
  double mu = 0.0;              ///< cosine of the angle between its normal and the beam
};

/// A frame across a beam, with depth toward where it comes from or goes to. Its origin is the body's centre.
struct BeamFrame {
  BeamFrame() = default;
  BeamFrame(const vec3& toward, double size);

  vec3 axis_x{}, axis_y{}, toward{};
  double size = 0.0;    ///< of the body
  double margin = 0.0;  ///< distances within it are zero
};

/// How a beam meets a face.
struct FaceSide {
  bool front = true;     ///< the side that its corners go round counter-clockwise is met
  double cosine = 1.0;   ///< of the angle between its normal and the beam
  double area_m2 = 0.0;  ///< across the beam
};

/// Sets what the corners decide of a face: all but path, view, order and the scale of bins. Nothing, where the beam
/// meets it edge-on.
std::optional<FaceSide> place_face(const BeamFrame& frame, const vec3& a, vec3 b, vec3 c, ClrayFace* face);

/// Sets how long the way from the source by the face to the beam's end is, relative to that by the reference point
/// (from the body's centre). It is linear over the face.
void set_path(const BeamFrame& frame, const vec3& source, const vec3& reference, ClrayFace* face);

struct BeamFaces : BeamFrame {
  std::vector<ClrayFace> faces;  ///< by `nearest` from great to small, then by `order`
  std::vector<FaceOrigin> origins;
  std::vector<double> areas;                      ///< across the beam
  double x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;  ///< the rectangle around the faces
};

/// A face's number is below the rank of a face in its plane: bodies of 2^30 primitives or more are not solved.
constexpr std::uint32_t kFaceRankBits = 30;

/// From where a body is seen.
struct BeamSight {
  vec3 toward{}, source{};  ///< unit; the same for the beam of the light itself
  vec3 reference{};         ///< where path lengths are zero
  std::uint32_t view = 0;
};

/// The faces that are seen where no curved shape is. Faces at a grazing angle below 1e-9 rad are left out.
BeamFaces beam_faces(const Geometry& geometry, const MaterialTable& materials, const std::vector<RigidMotion>& motions,
                     const BeamSight& sight);

}  // namespace clray
