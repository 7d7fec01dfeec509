// SPDX-License-Identifier: Apache-2.0
// The devices of an exact pass share the batches of a group of views. One that fails is left out from then on, which is
// said in one sentence, and the group is solved again by the others: what it brought is taken when it is whole. Sums
// are integers, so nobody can tell who did what.
#pragma once

#include <memory>
#include <vector>

#include "clray/device.hpp"
#include "device/device_impl.hpp"
#include "pipeline/exact_device.hpp"
#include "pipeline/plan.hpp"

namespace clray {

class ExactTeam {
 public:
  /// What a group brought.
  struct Found {
    std::vector<i64> sums;  ///< of its faces
    std::vector<ClrayPiece> lit;
  };

  /// One program and its buffers on every device. `bins`: numbers of all histograms.
  ExactTeam(Device& device, const PassPlan& plan, std::uint64_t bins);

  /// Solves a group whose batches `launch_all` gives to launch(); it returns false where the pass must stop, and is
  /// called again where a device is lost. `rows`: the parts of the histograms that the group adds to.
  template <class LaunchAll>
  bool solve(const FaceGroup& group, const std::vector<BinRow>& rows, const LaunchAll& launch_all, Found* found) {
    for (;;) {
      try {
        begin(group, rows);
        const bool go = launch_all();
        end(group, rows, found);
        return go;
      } catch (const Lost&) {
        continue;
      }
    }
  }
  /// Gives a batch to the next device.
  void launch(ItemBatch* batch);

  /// Sets the histograms to zero.
  void clear_bins() { bins_.assign(bins_.size(), 0); }
  /// What all groups have brought to the histograms since then.
  const std::vector<i64>& bins() const { return bins_; }

 private:
  struct Member {
    OpenedDevice* opened;
    std::unique_ptr<ExactDevice> device;
  };
  /// Thrown where a device was left out and others go on.
  struct Lost {};

  void begin(const FaceGroup& group, const std::vector<BinRow>& rows);
  void end(const FaceGroup& group, const std::vector<BinRow>& rows, Found* found);
  /// Does something with a member; one where that fails is left out.
  template <class Act>
  void with(std::size_t member, const Act& act);

  Device::Impl& impl_;
  std::vector<Member> members_;
  std::vector<i64> bins_;
  std::size_t next_ = 0;
};

}  // namespace clray
