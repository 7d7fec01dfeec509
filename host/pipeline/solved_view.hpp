// SPDX-License-Identifier: Apache-2.0
// What an exact pass finds in a view: the part of each face that is lit, or lit and seen by an observer, from which
// detectors make their sums.
#pragma once

#include <cstddef>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

/// The visible part of a face, in its beam's frame. Moments are about the face's first corner, and path is from there.
struct VisibleFace {
  double area_m2 = 0.0;
  double x_m3 = 0.0, y_m3 = 0.0;
  double path_m3 = 0.0, path2_m4 = 0.0;
  double rounding_m2 = 0.0;  ///< a bound of what rounding did to the area
};

/// What is lit of a body in one view, or lit and seen from elsewhere.
struct SolvedView {
  std::size_t view = 0;
  bool from_source = true;                      ///< all that is lit is there, seen or not
  const std::vector<std::size_t>& connections;  ///< of the pass: the observers that see this
  const BeamFaces& beam;
  const VisibleFace* visible;  ///< of each face
  const double* weights;    ///< of each face's lanes: its radiant intensity over irradiance, per area across the beam
  std::uint64_t times = 1;  ///< as which it counts in the sums of each replicate
};

}  // namespace clray
