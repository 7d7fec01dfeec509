// SPDX-License-Identifier: Apache-2.0
// Computes parts of a saved run again (clray/saved.hpp). Replicates of a view are apart in the sums, so one of them can
// be traced alone; of pictures, of tiles and of exact passes whole views are taken.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "clray/error.hpp"
#include "clray/saved.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/exact_pass.hpp"
#include "pipeline/host_pass.hpp"
#include "pipeline/preparation.hpp"
#include "pipeline/run_saver.hpp"
#include "pipeline/tiles_runner.hpp"

namespace clray {
namespace {

constexpr std::uint32_t kChunk = 16;         // points of a work-item
constexpr std::uint64_t kBlock = 1u << 16;   // points between drains
constexpr std::uint64_t kLaunch = 1u << 14;  // work-items

/// Sums of one epoch of a pass.
struct Found {
  const Sums& sums;
  std::uint32_t epoch;
  std::uint64_t first, points;
  std::uint32_t view;
  std::vector<std::uint32_t> replicates;  ///< that are computed again
};

class Verifier {
 public:
  Verifier(Device& device, const PassPlan& plan, const Geometry& geometry, const SavedPass& saved,
           const TraceHooks& hooks, Verified* out)
      : device_(device), plan_(plan), geometry_(geometry), saved_(saved), hooks_(hooks), out_(*out) {}

  void run(double share, std::mt19937_64& random) {
    const std::uint32_t parts = plan_.request.without_rays() || plan_.request.pixels ? 1 : plan_.request.replicates;
    std::vector<std::pair<bool, std::uint64_t>> ranges;
    for (std::uint32_t v = 0; v < plan_.layout.shape.views; ++v) {
      for (const bool confirmed : {false, true}) {
        if (points(confirmed, v) == first(confirmed, v)) continue;
        for (std::uint32_t r = 0; r < parts; ++r) ranges.emplace_back(confirmed, std::uint64_t{v} * parts + r);
      }
    }
    out_.ranges += ranges.size();
    std::shuffle(ranges.begin(), ranges.end(), random);
    const auto wanted = static_cast<std::size_t>(std::llround(share * static_cast<double>(ranges.size())));
    ranges.resize(std::min(ranges.size(), std::max<std::size_t>(wanted, 1)));
    std::sort(ranges.begin(), ranges.end());
    out_.recomputed += ranges.size();
    for (std::size_t k = 0; k < ranges.size();) {
      const auto v = static_cast<std::uint32_t>(ranges[k].second / parts);
      const bool confirmed = ranges[k].first;
      Found found{sums(confirmed), confirmed ? saved_.epochs[v] : 0, first(confirmed, v), points(confirmed, v), v, {}};
      for (; k < ranges.size() && ranges[k].first == confirmed && ranges[k].second / parts == v; ++k)
        found.replicates.push_back(static_cast<std::uint32_t>(ranges[k].second % parts));
      const bool whole = found.replicates.size() == parts;
      compare(found, computed(found, whole), whole);
    }
  }

 private:
  const Sums& sums(bool confirmed) const { return confirmed ? saved_.confirmed : saved_.found; }
  std::uint64_t points(bool confirmed, std::uint32_t v) const {
    return sums(confirmed).points.empty() ? 0 : sums(confirmed).points[v];
  }
  std::uint64_t first(bool confirmed, std::uint32_t v) const {
    return confirmed || saved_.first.empty() ? 0 : saved_.first[v];
  }

  Sums computed(const Found& f, bool whole) {
    OpenStep step{f.epoch, f.first, f.points, {f.view}, 0, {}};
    const auto go = [&](double) { return keep_going(); };
    Sums sums(plan_.layout);
    if (plan_.request.exact()) {
      step.from = f.view;
      step.points = f.view + 1;
      ExactPass(device_, plan_, geometry_).run(&sums, &step, go, {});
    } else if (plan_.request.tiles()) {
      TilesRunner(device_, plan_, geometry_).run(&sums, &step, go, {});
    } else {
      trace(f, whole, &sums);
    }
    return sums;
  }

  bool keep_going() const {
    if (hooks_.stop != nullptr && hooks_.stop->load()) throw Error(ErrorCode::usage, "interrupted");
    return true;
  }

  void trace(const Found& f, bool whole, Sums* sums) {
    if (pass_ == nullptr) pass_ = std::make_unique<DevicePass>(device_.impl().devices.front(), plan_, geometry_);
    pass_->set_work(f.epoch, {f.view});
    const std::uint32_t replicates = plan_.request.replicates;
    for (std::uint64_t at = f.first; at < f.points; at += kBlock) {
      const auto count = static_cast<std::uint32_t>(std::min(kBlock, f.points - at));
      const std::uint64_t items = items_of(plan_, 1, count, kChunk);
      const PointBlock block{static_cast<std::uint32_t>(at), count, kChunk};
      if (whole) {
        launch(0, items, block);
      } else {
        for (const std::uint32_t r : f.replicates) launch(items / replicates * r, items / replicates, block);
      }
      pass_->drain(sums);
    }
  }

  void launch(std::uint64_t first, std::uint64_t items, const PointBlock& block) {
    for (std::uint64_t at = 0; at < items; at += kLaunch) {
      keep_going();
      pass_->launch_items(first + at, static_cast<std::uint32_t>(std::min(kLaunch, items - at)), block, 64);
    }
  }

  void compare(const Found& f, const Sums& again, bool whole) {
    for (const SumBlock& block : plan_.layout.blocks) {
      if (whole) {
        const SumRange range = range_of(plan_.layout, block, f.view, f.view + 1);
        compare(f, again, block, range.begin, range.end);
        continue;
      }
      if (block.rows == SumRows::view) continue;  // of all replicates together
      const std::uint64_t rows = block.row_count / plan_.layout.shape.views;
      for (std::uint64_t row = f.view * rows; row < (f.view + 1) * rows; ++row) {
        const auto replicate = static_cast<std::uint32_t>(row % plan_.layout.shape.replicates);
        if (std::find(f.replicates.begin(), f.replicates.end(), replicate) == f.replicates.end()) continue;
        compare(f, again, block, block.offset + row * block.width, block.offset + (row + 1) * block.width);
      }
    }
  }

  void compare(const Found& f, const Sums& again, const SumBlock& block, std::uint64_t begin, std::uint64_t end) {
    out_.numbers += end - begin;
    for (std::uint64_t k = begin; k < end; ++k) {
      const bool same = block.counts() ? f.sums.counts[k] == again.counts[k] : f.sums.values[k] == again.values[k];
      if (same) continue;
      out_.different.push_back(fmt::format("{} of view {}: number {} is another", block.name, f.view, k - begin));
      return;
    }
  }

  Device& device_;
  const PassPlan& plan_;
  const Geometry& geometry_;
  const SavedPass& saved_;
  const TraceHooks& hooks_;
  Verified& out_;
  std::unique_ptr<DevicePass> pass_;
};

}  // namespace

Verified verify(const Scene& scene, Device& device, const std::string& file, double share, std::uint64_t seed,
                const TraceHooks& hooks) {
  check_scene(scene);
  const DeviceUse use(device);
  Preparation kept(device);
  Planned planned = plan_scene(kept, scene);
  const Geometry& geometry = planned.geometry;
  Saving saving;
  saving.from = {file};
  saving.share = read_saved(file).share;
  RunSaver saver(saving);
  saver.begin(planned.plans, geometry);
  std::mt19937_64 random(seed);
  Verified out;
  for (PassPlan& plan : planned.plans) {
    take_lasting_program(&plan);
    // Its work-items have points of one replicate, and those of a replicate follow one another.
    if (!plan.request.without_rays()) set_walk("plain", &plan);
    if (plan.first)
      Verifier(device, plan.first->plan, geometry, saver.pass(plan.first->plan), hooks, &out).run(share, random);
    Verifier(device, plan, geometry, saver.pass(plan), hooks, &out).run(share, random);
  }
  return out;
}

}  // namespace clray
