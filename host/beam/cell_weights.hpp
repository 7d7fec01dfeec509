// SPDX-License-Identifier: Apache-2.0
// What steers the points of a beam beside area and path length: what the surface in each cell of the silhouette sends
// to the observers, or what it sends there by way of the surfaces of other cells. Estimates for probabilities (see
// strata.hpp): nothing is hidden in them, and no result is made of them.
#pragma once

#include <vector>

#include "beam/silhouette.hpp"
#include "beam/strata.hpp"

namespace clray {

/// The cells of one view.
struct CellsOfView {
  const Geometry& geometry;
  const Steering& steering;
  const Beams& beams;
  std::size_t view;
  const BeamGrid& grid;
  const std::vector<BeamCell>& cells;
};

/// The share of the light sent to the observers that each cell sends: the mean over observers and some lanes.
std::vector<double> direct_weights(const CellsOfView& x);

/// The share of the light sent to the observers by way of a second surface, one that the source sees as well: the mean
/// over observers and some lanes.
std::vector<double> exchange_weights(const CellsOfView& x);

}  // namespace clray
