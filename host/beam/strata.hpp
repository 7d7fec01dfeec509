// SPDX-License-Identifier: Apache-2.0
// How a beam's points are spread over the body. The cells that the body can be in (silhouette.hpp) are cut into pieces,
// and pieces form strips. The first coordinate of a point chooses a strip and the place across it, the second a piece
// of the strip and the place along it.
// With a histogram of delay, a strip is an interval of path length that ends at edges of the histogram's bins, and
// cells are cut along lines of equal path. So strata of the first coordinate are strata of the histogram. Within a
// strip the pieces go round the beam's middle, so that strata of the second coordinate are places on the body. Without
// a histogram a strip is a column of cells. Probabilities mix area (nothing is starved), path length (rare delays get
// their share) and what the surface sends to the observers (peaks are met): defensive importance sampling after
// Hesterberg (1995). A ray's weight is its piece's area over its probability, and all pieces together are all cells, so
// the estimate is unbiased whatever steers it. What it gains is measured in docs/error.md. Plain fp64 without
// contraction and clray's own functions: the same strata on every host.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "beam/beams.hpp"
#include "body/materials.hpp"
#include "clray/scene.hpp"

namespace clray {

/// Edges of bins of path length that strata of the beam may follow.
struct PathBins {
  double first_m = 0.0, bin_m = 1.0;  ///< of the first connection
};

/// What strata are steered by.
struct Steering {
  const MaterialTable& materials;
  std::size_t lanes;
  /// What they follow beside area and path length: nothing, what surfaces send to the observers, or what surfaces that
  /// the source sees send there by way of one another.
  enum class By { area, direct, exchange } by;
  const PathRanges& paths;
  std::optional<PathBins> bins;  ///< strips of path length end at these edges
  /// Whether what a primitive sends directly, in a view, is of interest; none: that of all is.
  std::function<bool(std::size_t view, std::uint32_t primitive)> counts{};
};

/// The beams with their strata. Leaves a view without strata (its rectangle is then sampled evenly) for the random
/// sampler, and where strata cost too much.
Beams stratified(Beams beams, const Scene& scene, const Geometry& geometry, const BeamRequest& request,
                 const Steering& steering);

}  // namespace clray
