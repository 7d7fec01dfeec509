// SPDX-License-Identifier: Apache-2.0
// Launching a pass in slices (see pass_runner.hpp). Work-items are numbered over the whole block of points, so any cut
// into slices, any work-group size and any number of devices adds the same integers.
#include "pipeline/pass_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "pipeline/sobol.hpp"

namespace clray {
namespace {

constexpr double kSliceSeconds = 0.15;                  // of a launch; DESIGN asks for at most 0.3
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
  cl::Buffer pass, sums, wide, hits, counters;
  std::vector<cl::Buffer> constant;  // kept alive with the kernel
  ClrayPass constants;
  std::uint64_t slice_items = 4096;  // of the next launch
  bool has_wide = false;

  OnDevice(OpenedDevice& device, const PassPlan& plan, const Geometry& geometry)
      : opened(device), constants(plan.constants) {
    const cl::Program program = build_program(opened, "trace.cl", plan.options);
    kernel = make_kernel(opened, program, "clray_trace");
    check_size(plan);
    has_wide = plan.options.defines.at("CLRAY_WIDE") == "1";
    pass = make_buffer(opened, std::vector<ClrayPass>{constants});
    sums = make_zero_buffer<std::int64_t>(opened, plan.sums_size);
    wide = make_zero_buffer<std::int64_t>(opened, has_wide ? plan.sums_size : 1);
    hits = make_zero_buffer<std::uint32_t>(opened, plan.hits_size);
    counters = make_zero_buffer<std::int64_t>(opened, CLRAY_COUNTERS);
    keep(plan.views);
    keep(plan.connection_rows);
    keep(plan.nodes);
    keep(geometry.primitives);
    keep(geometry.shapes);
    keep(plan.instances);
    keep(plan.surfaces.materials);
    keep(plan.surfaces.tables);
    keep(sobol_directions_reversed());
    keep(plan.delay_rows);
    keep(plan.strata);
    cl_uint index = 0;
    const auto set = [&](const cl::Buffer& buffer) { kernel.setArg(index++, buffer); };
    with_cl_errors(opened.info.name, [&] {
      set(pass);
      for (const cl::Buffer& buffer : constant) set(buffer);
      set(sums);
      set(wide);
      set(hits);
      set(counters);
    });
  }

  template <class T>
  void keep(const std::vector<T>& values) {
    constant.push_back(make_buffer(opened, values));
  }

  void check_size(const PassPlan& plan) const {
    const double bytes = 8.0 * static_cast<double>(plan.sums_size), limit = most_bytes();
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
    zero_buffer<std::int64_t>(opened, sums, plan.sums_size);
    if (has_wide) zero_buffer<std::int64_t>(opened, wide, plan.sums_size);
    zero_buffer<std::uint32_t>(opened, hits, plan.hits_size);
    zero_buffer<std::int64_t>(opened, counters, CLRAY_COUNTERS);
  }

  void set_epoch(std::uint32_t epoch) {
    if (constants.epoch == epoch) return;
    constants.epoch = epoch;
    write_buffer(opened, pass, std::vector<ClrayPass>{constants});
  }

  void launch_items(std::uint64_t first, std::uint32_t items, std::uint32_t first_point, std::uint32_t points,
                    std::uint32_t chunk, std::uint32_t group) {
    with_cl_errors(opened.info.name, [&] {
      kernel.setArg(16, static_cast<cl_ulong>(first));
      kernel.setArg(17, static_cast<cl_uint>(items));
      kernel.setArg(18, static_cast<cl_uint>(first_point));
      kernel.setArg(19, static_cast<cl_uint>(points));
      kernel.setArg(20, static_cast<cl_uint>(chunk));
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
  const std::uint64_t bounces = static_cast<std::uint64_t>(plan_.max_bounces) + 1;
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
  const std::uint64_t pixels = plan_.pixels ? static_cast<std::uint64_t>(plan_.width) * plan_.height : 1;
  const std::uint64_t items =
      (static_cast<std::uint64_t>(points) + chunk - 1) / chunk * plan_.replicates * pixels * plan_.views.size();
  std::atomic<std::uint64_t> next{0};
  std::atomic<bool> go{true};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](OnDevice& device) {
    try {
      while (go) {
        const std::uint64_t first = next.fetch_add(device.slice_items);
        if (first >= items) return;
        const auto count = static_cast<std::uint32_t>(std::min(device.slice_items, items - first));
        const double start = now();
        device.launch_items(first, count, first_point, points, chunk, options_.work_group_size);
        const double seconds = now() - start;
        const double factor = std::clamp(kSliceSeconds / std::max(seconds, 1e-6), 0.25, 4.0);
        if (count == device.slice_items || factor < 1.0)
          device.slice_items = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(factor * count), 256, 1u << 26);
        const std::lock_guard<std::mutex> lock(mutex);
        if (!keep_going(std::min(1.0, static_cast<double>(first + count) / static_cast<double>(items)))) go = false;
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
  sums->values.resize(plan_.sums_size, 0);
  sums->hits.resize(plan_.hits_size, 0);
  for (auto& device : devices_) {
    OpenedDevice& opened = device->opened;
    add_to(&sums->values, opened, device->sums, 1);
    if (device->has_wide) add_to(&sums->values, opened, device->wide, 4294967296);
    const auto hits = read_buffer<std::uint32_t>(opened, device->hits, plan_.hits_size);
    std::size_t k = 0;
    if (plan_.pixels) {
      for (; k < hits.size(); ++k) sums->hits[k] += hits[k];
    }
    for (const DelayPlan& delay : plan_.delays) {
      const std::size_t row = delay.bins + 3;
      const std::size_t rows = plan_.views.size() * plan_.lanes.size() * plan_.connections * plan_.replicates;
      for (std::size_t r = 0; r < rows; ++r) {
        const std::size_t at = delay.hits + r * row;
        // The largest weight is a maximum, the rest are counts.
        sums->hits[at] = std::max<std::uint64_t>(sums->hits[at], hits[at]);
        for (std::size_t b = 1; b < row; ++b) sums->hits[at + b] += hits[at + b];
      }
    }
    const auto counters = read_buffer<std::int64_t>(opened, device->counters, CLRAY_COUNTERS);
    for (std::size_t c = 0; c < CLRAY_COUNTERS; ++c) sums->counters[c] += static_cast<std::uint64_t>(counters[c]);
    device->clear(plan_);
  }
}

}  // namespace clray
