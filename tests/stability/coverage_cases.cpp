// SPDX-License-Identifier: Apache-2.0
// The honesty of claimed errors, for every detector; what is run stands in support/coverage.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stability/case.hpp"
#include "support/coverage.hpp"

namespace clray_test {

namespace {

constexpr int kSeeds = 400;

Outcome detector(const CoverageScene& scene) {
  Outcome outcome{true, ""};
  const std::vector<Coverage> found = cover(scene);
  for (std::size_t k = 0; k < found.size(); ++k) {
    outcome.pass = outcome.pass && found[k].fair();
    outcome.measured += fmt::format("{}{}: {}", k ? "; " : "", scene.claims[k].name, found[k].text());
  }
  return outcome;
}

/// Bins of plain random points against the same bins drawn without the program.
Outcome random_bins(std::size_t group) {
  static const ByHits found = cover_bins(false, kSeeds), drawn = simulate_bins(kSeeds);
  const Coverage &a = found[group], &b = drawn[group];
  const double p = b.share(), spread = std::sqrt(p * (1.0 - p) * (1.0 / a.intervals + 1.0 / b.intervals));
  return {std::fabs(a.share() - p) <= 4.0 * spread && a.intervals > 1000,
          fmt::format("{}; drawn: {}", a.text(), b.text())};
}

Outcome sobol_bins(std::size_t group) {
  static const ByHits found = cover_bins(true, kSeeds);
  return {found[group].share() >= 0.92 && found[group].intervals > 1000, found[group].text()};
}

Outcome tiles_bins(std::size_t group) {
  static const ByHits found = cover_tiles_bins(kSeeds);
  return {found[group].share() >= 0.92 && found[group].intervals > 1000, found[group].text()};
}

Outcome pixels(bool sobol) {
  const PixelShares s = cover_pixels(sobol);
  const double one = 1.0 * s.within_one / s.pixels, wide = 1.0 * s.within_95 / s.pixels;
  const double slack = 4.0 / std::sqrt(1.0 * s.pixels);
  return {std::fabs(one - 0.5) <= 0.5 * slack && std::fabs(wide - 0.95) <= std::sqrt(0.95 * 0.05) * slack &&
              s.no_error == 0,
          fmt::format("{:.1f} and {:.1f} % of {} pixels, {} without error", 100.0 * one, 100.0 * wide, s.pixels,
                      s.no_error)};
}

}  // namespace

std::vector<Case> coverage_cases() {
  std::vector<Case> cases;
  for (const CoverageScene& scene : coverage_scenes())
    cases.push_back({"coverage", scene.name + ", 400 or 1200 seeds", "95 % intervals hold the exact value",
                     "92 to 98 %: probability 0.99 of a fair 95 %", false, [scene] { return detector(scene); }});
  for (std::size_t g = 0; g < kHitsGroups.size(); ++g)
    cases.push_back({"coverage", fmt::format("bins with {}, random", kHitsGroups[g]),
                     "as for points drawn without the program", "4 standard errors of the two shares", false,
                     [g] { return random_bins(g); }});
  for (std::size_t g = 0; g < kHitsGroups.size(); ++g)
    cases.push_back({"coverage", fmt::format("bins with {}, Sobol", kHitsGroups[g]), "at least 92 % of the intervals",
                     "strata make the spread of hits smaller than Poisson's: no closed form", false,
                     [g] { return sobol_bins(g); }});
  for (std::size_t g = 0; g < kHitsGroups.size(); ++g)
    cases.push_back({"coverage", fmt::format("bins with {}, tiles", kHitsGroups[g]), "at least 92 % of the intervals",
                     "tiles cut at edges make the spread of hits smaller than Poisson's: no closed form", false,
                     [g] { return tiles_bins(g); }});
  for (const bool sobol : {true, false})
    cases.push_back({"coverage", fmt::format("pixels of a sphere, {}", sobol ? "Sobol" : "random"),
                     "50 % within 1 half-difference, 95 % within 12.7", "Student's t of 1; 4 standard errors", false,
                     [sobol] { return pixels(sobol); }});
  return cases;
}

}  // namespace clray_test
