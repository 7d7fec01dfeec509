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

constexpr std::size_t kGroup = 64;     // work-items
constexpr std::size_t kLitOfItem = 4;  // pieces that there is room for, on average: the host does the rest

/// Work-groups of items in an order that spreads neighbours, which are of one tile and so of like cost: drivers give
/// each core a run of work-groups. No result depends on it.
void spread(ItemBatch* batch) {
  const std::size_t groups = batch->size() / kGroup;
  if (groups < 3) return;
  std::size_t stride = static_cast<std::size_t>(0.618 * static_cast<double>(groups)) | 1u;
  while (std::gcd(stride, groups) != 1) ++stride;
  const auto spread_out = [&](auto& of, std::size_t each) {
    auto out = of;
    const std::size_t width = kGroup * each;
    for (std::size_t k = 0, g = 0; k < groups; ++k, g = (g + stride) % groups)
      std::copy_n(of.begin() + static_cast<std::ptrdiff_t>(g * width), width,
                  out.begin() + static_cast<std::ptrdiff_t>(k * width));
    of = std::move(out);
  };
  spread_out(batch->items, 2);
  if (!batch->pieces.empty()) spread_out(batch->pieces, 1);
}

}  // namespace

void ItemBatch::clear() {
  tiles.clear();
  lists.clear();
  items.clear();
  pieces.clear();
}

ExactDevice::ExactDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers,
                         std::uint64_t bins)
    : opened_(device), numbers_(numbers), bin_count_(bins) {
  kernel_ = make_kernel(opened_, build_program(opened_, "exact.cl", options), "clray_exact");
  opened_.test_once("solved\n" + program_name("exact.cl", options), [&] {
    run_exact_self_test(opened_, program_source(opened_, "exact.cl", options), kernel_, numbers_);
  });
  bins_ = make_buffer<i64>(opened_, bins);
}

ExactDevice::ExactDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers,
                         std::uint64_t bins)
    : opened_(device), numbers_(numbers), bin_count_(bins), kernel_(kernel) {
  check_sums_size(opened_, bins);
  bins_ = make_buffer<i64>(opened_, bins);
}

void ExactDevice::begin_group(const FaceGroup& group, const std::vector<BinRow>& rows) {
  group_ = &group;
  rows_ = rows;
  batch_.clear();
  host_sums_.clear();
  found_lit_.clear();
  check_buffer_size(opened_, static_cast<double>(sizeof(ClrayFace)) * static_cast<double>(group.faces.size()),
                    "the faces of a view", "faces");
  faces_ = make_buffer(opened_, group.faces);
  weights_ = make_buffer(opened_, group.weights);
  binning_ = make_buffer(opened_, group.binnings);
  sums_ = make_zero_buffer<i64>(opened_, group.faces.size() * CLRAY_FACE_SUMS);
  for (const BinRow& row : rows_) {
    zero_buffer<i64>(opened_, bins_, row.count, row.first);
    if (!host_bins_.empty()) std::fill_n(host_bins_.begin() + static_cast<std::ptrdiff_t>(row.first), row.count, 0);
  }
}

void ExactDevice::launch_batch(ItemBatch* batch) {
  finish_batch();
  std::swap(batch_, *batch);
  batch->clear();
  if (batch_.size() == 0) return;
  spread(&batch_);
  const std::size_t room = numbers_.carry && !group_->seen ? kLitOfItem * batch_.size() : 0;
  tiles_ = make_buffer(opened_, batch_.tiles);
  lists_ = make_buffer(opened_, batch_.lists);
  items_ = make_buffer(opened_, batch_.items);
  pieces_ = make_buffer(opened_, batch_.pieces);
  unfinished_ = make_zero_buffer<std::uint32_t>(opened_, 1 + 2 * batch_.size());
  lit_ = make_buffer<ClrayPiece>(opened_, room);
  lit_count_ = make_buffer(opened_, std::vector<std::uint32_t>{0, static_cast<std::uint32_t>(room)}, CL_MEM_READ_WRITE);
  set_arguments(opened_, kernel_, faces_, weights_, tiles_, lists_, items_, binning_, pieces_, sums_, bins_,
                unfinished_, lit_, lit_count_, cl_uint{group_->seen ? 1u : 0u}, static_cast<cl_uint>(batch_.size()));
  launch(opened_, kernel_, batch_.size(), kGroup);
  with_cl_errors(opened_.info.name, [&] { opened_.queue.flush(); });
}

void ExactDevice::finish_batch() {
  if (batch_.size() == 0) return;
  const std::uint32_t count = read_buffer<std::uint32_t>(opened_, unfinished_, 1).front();
  finish_on_host(read_buffer<std::uint32_t>(opened_, unfinished_, 2 * static_cast<std::size_t>(count), 1));
  if (numbers_.carry && !group_->seen) {
    const auto lit = read_buffer<std::uint32_t>(opened_, lit_count_, 2);
    const auto pieces = read_buffer<ClrayPiece>(opened_, lit_, std::min(lit[0], lit[1]));
    found_lit_.insert(found_lit_.end(), pieces.begin(), pieces.end());
  }
  batch_.clear();
}

void ExactDevice::finish_on_host(const std::vector<std::uint32_t>& unfinished) {
  if (unfinished.empty()) return;
  host_sums_.resize(group_->faces.size() * CLRAY_FACE_SUMS);
  host_bins_.resize(bin_count_);
  ExactBuffers host;
  host.faces = group_->faces.data();
  host.weights = group_->weights.data();
  host.tiles = batch_.tiles.data();
  host.lists = batch_.lists.data();
  host.items = batch_.items.data();
  host.binnings = group_->binnings.data();
  host.pieces = batch_.pieces.data();
  host.sums = host_sums_.data();
  host.bins = host_bins_.data();
  for (std::size_t k = 0; k < unfinished.size(); k += 2)
    exact_item_on_host(host, numbers_, group_->seen, unfinished[k], unfinished[k + 1], &found_lit_);
}

void ExactDevice::end_group(std::vector<i64>* sums, std::vector<ClrayPiece>* lit, std::vector<std::vector<i64>>* bins) {
  finish_batch();
  const auto found = read_buffer<i64>(opened_, sums_, group_->faces.size() * CLRAY_FACE_SUMS);
  for (std::size_t k = 0; k < found.size(); ++k) (*sums)[k] += found[k];
  for (std::size_t k = 0; k < host_sums_.size(); ++k) (*sums)[k] += host_sums_[k];
  lit->insert(lit->end(), found_lit_.begin(), found_lit_.end());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const auto row = read_buffer<i64>(opened_, bins_, rows_[r].count, rows_[r].first);
    for (std::size_t k = 0; k < row.size(); ++k)
      (*bins)[r][k] += row[k] + (host_bins_.empty() ? 0 : host_bins_[rows_[r].first + k]);
  }
  group_ = nullptr;
}

}  // namespace clray
