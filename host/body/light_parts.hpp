// SPDX-License-Identifier: Apache-2.0
// A wide band in parts. What a path carries is a product of reflectances, and models are not linear in their keys: the
// mean of a spectrum over all the light of a Sun would be wrong at a second bounce. So the band is cut where the keys
// of the scene's surfaces change, each part takes their means, and its share of the light weighs it. Wavelengths in nm.
#pragma once

#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// Parts side by side from end to end of a band, and their shares of its light, which sum to 1.
struct LightParts {
  std::vector<Band> bands;
  std::vector<double> shares;
};

constexpr std::size_t kMostLightParts = 8;  // that can share the directions of a path, see lane_groups()

/// The parts of a top hat under the scene's sun: one where no surface's key is a spectrum that changes within it, at
/// most kMostLightParts. Cuts are made one by one, each where it takes away most of the variance of the keys (each over
/// its largest value) within a part, weighed by the light there: so a step is a cut, and a slope is cut evenly in
/// light.
LightParts parts_of(const Scene& scene, const Band& band);

}  // namespace clray
