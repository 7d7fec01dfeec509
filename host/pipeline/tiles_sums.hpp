// SPDX-License-Identifier: Apache-2.0
// What the tiles of a view bring to the sums of the detectors: those that one face covers are solved, the same in every
// replicate; of the others points bring what they found.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/tiles_view.hpp"

namespace clray {

/// A view of a pass in so many tiles per replicate.
struct TilesFound {
  const PassPlan& plan;
  const Geometry& geometry;
  const std::vector<Sight>& sights;
  const Sight& sight;
  const TilesView& view;
  const TilesView::Stage& stage;
  std::uint32_t number;  ///< of the view
  std::uint64_t points;
};

/// Adds what covered tiles bring.
void add_covered(const TilesFound& found, Sums* sums, Pause* pause);
/// Adds what points brought in the others.
void add_sampled(const TilesFound& found, const SampleSums& samples, Sums* sums);

}  // namespace clray
