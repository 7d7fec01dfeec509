// SPDX-License-Identifier: Apache-2.0
// Launching a pass in slices (see pass_runner.hpp). Work-items are numbered over the whole block of points, so any cut
// into slices, any work-group size and any number of devices adds the same integers.
#include "pipeline/pass_runner.hpp"

#include <algorithm>

#include "pipeline/clock.hpp"
#include "pipeline/host_pass.hpp"

namespace clray {
namespace {

// A program with the optimiser and packets takes about three times as long to build as one without. So rays are traced
// without for at most that long: a run of few rays is spared the building, one of many pays at most twice for it.
constexpr double kLonger = 3.0;
constexpr double kPatience_s = 2.0;      // at least, since the first program may have been kept
constexpr double kFirstRays = 1u << 18;  // the most of a first step, of which no earlier one tells the time
constexpr std::uint64_t kMostContributions = 1u << 24;  // per accumulator between drains (scales())

}  // namespace

PassRunner::PassRunner(Device& device, PassPlan& plan, const Geometry& geometry, const TraceOptions& options,
                       KeptPass* kept, const SharedPass& shared)
    : device_(device), plan_(plan), geometry_(geometry), options_(options), kept_(kept), shared_(shared) {
  build();
}

PassRunner::~PassRunner() = default;

void PassRunner::build() {
  const double start = now();
  devices_ = std::make_unique<DeviceTeam>(device_, plan_, geometry_, options_, kept_);
  compile_seconds_ += now() - start;
}

bool PassRunner::is_long(const OpenStep& step) const {
  const double points =
      static_cast<double>(step.points - step.from - step.done) * static_cast<double>(step.views.size());
  const double rays = points * static_cast<double>(items_of(plan_, 1, 1, 1));  // of each point, replicate and pixel
  if (points_traced_ == 0.0) return rays > kFirstRays;
  const double expected_s = seconds_ * (1.0 + points / points_traced_);
  return expected_s > std::max(kPatience_s, kLonger * compile_seconds_);
}

bool PassRunner::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                     const Checkpoint& checkpoint) {
  if (plan_.lasting && is_long(*step)) {
    if (!keep_going(0.0)) return false;  // before it waits for a compiler
    devices_.reset();
    kept_->clear();  // there need not be room for both
    take_lasting_program(&plan_);
    build();
  }
  const double begin = now();
  const double missing = static_cast<double>(step->points - step->from - step->done);
  devices_->set_work(step->epoch, step->views);
  const std::uint64_t bounces = static_cast<std::uint64_t>(plan_.traits.max_bounces) + 1;
  std::uint64_t block = kMostContributions / (2 * bounces);  // a bounce enters a book at most twice
  while ((block & (block - 1)) != 0) block &= block - 1;     // a power of two keeps neighbouring points together
  if (options_.slice_points != 0) block = std::min(block, options_.slice_points);
  std::uint64_t undrained = 0;
  for (std::uint64_t at = step->from + step->done; at < step->points;) {
    const std::uint64_t most = checkpoint.every_s > 0.0 ? std::min(block, block_points_) : block;
    const std::uint64_t count = std::min(step->points - at, most);
    const double done = static_cast<double>(at - step->from), all = static_cast<double>(step->points - step->from);
    const auto ask = [&](double share) { return keep_going((done + share * static_cast<double>(count)) / all); };
    if ((undrained + count) * 2 * bounces > kMostContributions) {
      drain_into(step, at - step->from);
      undrained = 0;
    }
    const double start = now();
    if (!run_block(*step, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count), ask)) {
      forget();
      return false;
    }
    // A block is what is lost where a run is killed, so it takes a fraction of what lies between two files of sums.
    if (count == most && now() - start < checkpoint.every_s / 8) block_points_ = std::min(2 * block_points_, block);
    if (now() - start > checkpoint.every_s / 2) block_points_ = std::max<std::uint64_t>(block_points_ / 2, 1);
    at += count;
    undrained += count;
    if (at < step->points && checkpoint.due && checkpoint.due()) {
      drain_into(step, at - step->from);
      undrained = 0;
      checkpoint.save();
    }
  }
  drain(sums);
  if (step->done > 0) sums->add(plan_.layout, step->more);
  for (const std::uint32_t v : step->views) sums->points[v] = step->points;
  points_traced_ += missing * static_cast<double>(step->views.size());
  seconds_ += now() - begin;
  return true;
}

/// Adds what all have traced since the last time. What a lost process had is traced again.
void PassRunner::drain(Sums* sums) {
  devices_->drain(sums);
  if (shared_.crew == nullptr) return;
  for (auto lost = shared_.crew->collect(plan_.layout, sums); !lost.empty();
       lost = shared_.crew->collect(plan_.layout, sums)) {
    for (const LostRange& one : lost) {
      OwnWork work(one.range.first + one.range.count, one.range.first);
      devices_->run(work, one.block, [](double) { return true; });
    }
    devices_->drain(sums);
  }
}

void PassRunner::forget() {
  devices_->clear();
  if (shared_.crew != nullptr) shared_.crew->forget();
}

/// Sums of an unfinished step stay apart from those of whole steps.
void PassRunner::drain_into(OpenStep* step, std::uint64_t done) {
  if (step->more.points.empty()) step->more = Sums(plan_.layout);
  drain(&step->more);
  step->done = done;
}

bool PassRunner::run_block(const OpenStep& step, std::uint32_t first_point, std::uint32_t points,
                           const std::function<bool(double)>& keep_going) {
  const std::uint32_t chunk = std::min(chunk_of(plan_), points);
  const PointBlock block{first_point, points, chunk, static_cast<std::uint32_t>(plan_.program.options.walk)};
  const std::uint64_t items = items_of(plan_, step.views.size(), points, chunk);
  const auto own = [&](WorkSource& work) { return devices_->run(work, block, keep_going); };
  if (shared_.crew == nullptr) {
    OwnWork work(items);
    return own(work);
  }
  CrewTask task;
  task.pass = shared_.number;
  task.step = {step.epoch, step.from, step.points, step.views, 0, {}};
  task.block = block;
  task.items = items;
  return shared_.crew->share(task, own, [&] { return keep_going(1.0); });
}

}  // namespace clray
