// SPDX-License-Identifier: Apache-2.0
// Which OpenCL devices there are, and choosing one or several to trace on.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clray/export.hpp"

CLRAY_API_BEGIN
namespace clray {

/// One OpenCL device as `clray --list devices` shows it.
struct DeviceInfo {
  int index = 0;               ///< among list_devices()
  std::string name;            ///< as its driver says
  std::string platform;        ///< of the driver
  std::string vendor;          ///< of the device
  std::string driver;          ///< version of the driver
  std::string version;         ///< of OpenCL
  std::string type;            ///< "cpu", "gpu", "accelerator", "cpu+gpu" (a simulator claims both), …
  unsigned compute_units = 0;  ///< cores of a CPU
  double memory_GiB = 0.0;     ///< that the device has
  bool fp64 = false;           ///< has double precision, without which it cannot trace
  bool int64_atomics = false;  ///< adds 64-bit integers atomically
};

/// All devices of all platforms that have any, in a fixed order. Empty if there are none. Any thread may call it.
std::vector<DeviceInfo> list_devices();

/// Where compiled kernels are kept: POCL_CACHE_DIR, or PoCL's default. PoCL computes nothing if it cannot write there.
std::string kernel_cache_folder();

/// Whether it can be written; it is made if it is missing.
bool kernel_cache_writable();

/// The place of a process among those of its machine that share the devices there, each taking some.
struct NodePlace {
  unsigned number = 0;  ///< 0 … of - 1
  unsigned of = 1;      ///< processes
};

/// A device (or, for "all", several) opened for tracing, self-test passed.
///
/// Threads: any number may open devices at once, and each may trace on its own. Calls on one and the same Device wait
/// for each other; a call on it from a callback of another throws Error(usage). To move or destroy it, no call may be
/// under way.
///
/// The library leaves the environment and the signals of its process alone. PoCL does not: unless the environment has
/// POCL_SIGFPE_HANDLER=0 before the first call, it turns integer divisions by zero of the whole process into 0.
class Device {
 public:
  /// `choice`: "cpu", "gpu", "all", an index, part of a name, or "" for a GPU if there is one, else the CPU.
  /// Throws Error(device) when there is none such, it lacks fp64, or it fails the self-test.
  /// Of "all", "gpu" and GPUs by default, each process at a `place` takes its part, so that none is idle; where there
  /// are fewer devices than processes, some serve several.
  explicit Device(const std::string& choice = {}, NodePlace place = {});
  ~Device();
  /// Moves what is opened; the other may then be assigned to or destroyed.
  Device(Device&&) noexcept;
  /// Closes what was opened here and moves.
  Device& operator=(Device&&) noexcept;

  /// What was opened, the first of several. Throws Error(usage) for a Device that was moved from.
  const DeviceInfo& info() const;

  /// Bounds the memory that a run takes, of the device and of the host: each `bytes` or, where the device is a CPU,
  /// both together. It is checked before anything is traced: then trace() throws Error(usage) and says what would help.
  /// 0: as much as there is.
  void limit_memory(std::uint64_t bytes);

  struct Impl;
  Impl& impl();  ///< for the library itself

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace clray
CLRAY_API_END
