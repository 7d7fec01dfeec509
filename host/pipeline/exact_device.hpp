// SPDX-License-Identifier: Apache-2.0
// The kernel of exact passes on one device: faces of a group of views stay there while batches of items are launched,
// and their sums are read back. What a device leaves unfinished, the host does.
#pragma once

#include <cstdint>
#include <vector>

#include "device/device_impl.hpp"
#include "device/program.hpp"
#include "exact/portable_faces.hpp"

namespace clray {

/// Faces of some views, with the weights of their lanes.
struct FaceGroup {
  std::vector<ClrayFace> faces;
  std::vector<double> weights;
};

/// Tiles of such a group, and items: pairs of a tile and a face.
struct ItemBatch {
  std::vector<ClrayTile> tiles;
  std::vector<ClrayListed> lists;
  std::vector<std::uint32_t> items;

  std::size_t size() const { return items.size() / 2; }
  void clear();
};

class ExactDevice {
 public:
  /// Builds the program, or takes what was built before, and tests it once per device. `bins`: numbers of all
  /// histograms. Throws Error(device).
  ExactDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers,
              const std::vector<ClrayBinning>& binnings, std::uint64_t bins);

  /// The same with a kernel that was built before, which is not tested.
  ExactDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers,
              const std::vector<ClrayBinning>& binnings, std::uint64_t bins);

  /// The faces that the next batches are of. `group` must stay until end_group().
  void begin_group(const FaceGroup& group);
  /// Launches a batch; waits for the one before. Takes what `batch` holds and leaves it empty.
  void launch_batch(ItemBatch* batch);
  /// Waits for the last batch and adds the sums of the group's faces to *sums.
  void end_group(std::vector<i64>* sums);
  /// Adds all bins to *bins.
  void read_bins(std::vector<i64>* bins);

 private:
  void finish_batch();

  OpenedDevice& opened_;
  ExactNumbers numbers_;
  const std::vector<ClrayBinning>& binnings_;
  std::uint64_t bin_count_;
  cl::Kernel kernel_;
  cl::Buffer faces_, weights_, binning_, sums_, bins_, tiles_, lists_, items_, unfinished_;
  const FaceGroup* group_ = nullptr;
  ItemBatch batch_;  // that runs
  std::vector<i64> host_sums_, host_bins_;
};

}  // namespace clray
