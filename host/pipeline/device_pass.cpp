// SPDX-License-Identifier: Apache-2.0
// See device_pass.hpp.
#include "pipeline/device_pass.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clray/error.hpp"
#include "device/buffers.hpp"

namespace clray {
namespace {

template <class T>
cl::Buffer filled(OpenedDevice& opened, const Numbers<T>& numbers) {
  return numbers.data != nullptr || numbers.count == 0 ? make_buffer(opened, numbers.data, numbers.count)
                                                       : make_zero_buffer<T>(opened, numbers.count);
}

/// Adds a buffer of the device, times `unit`. It goes in blocks, so that memory is reused and not mapped anew.
void add_to(std::vector<Sum>* values, OpenedDevice& opened, const cl::Buffer& buffer, std::int64_t unit) {
  constexpr std::size_t kBlock = 1u << 18;
  for (std::size_t first = 0; first < values->size(); first += kBlock) {
    const auto block = read_buffer<std::int64_t>(opened, buffer, std::min(kBlock, values->size() - first), first);
    for (std::size_t k = 0; k < block.size(); ++k) (*values)[first + k] += static_cast<Sum>(block[k]) * unit;
  }
}

}  // namespace

DevicePass::DevicePass(OpenedDevice& device, const PassPlan& plan, const Geometry& geometry, const KernelFiles& files)
    : opened_(device), constants_(plan.constants) {
  const ProgramOptions& options = plan.program.options;
  const std::string source = program_source(opened_, "trace.cl", options, files);
  kernel_ = make_kernel(opened_, build_source(opened_, "trace.cl", source, options.warnings_are_errors), "clray_trace");
  check_size(plan);
  has_wide_ = options.defines.at("CLRAY_WIDE") == "1";
  const PassBuffers in(plan, geometry);
#define CLRAY_FILL(type, name) buffers_[#name] = filled(opened_, in.name);
  CLRAY_BUFFERS(CLRAY_FILL)
#undef CLRAY_FILL
  with_cl_errors(opened_.info.name, [&] {
#define CLRAY_BIND(type, name) kernel_.setArg(first_argument_++, buffers_.at(#name));
    CLRAY_BUFFERS(CLRAY_BIND)
#undef CLRAY_BIND
  });
}

void DevicePass::check_size(const PassPlan& plan) const {
  const double bytes = 8.0 * static_cast<double>(plan.layout.values);
  const double limit = with_cl_errors(
      opened_.info.name, [&] { return static_cast<double>(opened_.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>()); });
  if (bytes > limit)
    throw Error(ErrorCode::input,
                fmt::format("the detectors need {:.3g} GiB in one buffer, {} gives at most {:.3g}: fewer bins, pixels, "
                            "orientations or wavelengths are needed",
                            bytes / 1073741824.0, opened_.info.name, limit / 1073741824.0));
}

void DevicePass::clear(const PassPlan& plan) {
  zero_buffer<std::int64_t>(opened_, buffers_.at("sums"), plan.layout.values);
  if (has_wide_) zero_buffer<std::int64_t>(opened_, buffers_.at("wide"), plan.layout.values);
  zero_buffer<std::uint32_t>(opened_, buffers_.at("counts"), plan.layout.counts);
  zero_buffer<std::int64_t>(opened_, buffers_.at("counters"), CLRAY_COUNTERS);
}

void DevicePass::set_epoch(std::uint32_t epoch) {
  if (constants_.epoch == epoch) return;
  constants_.epoch = epoch;
  write_buffer(opened_, buffers_.at("pass"), std::vector<ClrayPass>{constants_});
}

void DevicePass::launch_items(std::uint64_t first, std::uint32_t items, const PointBlock& block, std::uint32_t group) {
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

void DevicePass::drain(const PassPlan& plan, Sums* sums) {
  sums->values.resize(plan.layout.values, 0);
  sums->counts.resize(plan.layout.counts, 0);
  add_to(&sums->values, opened_, buffers_.at("sums"), 1);
  if (has_wide_) add_to(&sums->values, opened_, buffers_.at("wide"), 4294967296);
  merge_counts(plan.layout, read_buffer<std::uint32_t>(opened_, buffers_.at("counts"), plan.layout.counts),
               &sums->counts);
  const auto events = read_buffer<std::int64_t>(opened_, buffers_.at("counters"), CLRAY_COUNTERS);
  for (std::size_t c = 0; c < CLRAY_COUNTERS; ++c) sums->events[c] += static_cast<std::uint64_t>(events[c]);
  clear(plan);
}

}  // namespace clray
