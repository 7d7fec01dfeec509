// SPDX-License-Identifier: Apache-2.0
// The faces of some views from one sight, with what they send to the observers there: what exact passes and tiles work
// on.
#pragma once

#include <vector>

#include "body/geometry.hpp"
#include "exact/beam_faces.hpp"
#include "pipeline/exact_device.hpp"
#include "pipeline/exact_sights.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/solved_view.hpp"

namespace clray {

struct Group {
  std::size_t first_view = 0;
  std::vector<BeamFaces> beams;
  std::vector<std::size_t> offsets;  ///< of each beam's faces
  FaceGroup on_device;
  std::vector<VisibleFace> visible;          ///< in the end, of all beams
  std::vector<std::vector<ClrayPiece>> lit;  ///< of each beam, in the end: what other sights look for

  std::size_t end_view() const { return first_view + beams.size(); }
  /// Whether a face sends light to an observer at the beam's end.
  bool shines(std::size_t face) const;
};

/// Views `first` to `end` - 1 from one of the pass's sights.
Group group_of(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights, const Sight& sight,
               std::size_t first, std::size_t end);

inline bool is_source(const std::vector<Sight>& sights, const Sight& sight) {
  return &sight == &sights.front();
}

/// What the integer sums of a face (CLRAY_FACE_SUMS of them) say.
VisibleFace visible_face(const ClrayFace& face, const i64* sums);

}  // namespace clray
