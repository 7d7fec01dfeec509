// SPDX-License-Identifier: Apache-2.0
// Which OpenCL devices there are, and choosing one or several to trace on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clray/export.hpp"

namespace CLRAY_API clray {

/// One OpenCL device as `clray --list devices` shows it.
struct DeviceInfo {
  int index = 0;
  std::string name, platform, vendor, driver, version;
  std::string type;  ///< "cpu", "gpu", "accelerator", "cpu+gpu" (a simulator claims both), …
  unsigned compute_units = 0;
  double memory_GiB = 0.0;
  bool fp64 = false;
  bool int64_atomics = false;
};

/// All devices of all platforms that have any, in a fixed order. Empty if there are none. Any thread may call it.
std::vector<DeviceInfo> list_devices();

/// Where compiled kernels are kept: POCL_CACHE_DIR, or PoCL's default. PoCL computes nothing if it cannot write there.
std::string kernel_cache_folder();

/// Whether it can be written; it is made if it is missing.
bool kernel_cache_writable();

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
  explicit Device(const std::string& choice = {});
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  /// What was opened, the first of several. Throws Error(usage) for a Device that was moved from.
  const DeviceInfo& info() const;

  struct Impl;
  Impl& impl();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace clray
