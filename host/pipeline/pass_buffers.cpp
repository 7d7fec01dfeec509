// SPDX-License-Identifier: Apache-2.0
// See pass_buffers.hpp.
#include "pipeline/pass_buffers.hpp"

#include <numeric>

#include "beam/sobol.hpp"

namespace clray {
namespace {

template <class T>
Numbers<T> all_of(const std::vector<T>& values) {
  return {values.data(), values.size()};
}

}  // namespace

std::vector<std::uint32_t> all_views(const PassPlan& plan) {
  std::vector<std::uint32_t> views(plan.beams.views.size());
  std::iota(views.begin(), views.end(), 0u);
  return views;
}

PassBuffers::PassBuffers(const PassPlan& plan, const Geometry& geometry) {
  for (const SumBlock& block : plan.layout.blocks) own_blocks_.push_back({block.offset, block.width, 0});
  for (const PassDetector& detector : plan.detectors) {
    own_detectors_.push_back({detector.first_block, static_cast<std::uint32_t>(own_settings_.size())});
    own_settings_.insert(own_settings_.end(), detector.settings.begin(), detector.settings.end());
  }
  own_directions_ = sobol_directions_reversed();
  pass = {&plan.constants, 1};
  views = all_of(plan.beams.views);
  own_asked_ = all_views(plan);
  asked = all_of(own_asked_);
  connections = all_of(plan.beams.connections);
  nodes = all_of(plan.beams.nodes.empty() ? geometry.nodes : plan.beams.nodes);
  leaves = all_of(geometry.leaves);
  primitives = all_of(geometry.primitives);
  shapes = all_of(geometry.shapes);
  instances = all_of(plan.beams.instances);
  materials = all_of(plan.materials.rows);
  tables = all_of(plan.materials.tables);
  directions = all_of(own_directions_);
  detectors = all_of(own_detectors_);
  blocks = all_of(own_blocks_);
  settings = all_of(own_settings_);
  strata = all_of(plan.beams.strata);
  unsolved = all_of(plan.unsolved.bits);
  const auto& defines = plan.program.options.defines;
  const auto wide_define = defines.find("CLRAY_WIDE");  // a program without rays has none
  const bool wide_too = wide_define != defines.end() && wide_define->second == "1";
  sums.count = plan.layout.values;
  wide.count = wide_too ? plan.layout.values : 1;
  counts.count = plan.layout.counts;
  counters.count = CLRAY_COUNTERS * plan.beams.views.size();
}

}  // namespace clray
