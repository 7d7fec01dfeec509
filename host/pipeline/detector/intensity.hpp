// SPDX-License-Identifier: Apache-2.0
// What the inner detector `intensity` found, for those that read it: A of a connection, and its moments of delay.
#pragma once

#include <algorithm>
#include <cmath>

#include "body/portable_tables.hpp"
#include "pipeline/estimate.hpp"
#include "pipeline/sum_reader.hpp"

namespace clray {

/// Moment k (of w, w·tau, w·tau²) of replicate r, m²/sr; the pass has connections.
inline double intensity_moment(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, std::size_t c,
                               std::uint32_t r, std::uint64_t k) {
  const std::uint32_t block = find_detector(plan, "intensity")->first_block;
  return read.value(block, v, l, c, r, k) + read.solved(block, v, l, c, k);
}

/// A per replicate, m²/sr, as far as rays find it.
inline std::vector<double> intensities(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l,
                                       std::size_t c) {
  const std::uint32_t block = find_detector(plan, "intensity")->first_block;
  return per_replicate(plan, [&](std::uint32_t r) { return read.value(block, v, l, c, r, 0); });
}

/// What a solved first bounce adds to each of them.
inline double solved_intensity(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l,
                               std::size_t c) {
  return read.solved(find_detector(plan, "intensity")->first_block, v, l, c, 0);
}

/// Rays of all replicates together that brought light, as the delay histogram counted them; none without one.
inline std::uint64_t hits_of(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, std::size_t c) {
  const PassDetector* delay = find_detector(plan, "delay");
  if (delay == nullptr) return 0;
  const std::uint32_t hits = delay->last_block - 1;
  std::uint64_t sum = 0;
  for (std::uint32_t r = 0; r < plan.request.replicates; ++r) {
    for (std::uint64_t b = 0; b < plan.layout.blocks[hits].width; ++b) sum += read.count(hits, v, l, c, r, b);
  }
  return sum;
}

/// A of a view's beam, m²/sr, if every first surface sent a connection as much as these materials can: their brightest
/// peak toward it, over the whole beam.
inline double most_intensity(const PassPlan& plan, std::size_t v, std::size_t l, std::size_t c) {
  const double *s = plan.beams.views[v].toward, *o = plan.beams.connections[v * plan.traits.connections + c].direction;
  const double cos_half =
      0.5 * std::sqrt(std::pow(s[0] + o[0], 2) + std::pow(s[1] + o[1], 2) + std::pow(s[2] + o[2], 2));
  double bound = 0.0;
  const MaterialTable& table = plan.materials;
  for (std::size_t m = l * table.columns; m < (l + 1) * table.columns; ++m)
    bound = std::max(bound, surface_bound(table.rows[m], table.tables, std::max(cos_half, 1e-6)));
  return bound * plan.beams.area_m2[v];
}

/// A with its error. The rays that bring it are those that the delay histogram counted, where there is one.
inline Estimate intensity_estimate(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l,
                                   std::size_t c) {
  if (plan.request.exact()) {
    Estimate exact = exact_number(intensity_moment(plan, read, v, l, c, 0, 0));
    exact.rounding_bound = read.rounding(v, l, c);
    return exact;
  }
  const std::uint64_t hits = hits_of(plan, read, v, l, c);
  const double rays = hits != 0 ? static_cast<double>(hits) / plan.request.replicates : rays_of(read, v);
  const double solved = solved_intensity(plan, read, v, l, c);
  const std::vector<double> found = intensities(plan, read, v, l, c);
  const bool none = std::all_of(found.begin(), found.end(), [](double a) { return a == 0.0; });
  Estimate e = estimate_total(found, rays, solved, none ? most_intensity(plan, v, l, c) : 0.0);
  e.tiles = plan.request.tiles();
  if (read.adds_to(find_detector(plan, "intensity")->first_block)) {
    e.exact_part = solved;
    e.rounding_bound = read.rounding(v, l, c);
  }
  return e;
}

}  // namespace clray
