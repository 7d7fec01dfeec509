// SPDX-License-Identifier: Apache-2.0
// The integer sums of a pass, read in the units of its results: m²/sr, m², m³ and 1/sr.
#pragma once

#include <cstring>
#include <vector>

#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// Reads the sums of a pass in the units of its results.
class SumReader {
 public:
  SumReader(const PassPlan& plan, const Sums& sums)
      : plan_(plan), sums_(sums), weight_(1.0 / plan.constants.weight_scale), unit_(1.0 / plan.constants.unit_scale) {}

  std::uint64_t slot(std::size_t view, std::size_t lane, std::size_t c) const {
    return (view * plan_.lanes.size() + lane) * plan_.connections + c;
  }
  std::uint64_t row(std::uint64_t slot, std::uint32_t r) const { return slot * plan_.replicates + r; }

  /// m² of beam that one point of one replicate stands for.
  double share(std::size_t view) const { return plan_.area_m2[view] / static_cast<double>(sums_.points); }

  /// Moment k of replicate r (w, w·tau, w·tau²), in m²/sr.
  double total(std::size_t view, std::size_t lane, std::size_t c, std::uint32_t r, int moment) const {
    return at(3 * row(slot(view, lane, c), r) + moment) * weight_ * share(view);
  }
  /// Bin of a delay detector, 0 below, bins+1 above; m²/sr.
  double bin(const DelayPlan& d, std::size_t view, std::uint64_t slot, std::uint32_t r, std::uint32_t b) const {
    return at(d.sums + row(slot, r) * (d.bins + 2ull) + b) * weight_ * share(view);
  }
  std::uint64_t hits(const DelayPlan& d, std::uint64_t slot, std::uint32_t r, std::uint32_t b) const {
    return sums_.hits[d.hits + row(slot, r) * (d.bins + 3ull) + 1 + b];
  }
  double largest_weight(const DelayPlan& d, std::uint64_t slot, std::uint32_t r) const {
    const auto bits = static_cast<std::uint32_t>(sums_.hits[d.hits + row(slot, r) * (d.bins + 3ull)]);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  /// Momentum (0-2) or torque (3-5) of a component, m² or m³.
  double push(std::size_t view, std::size_t lane, std::size_t component, std::uint32_t r, int k) const {
    const std::uint64_t view_row = (view * plan_.lanes.size() + lane) * plan_.replicates + r;
    const double value = at(plan_.constants.pressure + (view_row * plan_.components + component) * 6 + k);
    return value * unit_ * share(view) * (k >= 3 ? plan_.lever_m : 1.0);
  }
  double book(std::size_t view, std::size_t lane, std::uint32_t r, int book) const {
    const std::uint64_t view_row = (view * plan_.lanes.size() + lane) * plan_.replicates + r;
    return at(plan_.constants.books + view_row * CLRAY_BOOKS + book) * unit_ * share(view);
  }
  /// Radiance over irradiance of a pixel in half r, 1/sr.
  double pixel(std::size_t view, std::size_t lane, std::uint32_t r, std::uint64_t pixel) const {
    const std::uint64_t pixels = static_cast<std::uint64_t>(plan_.width) * plan_.height;
    const std::uint64_t view_row = (view * plan_.lanes.size() + lane) * plan_.replicates + r;
    return at(plan_.constants.pixels + view_row * pixels + pixel) * weight_ / static_cast<double>(sums_.points);
  }

 private:
  double at(std::uint64_t index) const { return static_cast<double>(sums_.values[index]); }

  const PassPlan& plan_;
  const Sums& sums_;
  double weight_, unit_;
};

template <class Function>
std::vector<double> per_replicate(const PassPlan& plan, Function&& function) {
  std::vector<double> values(plan.replicates);
  for (std::uint32_t r = 0; r < plan.replicates; ++r) values[r] = function(r);
  return values;
}

}  // namespace clray
