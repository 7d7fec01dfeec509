// SPDX-License-Identifier: Apache-2.0
// See checks.hpp.
#include "support/checks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace clray_test {

void check_component(double found, double standard_error, double exact, double scale, double bound,
                     const std::string& what, double dim) {
  const double off = std::fabs(found - exact);
  INFO(what, ": found ", found, " +- ", standard_error, ", exact ", exact);
  CHECK(std::isfinite(found));
  CHECK(std::isfinite(standard_error));
  CHECK(off <= 4.0 * standard_error + kQuantum * dim * scale);
  CHECK(off <= bound * scale);
}

void check_estimate(const clray::Estimate& found, double exact, double bound, const std::string& what, double dim) {
  check_component(found.value, found.standard_error, exact, std::fabs(exact), bound, what, dim);
  INFO(what);
  CHECK(found.low <= found.value);
  CHECK(found.high >= found.value);
}

void check_bins(const clray::DelayResult& found, const Pulse& exact, std::uint64_t rays, int replicates, double beam_m2,
                double largest_weight, const std::string& what) {
  const double floor = beam_m2 * largest_weight * replicates / static_cast<double>(rays);
  std::size_t far = 0;
  double worst = 0.0, sum = 0.0;
  std::size_t worst_bin = 0;
  for (std::size_t i = 0; i < found.bin_m2_per_sr.size(); ++i) {
    const double t = found.first_bin_start_s + static_cast<double>(i) * found.bin_width_s;
    const double expected = exact.total_m2_per_sr * (exact.share(t + found.bin_width_s) - exact.share(t));
    const double off = std::fabs(found.bin_m2_per_sr[i] - expected);
    const double sigma = (off - floor) / std::max(found.bin_standard_error[i], 1e-300);
    if (off > floor && sigma > 4.0) ++far;
    if (off > floor && sigma > worst) worst = sigma, worst_bin = i;
    sum += found.bin_m2_per_sr[i];
  }
  INFO(what, ": worst bin ", worst_bin, " at ", worst, " standard errors; beyond four: ", far);
  CHECK(worst <= 8.0);
  CHECK(far <= 1 + found.bin_m2_per_sr.size() / 50);
  // Bins and what lies outside the window make up the total, up to the rounding of that many additions.
  const double all = sum + found.below_m2_per_sr + found.above_m2_per_sr;
  CHECK(std::fabs(all - found.intensity_m2_per_sr.value) <= 1e-12 * std::fabs(all));
}

bool warns(const clray::Result& result, const std::string& words) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

}  // namespace clray_test
