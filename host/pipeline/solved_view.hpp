// SPDX-License-Identifier: Apache-2.0
// What an exact pass finds in a view: the visible part of each face, from which detectors make their sums.
#pragma once

#include <cstddef>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

/// The visible part of a face, in its beam's frame. Moments are about the face's first corner, and depth is from there.
struct VisibleFace {
  double area_m2 = 0.0;
  double x_m3 = 0.0, y_m3 = 0.0;
  double depth_m3 = 0.0, depth2_m4 = 0.0;
  double rounding_m2 = 0.0;  ///< a bound of what rounding did to the area
};

/// What is seen of a body in one view.
struct SolvedView {
  std::size_t view = 0;
  const BeamFaces& beam;
  const std::vector<VisibleFace>& visible;  ///< of each face
  const double* weights;                    ///< f·mu_o of each face's lanes, 1/sr
};

}  // namespace clray
