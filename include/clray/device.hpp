// SPDX-License-Identifier: Apache-2.0
// Which OpenCL devices there are, and choosing one or several to trace on.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace clray {

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

/// All devices of all platforms that have any, in a fixed order. Empty if there are none.
std::vector<DeviceInfo> list_devices();

/// A device (or, for "all", several) opened for tracing, self-test passed.
class Device {
 public:
  /// `choice`: "cpu", "gpu", "all", an index, part of a name, or "" for a GPU if there is one, else the CPU.
  /// Throws Error(device) when there is none such, it lacks fp64, or it fails the self-test.
  explicit Device(const std::string& choice = {});
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  /// What was opened, the first of several.
  const DeviceInfo& info() const;

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace clray
