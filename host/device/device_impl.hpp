// SPDX-License-Identifier: Apache-2.0
// What a clray::Device holds: the opened OpenCL devices, each with its context, queue, capabilities and built
// programs. For host/device and host/pipeline.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "clray/device.hpp"
#include "device/opencl.hpp"

namespace clray {

/// Set by the thread that uses a device; any other may ask.
class Flag {
 public:
  Flag() = default;
  Flag(const Flag& other) : set_(other.set_.load()) {}
  Flag& operator=(bool set) {
    set_ = set;
    return *this;
  }
  operator bool() const { return set_; }

 private:
  std::atomic<bool> set_{false};
};

struct Device::Impl {
  /// One OpenCL device, ready for work.
  struct Opened {
    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;                       ///< in order, profiling enabled
    bool int64_atomics = false;                   ///< cl_khr_int64_base_atomics, unless a quirk speaks against it
    bool shares_memory = false;                   ///< works in the host's memory: nothing needs to be there twice
    bool no_optimiser = false;                    ///< build with -cl-opt-disable
    std::uint64_t most_items = 1u << 26;          ///< work-items of a launch
    std::map<std::string, std::string> defines;   ///< capability defines: from extensions and quirks.def
    std::map<std::string, cl::Program> programs;  ///< programs built so far, by build options and source
    std::map<std::string, cl::Program> by_name;   ///< the same by program_name(), found without making a source
    bool has_cache = false;                       ///< the driver keeps programs itself
    Flag left_out;                                ///< it has failed, and others do its share
    std::set<std::string> passed;                 ///< self-tests that passed in this process

    bool is_cpu() const { return info.type.find("cpu") != std::string::npos; }
    /// Runs a self-test that throws where it fails, unless it passed under this name before.
    template <class Test>
    void test_once(const std::string& name, Test&& test) {
      if (passed.count(name) != 0) return;
      test();
      passed.insert(name);
    }
  };
  std::vector<Opened> devices;                        ///< never empty
  std::vector<std::string> notes;                     ///< devices that were left out, each a sentence
  std::mutex busy;                                    ///< held by a DeviceUse
  std::atomic<std::thread::id> user;                  ///< the thread of that DeviceUse; none: thread::id()
  std::map<std::string, int> runs_without_optimiser;  ///< of this process, by program_name()
  std::uint64_t memory_bytes = 0;                     ///< that a run may take, see Device::limit_memory(); 0: any
  double slab_bytes = 128e6;                          ///< of the sums of views that a device holds at once, about
};

using OpenedDevice = Device::Impl::Opened;

/// Holds a device for one call of the public API. Other threads wait for it, since queue, programs and kernels serve
/// one call at a time. A call that comes from within another (by a callback) would wait for itself: it throws
/// Error(usage).
class DeviceUse {
 public:
  explicit DeviceUse(Device& device);
  ~DeviceUse();
  DeviceUse(const DeviceUse&) = delete;
  DeviceUse& operator=(const DeviceUse&) = delete;

 private:
  Device::Impl& impl_;
};

}  // namespace clray
