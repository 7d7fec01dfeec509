// SPDX-License-Identifier: Apache-2.0
// From the values of independent replicates to estimates with errors (docs/physics.md, section 6).
#pragma once

#include <cstdint>
#include <vector>

#include "clray/result.hpp"

namespace clray {

/// Two-sided 95 % quantile of Student's t with `freedom` >= 1 degrees of freedom.
double student_t95(int freedom);

/// Mean of Estimate::relative_variance_of_variance over samples of normal replicates: kurtosis 3(R−1)/(R+1), less 1,
/// over R.
double normal_variance_of_variance(int replicates);

/// A number without a statistical error.
Estimate exact_number(double value);

/// Gives an estimate of so many replicates a standard error and its interval.
void set_error(double standard_error, std::size_t replicates, Estimate* estimate);

/// Mean, standard error, interval and relative variance of the variance of the replicates. The number of a single one
/// is exact.
Estimate estimate_mean(const std::vector<double>& replicates);

/// Standard error of a total on which all replicates agree, over what one ray adds to a replicate. Where every ray
/// counts alike their number can be the same in all, and the mean number is no whole one: of R replicates that saw none
/// of an event, up to 3.0/R of one each are missed (the 95 % Poisson bound of none); that over t95.
double error_of_agreement(std::uint64_t replicates);

/// Whether replicates of this mean and standard error agree: their spread is that of rounding.
bool agree(double value, double standard_error);

/// estimate_mean() of a total that so many rays of each replicate bring, none too small where the replicates agree. To
/// each replicate `solved` is added, which has no error. Where the rays brought nothing, one of them counts as that
/// over their number: what they may have missed is taken for as bright as what is solved. Where nothing is solved, it
/// is taken for `most`, the total if every ray brought as much as a ray can.
Estimate estimate_total(const std::vector<double>& replicates, double rays, double solved = 0.0, double most = 0.0);

/// A ratio-like statistic of pooled sums with its jackknife error: `pooled` over all replicates, `left_out[r]` over all
/// but r.
Estimate estimate_jackknife(double pooled, const std::vector<double>& left_out);

/// The sum of estimates from the same points: errors add, as if one error made all of them.
Estimate sum_of_parts(const Estimate& a, const Estimate& b);

/// Upper 95 % bound of a Poisson mean of which `hits` were seen: 3.0 for none (−ln 0.05), else by inversion.
double poisson_upper95(std::uint64_t hits);

}  // namespace clray
