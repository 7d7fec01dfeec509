// SPDX-License-Identifier: Apache-2.0
// What the inner detector `intensity` found, for those that read it: A of a connection, and its moments of delay.
#pragma once

#include "pipeline/estimate.hpp"
#include "pipeline/sum_reader.hpp"

namespace clray {

/// Moment k (of w, w·tau, w·tau²) of replicate r, m²/sr; the pass has connections.
inline double intensity_moment(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, std::size_t c,
                               std::uint32_t r, int k) {
  return read.value(find_detector(plan, "intensity")->first_block, v, l, c, r, static_cast<std::uint64_t>(k));
}

/// A per replicate, m²/sr.
inline std::vector<double> intensities(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l,
                                       std::size_t c) {
  return per_replicate(plan, [&](std::uint32_t r) { return intensity_moment(plan, read, v, l, c, r, 0); });
}

/// A with its error. The rays that bring it are those that the delay histogram counted, where there is one.
inline Estimate intensity_estimate(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l,
                                   std::size_t c) {
  if (plan.request.exact) {
    Estimate exact = exact_number(intensity_moment(plan, read, v, l, c, 0, 0));
    exact.rounding_bound = read.rounding(v, l, c);
    return exact;
  }
  double rays = rays_of(read, v);
  if (const PassDetector* delay = find_detector(plan, "delay")) {
    const std::uint32_t hits = delay->last_block - 1;
    std::uint64_t sum = 0;
    for (std::uint32_t r = 0; r < plan.request.replicates; ++r) {
      for (std::uint64_t b = 0; b < plan.layout.blocks[hits].width; ++b) sum += read.count(hits, v, l, c, r, b);
    }
    rays = static_cast<double>(sum) / plan.request.replicates;
  }
  return estimate_total(intensities(plan, read, v, l, c), rays);
}

}  // namespace clray
