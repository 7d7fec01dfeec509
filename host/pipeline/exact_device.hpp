// SPDX-License-Identifier: Apache-2.0
// The kernel of exact passes on one device: faces of a group of views stay there while batches of items are launched;
// their sums, and the lit pieces that observers elsewhere look for, are read back. What a device leaves unfinished, the
// host does.
#pragma once

#include <cstdint>
#include <vector>

#include "device/device_impl.hpp"
#include "device/program.hpp"
#include "exact/portable_faces.hpp"

namespace clray {

/// Faces of some views, as they are seen from the source or by an observer elsewhere.
struct FaceGroup {
  std::vector<ClrayFace> faces;
  std::vector<double> weights;         ///< of their lanes
  std::vector<ClrayBinning> binnings;  ///< the windows of the delay detectors
  bool seen = false;                   ///< lit pieces are looked for, not faces
};

/// Tiles of such a group, and items: pairs of a tile and a face, each with its piece where pieces are looked for.
struct ItemBatch {
  std::vector<ClrayTile> tiles;
  std::vector<ClrayListed> lists;
  std::vector<std::uint32_t> items;
  std::vector<ClrayPiece> pieces;

  std::size_t size() const { return items.size() / 2; }
  void clear();
};

/// A part of the histograms.
struct BinRow {
  std::size_t first, count;
};

class ExactDevice {
 public:
  /// Builds the program, or takes what was built before, and tests it once per device. `bins`: numbers of all
  /// histograms. Throws Error(device).
  ExactDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers, std::uint64_t bins);

  /// The same with a kernel that was built before, which is not tested.
  ExactDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers, std::uint64_t bins);

  /// The faces that the next batches are of, and the parts of the histograms that they add to. `group` must stay until
  /// end_group(). Forgets a group that was not ended.
  void begin_group(const FaceGroup& group, const std::vector<BinRow>& rows);
  /// Launches a batch; waits for the one before. Takes what `batch` holds and leaves it empty.
  void launch_batch(ItemBatch* batch);
  /// Waits for the last batch, adds the sums of the group's faces to *sums and those of each row of bins to
  /// (*bins)[row], and appends its lit pieces to *lit.
  void end_group(std::vector<i64>* sums, std::vector<ClrayPiece>* lit, std::vector<std::vector<i64>>* bins);

 private:
  void finish_batch();
  void finish_on_host(const std::vector<std::uint32_t>& unfinished);

  OpenedDevice& opened_;
  ExactNumbers numbers_;
  std::uint64_t bin_count_;
  cl::Kernel kernel_;
  cl::Buffer faces_, weights_, binning_, sums_, bins_, tiles_, lists_, items_, pieces_, unfinished_, lit_, lit_count_;
  const FaceGroup* group_ = nullptr;
  std::vector<BinRow> rows_;
  ItemBatch batch_;  // that runs
  std::vector<i64> host_sums_, host_bins_;
  std::vector<ClrayPiece> found_lit_;
};

}  // namespace clray
