// SPDX-License-Identifier: Apache-2.0
// What decides when a pass stops, and the digest of what it summed (see outcome.hpp; PHYSICS section 6).
#include <cmath>
#include <limits>

#include "pipeline/estimate.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/sum_reader.hpp"

namespace clray {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<Target> targets_of(const PassPlan& plan, const Geometry& geometry, const Sums& sums) {
  const SumReader read(plan, sums);
  std::vector<Target> targets;
  if (plan.pixels) return targets;
  for (std::size_t v = 0; v < plan.views.size(); ++v) {
    for (std::size_t l = 0; l < plan.lanes.size(); ++l) {
      for (std::size_t c = 0; c < plan.connections && plan.connect; ++c) {
        Target t;
        t.components.push_back(per_replicate(plan, [&](std::uint32_t r) { return read.total(v, l, c, r, 0); }));
        targets.push_back(std::move(t));
      }
      if (!plan.pressure) continue;
      Target force, torque;
      for (int k = 0; k < 6; ++k) {
        (k < 3 ? force : torque).components.push_back(per_replicate(plan, [&](std::uint32_t r) {
          double sum = 0.0;
          for (std::size_t part = 0; part < plan.components; ++part) sum += read.push(v, l, part, r, k);
          return sum;
        }));
      }
      double square = 0.0;
      for (const auto& axis : force.components) {
        const double mean = estimate_mean(axis).value;
        square += mean * mean;
      }
      torque.scale = std::sqrt(square) * geometry.radius;
      targets.push_back(std::move(force));
      targets.push_back(std::move(torque));
    }
  }
  return targets;
}

namespace {

/// Of the length of a mean vector: the error along it. Across it the length changes in second order only.
double error_of_length(const Target& target, const std::vector<double>& means, double length) {
  std::vector<double> along(target.components.front().size());
  for (std::size_t r = 0; r < along.size(); ++r) {
    for (std::size_t k = 0; k < means.size(); ++k) along[r] += target.components[k][r] * (means[k] / length);
  }
  return estimate_mean(along).standard_error;
}

}  // namespace

void largest_error(const std::vector<Target>& targets, ErrorPoint* point) {
  point->relative_standard_error = point->first_total = point->first_standard_error = kNan;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    double value = 0.0, error = 0.0;
    std::vector<double> means;
    for (const auto& axis : targets[t].components) {
      const Estimate e = estimate_mean(axis);
      means.push_back(e.value);
      value += e.value * e.value;
      error += e.standard_error * e.standard_error;
    }
    value = std::sqrt(value);
    if (t == 0) {
      point->first_total = value;
      point->first_standard_error = value > 0.0 ? error_of_length(targets[t], means, value) : std::sqrt(error);
    }
    const double scale = targets[t].scale > 0.0 ? targets[t].scale : value;
    if (!(scale > 0.0)) continue;
    const double relative = std::sqrt(error) / scale;
    if (!(point->relative_standard_error >= relative)) point->relative_standard_error = relative;
  }
}

std::uint64_t digest_of(std::uint64_t state, const PassPlan& plan, const Sums& sums) {
  const std::uint64_t head[3] = {static_cast<std::uint64_t>(plan.scale_bits), plan.replicates, sums.points};
  state = fnv1a(state, head, sizeof head);
  const auto add = [&](std::uint64_t first, std::uint64_t count) {
    if (count != 0) state = fnv1a(state, sums.values.data() + first, count * sizeof(Sum));
  };
  // Only what the scene asked for: the generic program keeps more.
  add(plan.constants.totals, plan.totals_size);
  if (plan.pressure) add(plan.constants.pressure, plan.pressure_size);
  if (plan.scatter) add(plan.constants.books, plan.books_size);
  add(plan.constants.pixels, plan.pixels_size);
  const std::uint64_t delays = plan.delays.empty() ? plan.sums_size : plan.delays.front().sums;
  add(delays, plan.sums_size - delays);
  if (!sums.hits.empty()) state = fnv1a(state, sums.hits.data(), sums.hits.size() * sizeof(std::uint64_t));
  return state;
}

}  // namespace clray
