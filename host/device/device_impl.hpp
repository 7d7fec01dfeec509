// SPDX-License-Identifier: Apache-2.0
// What a clray::Device holds: the opened OpenCL devices, each with its context, queue, capabilities and built
// programs. For host/device and host/pipeline.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "clray/device.hpp"
#include "device/opencl.hpp"

namespace clray {

struct Device::Impl {
  /// One OpenCL device, ready for work.
  struct Opened {
    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;                       ///< in order, profiling enabled
    bool int64_atomics = false;                   ///< cl_khr_int64_base_atomics, unless a quirk speaks against it
    bool no_optimiser = false;                    ///< build with -cl-opt-disable
    bool keeps_binaries = false;                  ///< worthwhile on this driver (binary_cache.hpp)
    std::map<std::string, std::string> defines;   ///< capability defines: from extensions and quirks.def
    std::map<std::string, cl::Program> programs;  ///< programs built so far, by build options and source
  };
  std::vector<Opened> devices;  ///< never empty
};

using OpenedDevice = Device::Impl::Opened;

}  // namespace clray
