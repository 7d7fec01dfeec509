// SPDX-License-Identifier: Apache-2.0
// See tiles_runner.hpp.
#include "pipeline/tiles_runner.hpp"

#include <map>

#include "clray/error.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/device_team.hpp"
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
  struct Member {
    OpenedDevice* opened;
    std::unique_ptr<SampleDevice> device;
  };
  const PassPlan& plan;
  const Geometry& geometry;
  std::vector<Sight> sights;
  Device::Impl& impl;
  std::vector<Member> devices;
  std::map<std::uint32_t, std::vector<std::unique_ptr<TilesView>>> kept;  // of each view, one for each sight
  Pause pause{[] { return true; }};                                       // of the step that is taken; views know it

  bool keeps_views() const {
    return plan.beams.views.size() * sights.size() * geometry.primitives.size() <= kMostKeptFaces;
  }
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
  void add(SampleDevice& device, std::uint32_t v, std::size_t n, const OpenStep& step, TilesView* view, Sums* sums) {
    device.begin_view(view->group().on_device, view->light());
    const auto ask = [&](const SampledTiles& tiles, std::uint64_t points) {
      return device.sample(tiles, sampling(v, n, 0, points, false), &pause).values;
    };
    const TilesView::Stage& stage = view->stage(step.points, ask, &pause);
    const TilesFound found{plan, geometry, sights, sights[n], *view, stage, v, step.points};
    add_covered(found, sums, &pause);
    SampleSums samples = device.sample(stage.mixed, sampling(v, n, step.epoch, step.points, true), &pause);
    add_sampled(found, samples, sums);
    if (step.epoch == 0) view->note(step.points, std::move(samples.values));
  }

  /// Adds what a view brings to all observers.
  void add_view(SampleDevice& device, std::uint32_t v, OpenStep* step) {
    std::vector<std::unique_ptr<TilesView>>& views = kept[v];
    views.resize(sights.size());
    for (std::size_t n = 0; n < sights.size(); ++n) {
      if (sights[n].connections.empty()) continue;
      if (views[n] == nullptr) views[n] = std::make_unique<TilesView>(plan, geometry, sights, sights[n], v);
      add(device, v, n, *step, views[n].get(), &step->more);
      if (!keeps_views()) views[n].reset();
    }
    step->more.points[v] = step->points;
  }

  /// The same on one of the devices that are left. One that fails is left out, and the view is taken by another. A view
  /// is whole in step->more or not there.
  void take_view(std::uint32_t v, OpenStep* step) {
    for (;;) {
      const std::size_t d = v % devices.size();
      try {
        return add_view(*devices[d].device, v, step);
      } catch (const Error& error) {
        step->more.set_view(plan.layout, v, nullptr);
        if (error.code() != ErrorCode::device || devices.size() == 1) throw;
        leave_out(&impl, devices[d].opened, error);
        devices.erase(devices.begin() + static_cast<std::ptrdiff_t>(d));
      } catch (const Pause::Stopped&) {
        step->more.set_view(plan.layout, v, nullptr);
        throw;
      }
    }
  }
};

TilesRunner::TilesRunner(Device& device, const PassPlan& plan, const Geometry& geometry)
    : parts_(new Parts{plan, geometry, sights_of(plan), device.impl(), {}, {}}) {
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
    return Parts::Member{&opened, std::make_unique<SampleDevice>(opened, plan.program.options, exact_numbers(plan))};
  });
  compile_seconds_ = now() - start;
}

TilesRunner::~TilesRunner() = default;

bool TilesRunner::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                      const Checkpoint& checkpoint) {
  const PassPlan& plan = parts_->plan;
  if (step->more.points.empty()) step->more = Sums(plan.layout);
  const auto ask = [&] {
    return keep_going(static_cast<double>(step->done) / static_cast<double>(step->views.size()));
  };
  parts_->pause = Pause(ask);
  while (step->done < step->views.size()) {
    if (!ask()) return false;
    try {
      parts_->take_view(step->views[step->done], step);
    } catch (const Pause::Stopped&) {
      return false;
    }
    ++step->done;
    if (step->done < step->views.size() && checkpoint.due && checkpoint.due()) checkpoint.save();
  }
  for (const std::uint32_t v : step->views) sums->set_view(plan.layout, v, &step->more);
  return true;
}

}  // namespace clray
