// SPDX-License-Identifier: Apache-2.0
// See exact_sights.hpp.
#include "pipeline/exact_sights.hpp"

#include "pipeline/detector/room.hpp"

namespace clray {
namespace {

bool at_source(const PassPlan& plan, std::size_t connection) {
  for (std::size_t v = 0; v < plan.beams.views.size(); ++v) {
    if (plan.beams.connections[v * plan.traits.connections + connection].shadow != 0) return false;
  }
  return true;
}

}  // namespace

std::vector<Sight> sights_of(const PassPlan& plan) {
  std::vector<Sight> sights(1);
  for (std::size_t c = 0; c < plan.traits.connections && plan.traits.connect; ++c) {
    if (at_source(plan, c)) {
      sights.front().connections.push_back(c);
    } else {
      sights.push_back({{c}, {}});
    }
  }
  return sights;
}

std::uint64_t lay_out_bins(const PassPlan& plan, std::vector<Sight>* sights) {
  std::uint64_t numbers = 0;
  for (Sight& sight : *sights) {
    for (const PassDetector& d : plan.detectors) {
      const auto window = room_of(d).binning;
      if (window == nullptr) continue;
      ClrayBinning b = window(d, sight.connections.empty() ? 0 : sight.connection());
      b.offset = numbers;
      if (!sight.connections.empty()) numbers += plan.beams.views.size() * plan.request.lanes.size() * (b.bins + 2);
      sight.binnings.push_back(b);
    }
  }
  return numbers;
}

void take_bins(const PassPlan& plan, const std::vector<Sight>& sights, const std::vector<i64>& bins, Sums* sums) {
  const SumShape& shape = plan.layout.shape;
  for (const Sight& sight : sights) {
    std::size_t n = 0;
    for (const PassDetector& d : plan.detectors) {
      if (room_of(d).binning == nullptr) continue;
      const ClrayBinning& b = sight.binnings[n++];
      const SumBlock& block = plan.layout.blocks[d.first_block];
      for (std::uint64_t row = 0; row < shape.views * shape.lanes; ++row) {
        for (const std::size_t c : sight.connections) {
          for (std::uint64_t k = 0; k < block.width; ++k)
            sums->values.add(block.offset + (row * shape.connections + c) * block.width + k,
                             bins[b.offset + row * block.width + k]);
        }
      }
    }
  }
}

ExactNumbers exact_numbers(const PassPlan& plan) {
  ExactNumbers numbers;
  numbers.lanes = static_cast<std::uint32_t>(plan.request.lanes.size());
  for (const PassDetector& d : plan.detectors) numbers.binnings += room_of(d).binning != nullptr;
  const std::vector<Sight> sights = sights_of(plan);
  numbers.from_source = !sights.front().connections.empty();
  numbers.tiles = plan.request.tiles();
  numbers.carry = sights.size() > 1;
  return numbers;
}

}  // namespace clray
