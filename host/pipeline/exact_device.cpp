// SPDX-License-Identifier: Apache-2.0
// See exact_device.hpp.
#include "pipeline/exact_device.hpp"

#include <numeric>
#include <string>

#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "pipeline/exact_self_test.hpp"

namespace clray {
namespace {

constexpr std::size_t kGroup = 64;  // work-items

/// The kernel, built and tested.
cl::Kernel tested_kernel(OpenedDevice& opened, const ProgramOptions& options, const ExactNumbers& numbers) {
  const std::string source = program_source(opened, "exact.cl", options);
  cl::Kernel kernel =
      make_kernel(opened, build_source(opened, "exact.cl", source, options.warnings_are_errors), "clray_exact");
  run_exact_self_test(opened, source, kernel, numbers);
  return kernel;
}

/// Work-groups of items in an order that spreads neighbours, which are of one tile and so of like cost: drivers give
/// each core a run of work-groups. No result depends on it.
std::vector<std::uint32_t> spread(const std::vector<std::uint32_t>& items) {
  const std::size_t width = 2 * kGroup, groups = items.size() / width;
  if (groups < 3) return items;
  std::size_t stride = static_cast<std::size_t>(0.618 * static_cast<double>(groups)) | 1u;
  while (std::gcd(stride, groups) != 1) ++stride;
  std::vector<std::uint32_t> out;
  out.reserve(items.size());
  for (std::size_t k = 0, g = 0; k < groups; ++k, g = (g + stride) % groups)
    out.insert(out.end(), items.begin() + static_cast<std::ptrdiff_t>(g * width),
               items.begin() + static_cast<std::ptrdiff_t>((g + 1) * width));
  out.insert(out.end(), items.begin() + static_cast<std::ptrdiff_t>(groups * width), items.end());
  return out;
}

}  // namespace

void ItemBatch::clear() {
  tiles.clear();
  lists.clear();
  items.clear();
}

ExactDevice::ExactDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers,
                         const std::vector<ClrayBinning>& binnings, std::uint64_t bins)
    : ExactDevice(device, tested_kernel(device, options, numbers), numbers, binnings, bins) {}

ExactDevice::ExactDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers,
                         const std::vector<ClrayBinning>& binnings, std::uint64_t bins)
    : opened_(device), numbers_(numbers), binnings_(binnings), bin_count_(bins), kernel_(kernel) {
  check_sums_size(opened_, bins);
  binning_ = make_buffer(opened_, binnings);
  bins_ = make_zero_buffer<i64>(opened_, bins);
}

void ExactDevice::begin_group(const FaceGroup& group) {
  group_ = &group;
  check_buffer_size(opened_, static_cast<double>(sizeof(ClrayFace)) * static_cast<double>(group.faces.size()),
                    "the faces of a view", "faces");
  faces_ = make_buffer(opened_, group.faces);
  weights_ = make_buffer(opened_, group.weights);
  sums_ = make_zero_buffer<i64>(opened_, group.faces.size() * CLRAY_FACE_SUMS);
}

void ExactDevice::launch_batch(ItemBatch* batch) {
  finish_batch();
  std::swap(batch_, *batch);
  batch->clear();
  if (batch_.size() == 0) return;
  batch_.items = spread(batch_.items);
  tiles_ = make_buffer(opened_, batch_.tiles);
  lists_ = make_buffer(opened_, batch_.lists);
  items_ = make_buffer(opened_, batch_.items);
  unfinished_ = make_zero_buffer<std::uint32_t>(opened_, 1 + 2 * batch_.size());
  set_arguments(opened_, kernel_, faces_, weights_, tiles_, lists_, items_, binning_, sums_, bins_, unfinished_,
                static_cast<cl_uint>(batch_.size()));
  launch(opened_, kernel_, batch_.size(), kGroup);
  with_cl_errors(opened_.info.name, [&] { opened_.queue.flush(); });
}

void ExactDevice::finish_batch() {
  if (batch_.size() == 0) return;
  const std::uint32_t count = read_buffer<std::uint32_t>(opened_, unfinished_, 1).front();
  const auto left = read_buffer<std::uint32_t>(opened_, unfinished_, 2 * static_cast<std::size_t>(count), 1);
  if (count > 0) {
    host_sums_.resize(group_->faces.size() * CLRAY_FACE_SUMS);
    host_bins_.resize(bin_count_);
    ExactBuffers host;
    host.faces = group_->faces.data();
    host.weights = group_->weights.data();
    host.tiles = batch_.tiles.data();
    host.lists = batch_.lists.data();
    host.items = batch_.items.data();
    host.binnings = binnings_.data();
    host.sums = host_sums_.data();
    host.bins = host_bins_.data();
    for (std::size_t k = 0; k < left.size(); k += 2) exact_item_on_host(host, numbers_, left[k], left[k + 1]);
  }
  batch_.clear();
}

void ExactDevice::end_group(std::vector<i64>* sums) {
  finish_batch();
  const auto found = read_buffer<i64>(opened_, sums_, group_->faces.size() * CLRAY_FACE_SUMS);
  for (std::size_t k = 0; k < found.size(); ++k) (*sums)[k] += found[k];
  for (std::size_t k = 0; k < host_sums_.size(); ++k) (*sums)[k] += host_sums_[k];
  host_sums_.clear();
  group_ = nullptr;
}

void ExactDevice::read_bins(std::vector<i64>* bins) {
  const auto found = read_buffer<i64>(opened_, bins_, bin_count_);
  for (std::size_t k = 0; k < found.size(); ++k) (*bins)[k] += found[k];
  for (std::size_t k = 0; k < host_bins_.size(); ++k) (*bins)[k] += host_bins_[k];
}

}  // namespace clray
