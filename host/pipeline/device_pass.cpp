// SPDX-License-Identifier: Apache-2.0
// See device_pass.hpp.
#include "pipeline/device_pass.hpp"

#include <algorithm>

#include "device/buffers.hpp"

namespace clray {
namespace {

/// Whether a buffer holds what the geometry alone decides.
bool of_the_body(const std::string& buffer, const PassPlan& plan) {
  return buffer == "primitives" || buffer == "shapes" || buffer == "leaves" ||
         (buffer == "nodes" && plan.beams.nodes.empty());
}

}  // namespace

DevicePass::DevicePass(OpenedDevice& device, const PassPlan& plan, const Geometry& geometry, const KernelFiles& files)
    : opened_(device) {
  const ProgramOptions& options = plan.program.options;
  const bool embedded = &files == &embedded_kernels();
  const cl::Program program =
      embedded ? build_program(opened_, "trace.cl", options)
               : build_source(opened_, "trace.cl", program_source(opened_, "trace.cl", options, files),
                              options.warnings_are_errors, options.optimised);
  kernel_ = make_kernel(opened_, program, "clray_trace");
  fill(plan, geometry);
}

bool DevicePass::refill(const PassPlan& plan, const Geometry& geometry) {
  if (!(plan.program.options == options_)) return false;
  fill(plan, geometry);
  return true;
}

template <class T>
void DevicePass::fill(const char* name, const Numbers<T>& numbers, bool of_the_body) {
  const std::size_t count = std::max<std::size_t>(numbers.count, 1);
  // The body, which outlives its passes, and large tables of a plan are read where they stand. No launch follows the
  // plan's end before the next one is filled in.
  const auto at = buffers_.find(name);
  if (of_the_body && at != buffers_.end() && at->second.of_the_host) return;  // a pass has one body
  if (opened_.shares_memory && (of_the_body || name == std::string("strata")) && numbers.count > 0) {
    buffers_[name] = {{nullptr, buffer_of(opened_, numbers.data, numbers.count)}, count, true};
    return;
  }
  const bool fits = at != buffers_.end() && at->second.count >= count && !at->second.of_the_host;
  if (fits && (numbers.data == nullptr || of_the_body)) return;  // drains leave zeros, and a pass has one body
  Kept made{{}, count};
  if (numbers.data == nullptr && numbers.count > 0) {
    made.numbers = make_zeros<T>(opened_, numbers.count);
  } else if (fits) {
    queue_write(opened_, at->second.numbers.buffer, numbers.data, numbers.count);
    return;
  } else {
    made.numbers.buffer = make_buffer(opened_, numbers.data, numbers.count);
  }
  buffers_[name] = made;
}

void DevicePass::fill(const PassPlan& plan, const Geometry& geometry) {
  options_ = plan.program.options;
  constants_ = plan.constants;
  layout_ = plan.layout;
  asked_ = all_views(plan);
  room_first_ = room_end_ = 0;
  has_wide_ = options_.defines.at("CLRAY_WIDE") == "1";
  PassBuffers in(plan, geometry);
  in.sums.count = in.wide.count = in.counts.count = 1;  // make_room() knows for which views
#define CLRAY_FILL(type, name) fill(#name, in.name, of_the_body(#name, plan));
  CLRAY_BUFFERS(CLRAY_FILL)
#undef CLRAY_FILL
  finish(opened_);  // what was queued reads `in`
  bind();
}

void DevicePass::bind() {
  first_argument_ = 0;
  with_cl_errors(opened_.info.name, [&] {
#define CLRAY_BIND(type, name) kernel_.setArg(first_argument_++, buffers_.at(#name).numbers.buffer);
    CLRAY_BUFFERS(CLRAY_BIND)
#undef CLRAY_BIND
  });
}

template <class T>
void DevicePass::make_room(const char* name, std::uint64_t count) {
  Kept& kept = buffers_.at(name);
  if (kept.count >= count) return;  // drains leave zeros
  check_sums_size(opened_, count * sizeof(T) / sizeof(std::int64_t));
  kept = {};  // before there is another
  kept = {make_zeros<T>(opened_, count), count};
}

/// Lets the buffers of sums hold those of the views that are asked for, and tells the kernel where they stand: it
/// counts rows from the first of all views.
void DevicePass::make_room() {
  if (has_room()) return;
  room_first_ = asked_.front();
  room_end_ = asked_.back() + 1;
  shifts_.clear();
  std::uint64_t values = 0, counts = 0;
  std::vector<ClrayBlock> blocks;
  for (const SumBlock& block : layout_.blocks) {
    const SumRange range = range_of(layout_, block, room_first_, room_end_);
    std::uint64_t& end = block.counts() ? counts : values;
    shifts_.push_back(end - range.begin);
    blocks.push_back({block.offset + shifts_.back(), block.width, 0});
    end += range.end - range.begin;
  }
  make_room<std::int64_t>("sums", values);
  if (has_wide_) make_room<std::int64_t>("wide", values);
  make_room<std::uint32_t>("counts", counts);
  write_buffer(opened_, buffers_.at("blocks").numbers.buffer, blocks);
  bind();
}

void DevicePass::clear() {
  if (!has_room()) return;  // nothing was launched
  for (std::size_t b = 0; b < layout_.blocks.size(); ++b) {
    const SumBlock& block = layout_.blocks[b];
    const SumRange range = range_of(layout_, block, asked_.front(), asked_.back() + 1);
    const std::uint64_t count = range.end - range.begin, first = range.begin + shifts_[b];
    if (block.counts()) {
      clear_zeros<std::uint32_t>(opened_, buffers_.at("counts").numbers, first, count);
    } else {
      clear_zeros<std::int64_t>(opened_, buffers_.at("sums").numbers, first, count);
      if (has_wide_) clear_zeros<std::int64_t>(opened_, buffers_.at("wide").numbers, first, count);
    }
  }
  const Kept& counters = buffers_.at("counters");
  clear_zeros<std::int64_t>(opened_, counters.numbers, 0, counters.count);
}

void DevicePass::set_work(std::uint32_t epoch, const std::vector<std::uint32_t>& views) {
  if (constants_.epoch != epoch) {
    constants_.epoch = epoch;
    write_buffer(opened_, buffers_.at("pass").numbers.buffer, std::vector<ClrayPass>{constants_});
  }
  if (asked_ == views) return;
  asked_ = views;
  write_buffer(opened_, buffers_.at("asked").numbers.buffer, asked_);
}

void DevicePass::launch_items(std::uint64_t first, std::uint32_t items, const PointBlock& block, std::uint32_t group) {
  make_room();
  with_cl_errors(opened_.info.name, [&] {
    kernel_.setArg(first_argument_ + 0, static_cast<cl_ulong>(first));
    kernel_.setArg(first_argument_ + 1, static_cast<cl_uint>(items));
    kernel_.setArg(first_argument_ + 2, static_cast<cl_uint>(block.first));
    kernel_.setArg(first_argument_ + 3, static_cast<cl_uint>(block.count));
    kernel_.setArg(first_argument_ + 4, static_cast<cl_uint>(block.chunk));
  });
  launch(opened_, kernel_, items, group);
  finish(opened_);
}

void DevicePass::drain(Sums* sums) {
  if (!has_room()) return;  // nothing was launched
  for (std::size_t b = 0; b < layout_.blocks.size(); ++b) {
    const SumBlock& block = layout_.blocks[b];
    const std::uint64_t shift = shifts_[b];
    const SumRange range = range_of(layout_, block, asked_.front(), asked_.back() + 1);
    const std::uint64_t first = range.begin + shift, count = range.end - range.begin;
    if (block.counts()) {
      const bool greatest = block.scale == SumScale::greatest;
      const auto add = [&](std::uint64_t at, const std::uint32_t* more, std::size_t n) {
        for (std::size_t k = 0; k < n; ++k) {
          const std::uint64_t to = at - shift + k;
          if (!greatest) {
            sums->counts.add(to, more[k]);
          } else if (more[k] > sums->counts[to]) {
            sums->counts.set(to, more[k]);
          }
        }
      };
      take_zeros<std::uint32_t>(opened_, buffers_.at("counts").numbers, first, count, add);
      continue;
    }
    const auto take = [&](const char* buffer, std::int64_t unit) {
      const auto add = [&](std::uint64_t at, const std::int64_t* more, std::size_t n) {
        for (std::size_t k = 0; k < n; ++k) sums->values.add(at - shift + k, static_cast<Sum>(more[k]) * unit);
      };
      take_zeros<std::int64_t>(opened_, buffers_.at(buffer).numbers, first, count, add);
    };
    take("sums", 1);
    if (has_wide_) take("wide", 4294967296);
  }
  const Kept& counters = buffers_.at("counters");
  const auto add = [&](std::uint64_t at, const std::int64_t* events, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      sums->events[(at + k) / CLRAY_COUNTERS][(at + k) % CLRAY_COUNTERS] += static_cast<std::uint64_t>(events[k]);
  };
  take_zeros<std::int64_t>(opened_, counters.numbers, 0, CLRAY_COUNTERS * sums->events.size(), add);
}

}  // namespace clray
