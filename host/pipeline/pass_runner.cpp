// SPDX-License-Identifier: Apache-2.0
// Launching a pass in slices (see pass_runner.hpp). Work-items are numbered over the whole block of points, so any cut
// into slices, any work-group size and any number of devices adds the same integers.
#include "pipeline/pass_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <thread>

#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "pipeline/sobol.hpp"
#include "pipeline/work_source.hpp"
#include "shared/buffers.h"

namespace clray {
namespace {

constexpr double kSliceSeconds = 0.15;                  // of a launch: an interrupt waits no longer
constexpr std::uint64_t kMostContributions = 1u << 24;  // per accumulator between drains (scales())
constexpr std::uint32_t kChunk = 16;                    // points of a work-item

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

/// A pass on one device.
struct PassRunner::OnDevice {
  OpenedDevice& opened;
  cl::Kernel kernel;
  std::map<std::string, cl::Buffer> buffers;  // by the names of shared/buffers.h
  ClrayPass constants;
  std::uint64_t slice_items = 4096;  // of the next launch
  bool has_wide = false;
  cl_uint first_argument = 0;  // behind the buffers

  OnDevice(OpenedDevice& device, const PassPlan& plan, const Geometry& geometry)
      : opened(device), constants(plan.constants) {
    const ProgramOptions& options = plan.program.options;
    kernel = make_kernel(opened, build_program(opened, "trace.cl", options), "clray_trace");
    check_size(plan);
    has_wide = options.defines.at("CLRAY_WIDE") == "1";
    fill(plan, geometry);
    with_cl_errors(opened.info.name, [&] {
#define CLRAY_BIND(type, name) kernel.setArg(first_argument++, buffers.at(#name));
      CLRAY_BUFFERS(CLRAY_BIND)
#undef CLRAY_BIND
    });
  }

  template <class T>
  void put(const char* name, const std::vector<T>& values) {
    buffers[name] = make_buffer(opened, values);
  }

  void fill(const PassPlan& plan, const Geometry& geometry) {
    std::vector<ClrayBlock> blocks;
    for (const SumBlock& block : plan.layout.blocks) blocks.push_back({block.offset, block.width, 0});
    std::vector<ClrayDetector> detectors;
    std::vector<double> settings;
    for (const PassDetector& detector : plan.detectors) {
      detectors.push_back({detector.first_block, static_cast<std::uint32_t>(settings.size())});
      settings.insert(settings.end(), detector.settings.begin(), detector.settings.end());
    }
    put("pass", std::vector<ClrayPass>{constants});
    put("views", plan.beams.views);
    put("connections", plan.beams.connections);
    put("nodes", plan.beams.nodes);
    put("primitives", geometry.primitives);
    put("shapes", geometry.shapes);
    put("instances", plan.beams.instances);
    put("materials", plan.surfaces.materials);
    put("tables", plan.surfaces.tables);
    put("directions", sobol_directions_reversed());
    put("detectors", detectors);
    put("blocks", blocks);
    put("settings", settings);
    put("strata", plan.beams.strata);
    buffers["sums"] = make_zero_buffer<std::int64_t>(opened, plan.layout.values);
    buffers["wide"] = make_zero_buffer<std::int64_t>(opened, has_wide ? plan.layout.values : 1);
    buffers["counts"] = make_zero_buffer<std::uint32_t>(opened, plan.layout.counts);
    buffers["counters"] = make_zero_buffer<std::int64_t>(opened, CLRAY_COUNTERS);
  }

  void check_size(const PassPlan& plan) const {
    const double bytes = 8.0 * static_cast<double>(plan.layout.values), limit = most_bytes();
    if (bytes > limit)
      throw Error(
          ErrorCode::input,
          fmt::format("the detectors need {:.3g} GiB in one buffer, {} gives at most {:.3g}: fewer bins, pixels, "
                      "orientations or wavelengths are needed",
                      bytes / 1073741824.0, opened.info.name, limit / 1073741824.0));
  }
  double most_bytes() const {
    return with_cl_errors(opened.info.name,
                          [&] { return static_cast<double>(opened.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>()); });
  }

  /// Sets everything that is summed to zero.
  void clear(const PassPlan& plan) {
    zero_buffer<std::int64_t>(opened, buffers.at("sums"), plan.layout.values);
    if (has_wide) zero_buffer<std::int64_t>(opened, buffers.at("wide"), plan.layout.values);
    zero_buffer<std::uint32_t>(opened, buffers.at("counts"), plan.layout.counts);
    zero_buffer<std::int64_t>(opened, buffers.at("counters"), CLRAY_COUNTERS);
  }

  void set_epoch(std::uint32_t epoch) {
    if (constants.epoch == epoch) return;
    constants.epoch = epoch;
    write_buffer(opened, buffers.at("pass"), std::vector<ClrayPass>{constants});
  }

  void launch_items(std::uint64_t first, std::uint32_t items, std::uint32_t first_point, std::uint32_t points,
                    std::uint32_t chunk, std::uint32_t group) {
    with_cl_errors(opened.info.name, [&] {
      kernel.setArg(first_argument + 0, static_cast<cl_ulong>(first));
      kernel.setArg(first_argument + 1, static_cast<cl_uint>(items));
      kernel.setArg(first_argument + 2, static_cast<cl_uint>(first_point));
      kernel.setArg(first_argument + 3, static_cast<cl_uint>(points));
      kernel.setArg(first_argument + 4, static_cast<cl_uint>(chunk));
    });
    launch(opened, kernel, items, group);
    finish(opened);
  }
};

PassRunner::PassRunner(Device& device, const PassPlan& plan, const Geometry& geometry, const TraceOptions& options)
    : plan_(plan), options_(options) {
  const double start = now();
  for (OpenedDevice& opened : device.impl().devices)
    devices_.push_back(std::make_unique<OnDevice>(opened, plan, geometry));
  compile_seconds_ = now() - start;
}

PassRunner::~PassRunner() = default;

bool PassRunner::run(Sums* sums, std::uint64_t points, std::uint32_t epoch,
                     const std::function<bool(double)>& keep_going) {
  for (auto& device : devices_) device->set_epoch(epoch);
  const std::uint64_t begin = sums->points;
  const std::uint64_t bounces = static_cast<std::uint64_t>(plan_.traits.max_bounces) + 1;
  std::uint64_t block = kMostContributions / (2 * bounces);  // a bounce enters a book at most twice
  while ((block & (block - 1)) != 0) block &= block - 1;     // a power of two keeps neighbouring points together
  if (options_.slice_points != 0) block = std::min(block, options_.slice_points);
  std::uint64_t at = begin, undrained = 0;
  Sums before;  // a copy only where sums must be drained before the end: pictures' are large
  while (at < points) {
    const std::uint64_t count = std::min(points - at, block);
    const double done = static_cast<double>(at - begin), all = static_cast<double>(points - begin);
    const auto ask = [&](double share) { return keep_going((done + share * static_cast<double>(count)) / all); };
    if ((undrained + count) * 2 * bounces > kMostContributions) {
      if (before.values.empty()) before = *sums;
      drain(sums);
      undrained = 0;
    }
    if (!run_block(static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count), ask)) {
      if (!before.values.empty()) *sums = std::move(before);
      for (auto& device : devices_) device->clear(plan_);
      return false;
    }
    at += count;
    undrained += count;
  }
  drain(sums);
  sums->points = points;
  return true;
}

bool PassRunner::run_block(std::uint32_t first_point, std::uint32_t points,
                           const std::function<bool(double)>& keep_going) {
  const std::uint32_t chunk = std::min(kChunk, points);
  const PictureSize& size = plan_.request.picture;
  const std::uint64_t pixels = plan_.request.pixels ? static_cast<std::uint64_t>(size.width) * size.height : 1;
  WorkSource source((static_cast<std::uint64_t>(points) + chunk - 1) / chunk * plan_.request.replicates * pixels *
                    plan_.beams.views.size());
  std::atomic<bool> go{true};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](OnDevice& device) {
    try {
      while (go) {
        const std::optional<WorkRange> range = source.take(device.slice_items);
        if (!range) return;
        const auto count = static_cast<std::uint32_t>(range->count);
        const double start = now();
        device.launch_items(range->first, count, first_point, points, chunk, options_.work_group_size);
        const double seconds = now() - start;
        const double factor = std::clamp(kSliceSeconds / std::max(seconds, 1e-6), 0.25, 4.0);
        if (count == device.slice_items || factor < 1.0)
          device.slice_items = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(factor * count), 256, 1u << 26);
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

namespace {

/// Adds a buffer of the device, times `unit`, in blocks: memory of that size is reused, not mapped anew.
void add_to(std::vector<Sum>* values, OpenedDevice& opened, const cl::Buffer& buffer, std::int64_t unit) {
  constexpr std::size_t kBlock = 1u << 18;
  for (std::size_t first = 0; first < values->size(); first += kBlock) {
    const auto block = read_buffer<std::int64_t>(opened, buffer, std::min(kBlock, values->size() - first), first);
    for (std::size_t k = 0; k < block.size(); ++k) (*values)[first + k] += static_cast<Sum>(block[k]) * unit;
  }
}

}  // namespace

void PassRunner::drain(Sums* sums) {
  sums->values.resize(plan_.layout.values, 0);
  sums->counts.resize(plan_.layout.counts, 0);
  for (auto& device : devices_) {
    OpenedDevice& opened = device->opened;
    add_to(&sums->values, opened, device->buffers.at("sums"), 1);
    if (device->has_wide) add_to(&sums->values, opened, device->buffers.at("wide"), 4294967296);
    merge_counts(plan_.layout, read_buffer<std::uint32_t>(opened, device->buffers.at("counts"), plan_.layout.counts),
                 &sums->counts);
    const auto events = read_buffer<std::int64_t>(opened, device->buffers.at("counters"), CLRAY_COUNTERS);
    for (std::size_t c = 0; c < CLRAY_COUNTERS; ++c) sums->events[c] += static_cast<std::uint64_t>(events[c]);
    device->clear(plan_);
  }
}

}  // namespace clray
