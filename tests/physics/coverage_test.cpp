// SPDX-License-Identifier: Apache-2.0
// Claimed errors are honest: over 400 seeds the 95 % intervals of every detector hold the exact value 92 to 98 % of the
// time (a fair 95 % lands there with probability 0.99). The scenes stand in support/coverage.cpp; those of plain random
// points are for the long tests.
#include "support/coverage.hpp"

#include <doctest/doctest.h>

#include "support/scenes.hpp"

using namespace clray_test;

TEST_CASE("intervals hold the exact value 92 to 98 % of the time, every detector, Sobol and random") {
  for (const CoverageScene& scene : coverage_scenes()) {
    if (scene.scene.trace.sampler == clray::SamplerKind::random && !long_tests()) continue;
    const std::vector<Coverage> found = cover(scene);
    for (std::size_t k = 0; k < found.size(); ++k) {
      INFO(scene.name, ", ", scene.claims[k].name, ": ", found[k].text());
      CHECK(found[k].intervals >= 400);
      CHECK(found[k].fair());
    }
  }
}
