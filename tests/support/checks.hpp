// SPDX-License-Identifier: Apache-2.0
// Comparison of results with exact answers, in units of the claimed standard error and against a fixed bound.
#pragma once

#include <doctest/doctest.h>

#include "support/closed_forms.hpp"

namespace clray_test {

/// What a comparison allows beyond 4 standard errors, relative: results are sums of integers whose unit is up to
/// 2⁻³⁷ of the largest weight (docs/physics.md, section 7), half of which every sample may be off in the same
/// direction.
constexpr double kQuantum = 1e-11;

/// A doctest::Approx whose epsilon is relative to the values alone: its own adds 1, and so passes any small number.
inline doctest::Approx relative(double value) {
  return doctest::Approx(value).scale(0.0);
}

/// CHECKs |found − exact| ≤ 4 standard errors (+ kQuantum of `scale`) and ≤ `bound`·|exact|. `dim`: the bound of
/// weights over the case's own weight, where all weights are alike and far below the bound.
void check_estimate(const clray::Estimate& found, double exact, double bound, const std::string& what,
                    double dim = 1.0);
void check_component(double found, double standard_error, double exact, double scale, double bound,
                     const std::string& what, double dim = 1.0);

/// CHECKs the bins against a pulse. Each bin's standard error has replicates − 1 degrees of freedom, so of 16
/// replicates 1 bin in 860 lies beyond 4 of them and 1 in 10⁶ beyond 8; and a bin in which every replicate has the
/// same whole number of hits shows no spread at all, so `floor_hits` hits per replicate are allowed besides.
void check_bins(const clray::DelayResult& found, const Pulse& exact, std::uint64_t rays, int replicates, double beam_m2,
                double largest_weight, const std::string& what);

/// Whether a warning of the result has these words.
bool warns(const clray::Result& result, const std::string& words);

}  // namespace clray_test
