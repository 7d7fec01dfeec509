// SPDX-License-Identifier: Apache-2.0
// The integer sums of a pass, read in the units of its results: what a ray of share 1 stands for times the sum, m² for
// shares of the beam and m²/sr for weights toward a connection. Where a pass's first bounce is solved, its part is
// added here, as a number that is the same in every replicate.
#pragma once

#include <vector>

#include "pipeline/plan.hpp"

namespace clray {

/// Reads the sums of a pass.
class SumReader {
 public:
  SumReader(const PassPlan& plan, const Sums& sums)
      : plan_(plan), sums_(sums), unit_(1.0 / plan.constants.unit_scale) {}

  /// Of each replicate of a view (and pixel).
  std::uint64_t points(std::size_t view) const { return sums_.points[view]; }

  /// m² of beam that one point of one replicate stands for.
  double share(std::size_t view) const { return plan_.beams.area_m2[view] / static_cast<double>(points(view)); }

  /// Number k of the row of a view, lane and connection (0 where the block has none) and replicate r; m² or m²/sr.
  double value(std::uint32_t block, std::size_t view, std::size_t lane, std::size_t c, std::uint32_t r,
               std::uint64_t k) const {
    const SumBlock& b = plan_.layout.blocks[block];
    const double scale = b.scale == SumScale::unit ? unit_ : weight_unit(view);
    return static_cast<double>(sums_.values[at(b, view, lane, c, r) + k]) * scale * share(view);
  }
  /// The same of a block of counts.
  std::uint64_t count(std::uint32_t block, std::size_t view, std::size_t lane, std::size_t c, std::uint32_t r,
                      std::uint64_t k) const {
    return sums_.counts[at(plan_.layout.blocks[block], view, lane, c, r) + k];
  }
  /// Where a block has the numbers of a view and lane, of all its replicates; of blocks whose rows are lanes.
  SumRange of_lane(std::uint32_t block, std::size_t view, std::size_t lane) const {
    const SumBlock& b = plan_.layout.blocks[block];
    const std::uint64_t begin = at(b, view, lane, 0, 0);
    return {begin, begin + plan_.layout.shape.replicates * b.width};
  }
  /// Whether a solved first bounce adds to a block.
  bool adds_to(std::uint32_t block) const { return plan_.first && plan_.first->blocks[block] >= 0; }
  /// What the solved first bounce adds to a value in every replicate; 0 where none is solved.
  double solved(std::uint32_t block, std::size_t view, std::size_t lane, std::size_t c, std::uint64_t k) const {
    if (!adds_to(block)) return 0.0;
    return first().value(static_cast<std::uint32_t>(plan_.first->blocks[block]), view, lane, c, 0, k);
  }
  /// Of an exact pass, or of a solved first bounce: a bound of the rounding of A, m²/sr.
  double rounding(std::size_t view, std::size_t lane, std::size_t c) const {
    if (plan_.first) return first().rounding(view, lane, c);
    const SumShape& shape = plan_.layout.shape;
    return sums_.rounding[(view * shape.lanes + lane) * shape.connections + c];
  }
  /// Of an exact pass, or of a solved first bounce: a bound of the rounding of the lit area, m².
  double area_rounding(std::size_t view) const {
    return plan_.first ? first().area_rounding(view) : sums_.area_rounding[view];
  }
  /// A weight's sum without its area: of pixels, radiance over irradiance times the points.
  double weight(std::uint32_t block, std::size_t view, std::size_t lane, std::uint32_t r, std::uint64_t k) const {
    return static_cast<double>(sums_.values[at(plan_.layout.blocks[block], view, lane, 0, r) + k]) * weight_unit(view);
  }

 private:
  SumReader first() const { return {plan_.first->plan, plan_.first->sums}; }

  std::uint64_t at(const SumBlock& b, std::size_t view, std::size_t lane, std::size_t c, std::uint32_t r) const {
    const SumShape& shape = plan_.layout.shape;
    std::uint64_t row = view;
    if (b.rows != SumRows::view) row = row * shape.lanes + lane;
    if (b.rows == SumRows::connection) row = row * shape.connections + c;
    if (b.rows != SumRows::view) row = row * shape.replicates + r;
    return b.offset + row * b.width;
  }

  double weight_unit(std::size_t view) const { return 1.0 / plan_.beams.views[view].weight_scale; }

  const PassPlan& plan_;
  const Sums& sums_;
  double unit_;
};

/// Rays of a replicate of a view, of a beam that the body fills.
inline double rays_of(const SumReader& read, std::size_t view) {
  return static_cast<double>(read.points(view));
}

template <class Function>
std::vector<double> per_replicate(const PassPlan& plan, Function&& function) {
  std::vector<double> values(plan.request.replicates);
  for (std::uint32_t r = 0; r < plan.request.replicates; ++r) values[r] = function(r);
  return values;
}

/// The same of a record: its lanes' values (function of lane and replicate), each with its share of the light.
template <class Function>
std::vector<double> per_replicate_of(const PassPlan& plan, const LaneRecord& record, Function&& function) {
  return per_replicate(plan, [&](std::uint32_t r) {
    double sum = 0.0;
    for (std::size_t l = record.first; l < record.end; ++l) sum += plan.request.lanes[l].share * function(l, r);
    return sum;
  });
}

}  // namespace clray
