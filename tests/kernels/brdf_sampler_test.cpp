// SPDX-License-Identifier: Apache-2.0
// Chi-square test of every model's sampler against its own pdf: 2.5·10^5 directions per parameter set, 10^6 with
// CLRAY_LONG_TESTS=1, cells graded toward
// where peaks can lie, the sampler's failures a cell of their own (so pdf integrates to 1 minus the probability of
// failure). Seeds are fixed; the significance 1e-6 is shared by all cases (Bonferroni).
#include <random>

#include "doctest/doctest.h"
#include "kernels/brdf_models.hpp"
#include "support/scenes.hpp"

using namespace brdf_test;

namespace {

/// Upper tail of the chi-square distribution (Wilson & Hilferty 1931).
double chi2_tail(double x, double freedom) {
  const double v = 2.0 / (9.0 * freedom);
  return 0.5 * std::erfc((std::cbrt(x / freedom) - (1.0 - v)) / std::sqrt(2.0 * v));
}

/// p-value of `count` samples of the model against the integrals of its pdf.
double sampler_p_value(const Model& m, double mu, int count, unsigned seed) {
  const Cells cells(mu, 2e-4, 3.0);
  std::vector<double> expected = cells.integrals(mu, [&](const BrdfAngles& a) { return m.pdf(a); });
  double inside = 0.0;
  for (double e : expected) inside += e;
  REQUIRE(inside < 1.0 + 1e-7);
  // Halves: azimuth above and below the plane of incidence; last: failures.
  std::vector<double> seen(2 * expected.size() + 1, 0.0);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const vec3 wi = incident(mu);
  for (int k = 0; k < count; ++k) {
    const BrdfSample s = m.sample(wi, uniform(random), uniform(random), uniform(random));
    if (!s.ok) {
      seen.back() += 1.0;
      continue;
    }
    const double theta = std::atan2(std::hypot(s.wo.x, s.wo.y), s.wo.z);
    const double phi = std::atan2(s.wo.y, s.wo.x);
    seen[2 * cells.of(theta, std::fabs(phi)) + (phi < 0.0)] += 1.0;
  }
  double chi2 = 0.0, rest_expected = 0.0, rest_seen = 0.0;
  int used = 0;
  const auto take = [&](double e, double n) {
    if (e < 20.0) {
      rest_expected += e;
      rest_seen += n;
      return;
    }
    chi2 += (n - e) * (n - e) / e;
    ++used;
  };
  for (std::size_t k = 0; k < expected.size(); ++k)
    for (int side = 0; side < 2; ++side) take(0.5 * count * expected[k], seen[2 * k + side]);
  take(count * std::max(0.0, 1.0 - inside), seen.back());
  // Rare cells together; where even they are rare, a Poisson count that 1e-12 would exceed fails.
  if (rest_expected >= 20.0) {
    chi2 += (rest_seen - rest_expected) * (rest_seen - rest_expected) / rest_expected;
    ++used;
  } else if (rest_seen > rest_expected + 8.0 * std::sqrt(rest_expected) + 12.0) {
    return 0.0;
  }
  return used > 1 ? chi2_tail(chi2, used - 1) : 1.0;
}

}  // namespace

TEST_CASE("samplers follow their pdf") {
  const std::vector<Model> all = models(false);
  const double mus[] = {0.7, 0.2, 1.0, 0.02};
  const double significance = 1e-6 / static_cast<double>(all.size());
  const int count = clray_test::long_tests() ? 1000000 : 250000;
  double least = 1.0;
  int cases = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].is_delta()) continue;
    const double mu = mus[k % 4];
    INFO(all[k].name);
    CAPTURE(mu);
    const double p = sampler_p_value(all[k], mu, count, 100 + static_cast<unsigned>(k));
    CHECK(p > significance);
    least = std::min(least, p);
    ++cases;
  }
  MESSAGE(cases << " cases, least p-value " << least);
}
