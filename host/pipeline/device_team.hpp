// SPDX-License-Identifier: Apache-2.0
// The devices of a pass share a block of work-items. One that fails is left out from then on, which is said in one
// sentence: the others do again what it had not handed over. Sums are integers, so nobody can tell who did what.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "clray/device.hpp"
#include "device/device_impl.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/work_source.hpp"

namespace clray {

/// Device passes that stay when their team goes, for the next one of the same body.
using KeptPass = std::vector<std::shared_ptr<DevicePass>>;

/// Leaves a device out of all passes from now on, and says so in a note; `error` says what failed.
void leave_out(Device::Impl* impl, OpenedDevice* opened, const Error& error);

/// Calls `make` (of an OpenedDevice) for every device that is still in use and returns what it makes. A device where it
/// throws is left out; the last one's error is thrown.
template <class Make>
auto on_each_device(Device::Impl* impl, const Make& make) {
  std::vector<decltype(make(impl->devices.front()))> made;
  std::exception_ptr failure;
  for (OpenedDevice& opened : impl->devices) {
    if (opened.left_out) continue;
    try {
      made.push_back(make(opened));
    } catch (const Error& error) {
      failure = std::current_exception();
      if (impl->devices.size() > 1) leave_out(impl, &opened, error);
    }
  }
  if (made.empty() && failure) std::rethrow_exception(failure);
  if (made.empty()) throw Error(ErrorCode::device, "every device has failed", "devices");
  return made;
}

class DeviceTeam {
 public:
  /// Takes what suits the plan from *kept, and leaves there what the next team may take.
  DeviceTeam(Device& device, const PassPlan& plan, const Geometry& geometry, const TraceOptions& options,
             KeptPass* kept);

  void set_work(std::uint32_t epoch, const std::vector<std::uint32_t>& views);
  /// Traces what `work` gives of a block. `keep_going` is asked with the share done; when it says no, returns false.
  bool run(WorkSource& work, const PointBlock& block, const std::function<bool(double)>& keep_going);
  /// Adds what was traced since the last drain to *sums.
  void drain(Sums* sums);
  /// Forgets it.
  void clear();

 private:
  /// A range of a block's work-items.
  struct Slice {
    WorkRange range;
    PointBlock block;
  };
  struct Member {
    OpenedDevice* opened;
    std::shared_ptr<DevicePass> pass;
    std::vector<Slice> undrained;  // that its sums hold, and the one at work
  };
  /// What the members of a team do together.
  struct Task;

  bool run(Task* task);
  void work(Member* member, Task* task);
  void trace(Member* member, const Slice& slice);
  /// Leaves out a member that failed; its slices are for others. False where there is nobody else, or it is no failure
  /// of a device.
  bool others_take_over(Member* member, const Error& error);
  /// Calls `act` of every member; those where it fails are lost.
  template <class Act>
  void each(const Act& act);
  std::size_t alive() const;

  Device::Impl& impl_;
  const PassPlan& plan_;
  const TraceOptions& options_;
  std::vector<Member> members_;
  std::vector<Slice> orphans_;  // slices of lost members
  std::mutex mutex_;            // of orphans and members, while threads work
};

}  // namespace clray
