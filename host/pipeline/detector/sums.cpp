// SPDX-License-Identifier: Apache-2.0
// See sums.hpp.
#include "pipeline/detector/sums.hpp"

#include <algorithm>

#include "pipeline/estimate.hpp"

namespace clray {
namespace {

/// Calls `function` with the block, lanes and connection of each row of a view of a detector's sums that have a unit.
template <class Function>
void each_row(const PassPlan& plan, const PassDetector& detector, Function&& function) {
  for (const LaneRecord& record : lane_records(plan.request.lanes)) {
    for (std::uint32_t b = detector.first_block; b < detector.last_block; ++b) {
      const SumBlock& block = plan.layout.blocks[b];
      if (block.unit.empty()) continue;
      const std::size_t connections = block.rows == SumRows::connection ? plan.layout.shape.connections : 1;
      for (std::size_t c = 0; c < connections; ++c) function(b, record, c);
    }
  }
}

std::vector<double> number_of(const PassPlan& plan, const SumReader& read, std::uint32_t b, std::size_t v,
                              const LaneRecord& record, std::size_t c, std::uint64_t k) {
  return per_replicate_of(plan, record, [&](std::size_t l, std::uint32_t r) { return read.value(b, v, l, c, r, k); });
}

/// Parts of a band may be traced in several passes: they add to the record of the first.
void add_table(const RoomResults& x, TableResult table, const LaneRecord& lanes) {
  const bool part = x.plan.request.lanes[lanes.first].share < 1.0;
  const auto same = [&](const TableResult& t) { return t.name == table.name && same_record(t.key, table.key); };
  const auto known = part ? std::find_if(x.out.table.begin(), x.out.table.end(), same) : x.out.table.end();
  if (known == x.out.table.end()) return x.out.table.push_back(std::move(table));
  for (std::size_t k = 0; k < known->values.size(); ++k)
    known->values[k] = sum_of_parts(known->values[k], table.values[k]);
}

void view_results(const RoomResults& x, std::size_t v) {
  each_row(x.plan, x.detector, [&](std::uint32_t b, const LaneRecord& record, std::size_t c) {
    const SumBlock& block = x.plan.layout.blocks[b];
    TableResult table;
    table.key = block.rows == SumRows::connection ? x.key(v, record.first, c) : x.key(v, record.first);
    table.name = block.name;
    table.unit = block.unit;
    bool lit = false;
    for (std::uint64_t k = 0; k < block.width; ++k) {
      table.values.push_back(estimate_total(number_of(x.plan, x.read, b, v, record, c, k), rays_of(x.read, v)));
      lit = lit || table.values.back().value != 0.0 || table.values.back().standard_error != 0.0;
    }
    x.note(table.key, lit);
    add_table(x, std::move(table), record);
  });
}

}  // namespace

void sums_results(const RoomResults& x) {
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) view_results(x, v);
}

void sums_targets(const TargetContext& x, std::vector<Target>* targets) {
  each_row(x.plan, x.detector, [&](std::uint32_t b, const LaneRecord& record, std::size_t c) {
    for (std::uint64_t k = 0; k < x.plan.layout.blocks[b].width; ++k) {
      Target target;
      target.components.push_back(number_of(x.plan, x.read, b, x.view, record, c, k));
      targets->push_back(std::move(target));
    }
  });
}

}  // namespace clray
