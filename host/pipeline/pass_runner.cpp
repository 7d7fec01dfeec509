// SPDX-License-Identifier: Apache-2.0
// Launching a pass in slices (see pass_runner.hpp). Work-items are numbered over the whole block of points, so any cut
// into slices, any work-group size and any number of devices adds the same integers.
#include "pipeline/pass_runner.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "clray/error.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/host_pass.hpp"
#include "pipeline/traced_self_test.hpp"
#include "pipeline/work_source.hpp"

namespace clray {
namespace {

constexpr double kSliceSeconds = 0.15;                  // of a launch: an interrupt waits no longer
constexpr std::uint64_t kMostContributions = 1u << 24;  // per accumulator between drains (scales())
constexpr std::uint32_t kChunk = 16;                    // points of a work-item
constexpr std::uint32_t kPacketChunk = 256;             // points of each replicate of a work-item with packets

}  // namespace

PassRunner::PassRunner(Device& device, const PassPlan& plan, const Geometry& geometry, const TraceOptions& options,
                       KeptPass* kept)
    : plan_(plan), options_(options) {
  const double start = now();
  const std::string name = "traced\n" + program_name("trace.cl", plan.program.options);
  for (OpenedDevice& opened : device.impl().devices)
    opened.test_once(name, [&] { run_traced_self_test(opened, plan, options.specialise); });
  devices_ = std::move(*kept);
  kept->clear();
  devices_.resize(device.impl().devices.size());
  for (std::size_t d = 0; d < devices_.size(); ++d) {
    if (devices_[d] != nullptr && devices_[d]->refill(plan, geometry)) continue;
    devices_[d] = std::make_shared<DevicePass>(device.impl().devices[d], plan, geometry);
    devices_[d]->slice_items = in_packets(plan) ? 4 : 4096;
  }
  *kept = devices_;
  compile_seconds_ = now() - start;
}

PassRunner::~PassRunner() = default;

bool PassRunner::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                     const Checkpoint& checkpoint) {
  for (auto& device : devices_) device->set_work(step->epoch, step->views);
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
    if (!run_block(step->views.size(), static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count), ask)) {
      for (auto& device : devices_) device->clear(plan_);
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
  return true;
}

/// Sums of an unfinished step stay apart from those of whole steps.
void PassRunner::drain_into(OpenStep* step, std::uint64_t done) {
  if (step->more.points.empty()) step->more = Sums(plan_.layout);
  drain(&step->more);
  step->done = done;
}

bool PassRunner::run_block(std::size_t views, std::uint32_t first_point, std::uint32_t points,
                           const std::function<bool(double)>& keep_going) {
  const bool packets = in_packets(plan_);
  const std::uint32_t chunk = std::min(packets ? kPacketChunk : kChunk, points);
  WorkSource source(items_of(plan_, views, points, chunk));
  std::atomic<bool> go{true};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](DevicePass& device) {
    try {
      while (go) {
        const std::optional<WorkRange> range = source.take(device.slice_items);
        if (!range) return;
        const auto count = static_cast<std::uint32_t>(range->count);
        const double start = now();
        device.launch_items(range->first, count, {first_point, points, chunk}, packets ? 1 : options_.work_group_size);
        const double seconds = now() - start;
        const double factor = std::clamp(kSliceSeconds / std::max(seconds, 1e-6), 0.25, 4.0);
        if (count == device.slice_items || factor < 1.0)
          device.slice_items = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(factor * count), packets ? 4 : 256,
                                                         device.most_items());
        const std::lock_guard<std::mutex> lock(mutex);
        const double done = static_cast<double>(range->first + count) / static_cast<double>(source.items());
        if (!keep_going(std::min(1.0, done))) go = false;
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = std::current_exception();
      go = false;
    }
  };
  if (devices_.size() == 1) {
    work(*devices_[0]);
  } else {
    std::vector<std::thread> threads;
    for (auto& device : devices_) threads.emplace_back([&work, &device] { work(*device); });
    for (std::thread& thread : threads) thread.join();
  }
  if (failure) std::rethrow_exception(failure);
  return go;
}

void PassRunner::drain(Sums* sums) {
  for (auto& device : devices_) device->drain(plan_, sums);
}

}  // namespace clray
