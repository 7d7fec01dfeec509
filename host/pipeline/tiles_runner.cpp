// SPDX-License-Identifier: Apache-2.0
// See tiles_runner.hpp.
#include "pipeline/tiles_runner.hpp"

#include <map>

#include "pipeline/clock.hpp"
#include "pipeline/exact_group.hpp"
#include "pipeline/sample_device.hpp"
#include "pipeline/tiles_sums.hpp"
#include "pipeline/tiles_view.hpp"

namespace clray {
namespace {

constexpr std::uint32_t kPurpose = 0x74696c65u;   // of the random numbers
constexpr std::uint32_t kOfSight = 0x9e3779b9u;   // those of another sight are others
constexpr std::size_t kMostKeptFaces = 1u << 20;  // of views that are kept between two steps

}  // namespace

struct TilesRunner::Parts {
  const PassPlan& plan;
  const Geometry& geometry;
  std::vector<Sight> sights;
  std::vector<std::unique_ptr<SampleDevice>> devices;
  std::map<std::uint32_t, std::vector<std::unique_ptr<TilesView>>> kept;  // of each view, one for each sight

  bool keeps_views() const {
    return plan.beams.views.size() * sights.size() * geometry.primitives.size() <= kMostKeptFaces;
  }
  SampleDevice& device_of(std::uint32_t view) { return *devices[view % devices.size()]; }

  ClraySampling sampling(std::uint32_t v, std::size_t sight, std::uint32_t epoch, std::uint64_t round,
                         bool adds) const {
    const ClrayView& view = plan.beams.views[v];
    ClraySampling s{};
    s.path_middle_m = view.path_middle_m;
    s.inv_path_per_m = view.inv_path_per_m;
    s.key0 = plan.constants.key0 ^ view.key0 ^ static_cast<std::uint32_t>(kOfSight * sight);
    s.key1 = plan.constants.key1 ^ view.key1 ^ kPurpose;
    s.epoch = epoch;
    s.round = static_cast<std::uint32_t>(round);
    s.replicates = plan.request.replicates;
    s.adds = adds ? 1 : 0;
    s.elsewhere = sight > 0 ? 1 : 0;
    return s;
  }

  /// Adds what a view in so many tiles brings to the observers of one sight.
  void add(std::uint32_t v, std::size_t n, const OpenStep& step, TilesView* view, Sums* sums) {
    SampleDevice& device = device_of(v);
    device.begin_view(view->group().on_device, view->light());
    const auto ask = [&](const SampledTiles& tiles, std::uint64_t points) {
      return device.sample(tiles, sampling(v, n, 0, points, false)).values;
    };
    const TilesView::Stage& stage = view->stage(step.points, ask);
    const TilesFound found{plan, geometry, sights, sights[n], *view, stage, v, step.points};
    add_covered(found, sums);
    SampleSums samples = device.sample(stage.mixed, sampling(v, n, step.epoch, step.points, true));
    add_sampled(found, samples, sums);
    if (step.epoch == 0) view->note(step.points, std::move(samples.values));
  }
};

TilesRunner::TilesRunner(Device& device, const PassPlan& plan, const Geometry& geometry)
    : parts_(new Parts{plan, geometry, sights_of(plan), {}, {}}) {
  const double start = now();
  lay_out_bins(plan, &parts_->sights);
  for (Sight& sight : parts_->sights) {
    std::uint64_t numbers = 0;
    for (ClrayBinning& b : sight.binnings) {
      b.offset = numbers;  // of one view
      numbers += plan.request.lanes.size() * (b.bins + 2);
    }
  }
  parts_->devices = on_each_device(&device.impl(), [&](OpenedDevice& opened) {
    return std::make_unique<SampleDevice>(opened, plan.program.options, exact_numbers(plan));
  });
  compile_seconds_ = now() - start;
}

TilesRunner::~TilesRunner() = default;

bool TilesRunner::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                      const Checkpoint& checkpoint) {
  const PassPlan& plan = parts_->plan;
  if (step->more.points.empty()) step->more = Sums(plan.layout);
  while (step->done < step->views.size()) {
    const std::uint32_t v = step->views[step->done];
    if (!keep_going(static_cast<double>(step->done) / static_cast<double>(step->views.size()))) return false;
    std::vector<std::unique_ptr<TilesView>>& kept = parts_->kept[v];
    kept.resize(parts_->sights.size());
    for (std::size_t n = 0; n < parts_->sights.size(); ++n) {
      const Sight& sight = parts_->sights[n];
      if (sight.connections.empty()) continue;
      if (kept[n] == nullptr) kept[n] = std::make_unique<TilesView>(plan, parts_->geometry, parts_->sights, sight, v);
      parts_->add(v, n, *step, kept[n].get(), &step->more);
      if (!parts_->keeps_views()) kept[n].reset();
    }
    step->more.points[v] = step->points;
    ++step->done;
    if (step->done < step->views.size() && checkpoint.due && checkpoint.due()) checkpoint.save();
  }
  for (const std::uint32_t v : step->views) sums->set_view(plan.layout, v, &step->more);
  return true;
}

}  // namespace clray
