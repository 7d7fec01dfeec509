// SPDX-License-Identifier: Apache-2.0
// A pass on one device: its program, its buffers, launches of work-items, and the sums read back. Knows nothing of what
// the sums mean.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "device/program.hpp"
#include "device/zeros.hpp"
#include "pipeline/pass_buffers.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// A block of points of every view, replicate and pixel, how many a work-item takes at most, and the walk (a row of
/// walk.def) that says which it takes.
struct PointBlock {
  std::uint32_t first = 0, count = 0, chunk = 16, walk = 0;
};

class DevicePass {
 public:
  /// Builds the program and copies the plan's numbers. `files` differ from the embedded ones in tests alone. Throws
  /// Error(device).
  DevicePass(OpenedDevice& device, const PassPlan& plan, const Geometry& geometry,
             const KernelFiles& files = embedded_kernels());

  /// Makes it that of another plan of the same body, where it has the same program: only what differs is copied. False
  /// where the program is another; it is then as it was. What was summed must have been drained or cleared.
  bool refill(const PassPlan& plan, const Geometry& geometry);

  /// What the next launches trace: points of an epoch's scrambles, of these views (ascending). The device has room for
  /// the sums of no others, so what was summed for others must have been drained or cleared.
  void set_work(std::uint32_t epoch, const std::vector<std::uint32_t>& views);
  /// Runs work-items first … first + items - 1 of a block; returns when they are done. Throws Error(input) where the
  /// sums of the views do not fit into a buffer of the device, Error(device).
  void launch_items(std::uint64_t first, std::uint32_t items, const PointBlock& block, std::uint32_t group);
  /// Adds everything that was summed for the views of set_work() to *sums, and clears it.
  void drain(Sums* sums);
  /// Sets everything that is summed for these views to zero.
  void clear();

  std::uint64_t slice_items = 1;  ///< of the next launch
  std::uint64_t most_items() const { return opened_.most_items; }

 private:
  struct Kept {
    Zeros numbers;  // without pages where they are no zeros
    std::size_t count = 0;
    bool of_the_host = false;  // its memory: never written to
  };
  void fill(const PassPlan& plan, const Geometry& geometry);
  template <class T>
  void fill(const char* name, const Numbers<T>& numbers, bool of_the_body);
  bool has_room() const { return room_first_ <= asked_.front() && asked_.back() < room_end_; }
  void make_room();
  template <class T>
  void make_room(const char* name, std::uint64_t count);
  void bind();

  OpenedDevice& opened_;
  cl::Kernel kernel_;
  ProgramOptions options_;
  std::map<std::string, Kept> buffers_;  // by the names of shared/buffers.h
  ClrayPass constants_;
  SumLayout layout_;
  std::vector<std::uint32_t> asked_;  // views that launches trace
  // The views whose sums the buffers hold, and for each block what is added to a number's place among the sums of all
  // views to have that in the buffer (modulo 2^64).
  std::size_t room_first_ = 0, room_end_ = 0;
  std::vector<std::uint64_t> shifts_;
  bool has_wide_ = false;
  cl_uint first_argument_ = 0;  // behind the buffers
};

}  // namespace clray
