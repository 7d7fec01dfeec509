// SPDX-License-Identifier: Apache-2.0
// What clray-bench error makes of its measurements: Markdown tables, a CSV and a picture.
#pragma once

#include <string>
#include <vector>

#include "error_measure.hpp"

namespace clray_bench {

/// The curves of one device: for each case those of kSamplers, in that order.
struct DeviceCurves {
  std::string device;
  std::vector<Curve> curves;
  std::vector<Solved> solved;  ///< the cases that the exact method takes
  std::vector<Curve> tiles;    ///< of the same cases
};

/// A row per case, sampler and device with the quantiles of every ray count.
std::string error_csv(const std::vector<DeviceCurves>& all);

std::string totals_table(const std::vector<Curve>& curves);    ///< the last point of each curve, slope, time to p %
std::string rays_table(const std::vector<Curve>& curves);      ///< rays to 0.1 % by sampler, and their ratio
std::string fairness_table(const std::vector<Curve>& curves);  ///< true over claimed at every other ray count
std::string bins_table(const std::vector<Curve>& curves);      ///< per bin, stratified against random
std::string split_table(const std::vector<Curve>& curves);     ///< where the time goes
/// What splitting the same rays into more replicates costs in true error, and what it buys in the claim's steadiness.
std::string replicates_table(const Options& options, clray::Device& device);

std::string solved_table(const std::vector<Solved>& solved);  ///< the exact method: true error, bound and time

/// Draws `folder`/`name`; a panel a case.
void plot_error(const std::string& folder, const std::string& name, const DeviceCurves& all);

}  // namespace clray_bench
