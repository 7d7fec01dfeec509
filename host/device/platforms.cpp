// SPDX-License-Identifier: Apache-2.0
// The OpenCL platforms of this machine: enumeration, choice of a device, opening.
#include "device/platforms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <functional>
#include <mutex>
#include <set>

#include "device/kernel_cache.hpp"
#include "device/self_test.hpp"

namespace clray {
namespace {

constexpr cl_device_type kCpuAndGpu = CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool contains(const std::string& text, const std::string& part) {
  return lower(text).find(lower(part)) != std::string::npos;
}

bool has_extension(const cl::Device& device, const std::string& name) {
  const std::string all = " " + device.getInfo<CL_DEVICE_EXTENSIONS>() + " ";
  return all.find(" " + name + " ") != std::string::npos;
}

std::string without_nul(std::string text) {
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  return text;
}

FoundDevice describe(const std::string& platform, const cl::Device& device) {
  FoundDevice found;
  found.device = device;
  found.type = device.getInfo<CL_DEVICE_TYPE>();
  DeviceInfo& info = found.info;
  info.name = without_nul(device.getInfo<CL_DEVICE_NAME>());
  info.platform = platform;
  info.vendor = without_nul(device.getInfo<CL_DEVICE_VENDOR>());
  info.driver = without_nul(device.getInfo<CL_DRIVER_VERSION>());
  info.version = without_nul(device.getInfo<CL_DEVICE_VERSION>());
  info.type = device_type_name(found.type);
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.memory_GiB = static_cast<double>(device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>()) / 1073741824.0;
  info.fp64 = has_extension(device, "cl_khr_fp64") && (device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() & CL_FP_FMA) != 0;
  info.int64_atomics = has_extension(device, "cl_khr_int64_base_atomics");
  return found;
}

std::string names_of(const std::vector<FoundDevice>& devices) {
  std::string text;
  for (const auto& found : devices) {
    text += fmt::format("{}{} {} ({}, {})", text.empty() ? "" : "; ", found.info.index, found.info.name,
                        found.info.type, found.info.platform);
  }
  return text;
}

Error none_such(const std::vector<FoundDevice>& devices, const std::string& what) {
  return Error(ErrorCode::device, fmt::format("there is no {}; there is: {}", what, names_of(devices)));
}

std::vector<FoundDevice> select(const std::vector<FoundDevice>& devices,
                                const std::function<bool(const FoundDevice&)>& fits) {
  std::vector<FoundDevice> chosen;
  std::copy_if(devices.begin(), devices.end(), std::back_inserter(chosen), fits);
  return chosen;
}

/// What quirks.def says of a device.
std::set<std::string> quirks_of(const DeviceInfo& info) {
  struct Quirk {
    const char *platform, *device, *define;
  };
  static const Quirk quirks[] = {
#define QUIRK(platform, device, define, why) {platform, device, #define},
#include "device/quirks.def"
#undef QUIRK
  };
  std::set<std::string> defines;
  for (const Quirk& quirk : quirks) {
    if (contains(info.platform, quirk.platform) && contains(info.name, quirk.device)) defines.insert(quirk.define);
  }
  return defines;
}

/// Devices of that type. A device of this type alone comes before one that claims to be CPU and GPU at once; among
/// equals, one with fp64 first; among equals, those that quirks.def prefers.
std::vector<FoundDevice> of_type(const std::vector<FoundDevice>& devices, cl_device_type type, bool also_both) {
  auto chosen = select(devices, [&](const FoundDevice& found) {
    return (found.type & type) != 0 && (also_both || (found.type & kCpuAndGpu) != kCpuAndGpu);
  });
  std::stable_sort(chosen.begin(), chosen.end(), [](const FoundDevice& a, const FoundDevice& b) {
    const auto rank = [](const FoundDevice& x) {
      const bool preferred = quirks_of(x.info).count("CLRAY_HOST_PREFERRED") > 0;
      return ((x.type & kCpuAndGpu) == kCpuAndGpu ? 4 : 0) + (x.info.fp64 ? 0 : 2) + (preferred ? 0 : 1);
    };
    return rank(a) < rank(b);
  });
  return chosen;
}

FoundDevice by_default(const std::vector<FoundDevice>& devices) {
  for (const cl_device_type type : {CL_DEVICE_TYPE_GPU, CL_DEVICE_TYPE_CPU}) {
    const auto chosen = of_type(devices, type, false);
    if (!chosen.empty() && chosen.front().info.fp64) return chosen.front();
  }
  throw Error(ErrorCode::device,
              "no GPU or CPU device with double precision (fp64); choose one by name or index: " + names_of(devices));
}

std::vector<FoundDevice> by_name(const std::vector<FoundDevice>& devices, const std::string& choice) {
  const auto exact = select(devices, [&](const FoundDevice& found) { return found.info.name == choice; });
  if (!exact.empty()) return {exact.front()};
  const auto fitting = select(devices, [&](const FoundDevice& found) {
    return contains(found.info.name, choice) || contains(found.info.platform, choice);
  });
  if (fitting.empty()) throw none_such(devices, fmt::format("device called '{}'", choice));
  for (const auto& found : fitting) {
    if (found.info.name != fitting.front().info.name) {
      throw Error(ErrorCode::device,
                  fmt::format("'{}' fits several devices; choose one: {}", choice, names_of(fitting)));
    }
  }
  return {fitting.front()};
}

}  // namespace

std::string device_type_name(cl_device_type type) {
  std::string text;
  const auto add = [&](cl_device_type bit, const char* name) {
    if (type & bit) text += (text.empty() ? "" : "+") + std::string(name);
  };
  add(CL_DEVICE_TYPE_CPU, "cpu");
  add(CL_DEVICE_TYPE_GPU, "gpu");
  add(CL_DEVICE_TYPE_ACCELERATOR, "accelerator");
  add(CL_DEVICE_TYPE_CUSTOM, "custom");
  return text.empty() ? "unknown" : text;
}

std::vector<FoundDevice> find_devices() {
  // A driver sets itself up at its first call. PoCL 3.1 tells all but one of the threads that call it meanwhile that
  // it has no device, and may crash.
  static std::mutex first_call;
  const std::lock_guard<std::mutex> lock(first_call);
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& error) {
    constexpr cl_int kNoPlatform = -1001;
    if (error.err() != kNoPlatform) throw cl_error(error, "OpenCL");
  }
  std::vector<FoundDevice> all;
  for (const auto& platform : platforms) {
    std::vector<cl::Device> devices;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      const std::string name = without_nul(platform.getInfo<CL_PLATFORM_NAME>());
      for (const auto& device : devices) all.push_back(describe(name, device));
    } catch (const cl::Error&) {
      continue;  // it has no devices, or its driver does not answer: it is skipped
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const FoundDevice& a, const FoundDevice& b) { return a.info.platform < b.info.platform; });
  for (std::size_t i = 0; i < all.size(); ++i) all[i].info.index = static_cast<int>(i);
  return all;
}

std::vector<FoundDevice> choose_devices(const std::vector<FoundDevice>& devices, const std::string& choice) {
  if (devices.empty()) {
    if (!kernel_cache_writable()) throw Error(ErrorCode::device, "no OpenCL device found; " + unwritable_cache());
    throw Error(ErrorCode::device,
                "no OpenCL device found; for the CPU install the packages ocl-icd-libopencl1 and pocl-opencl-icd (in "
                "Python, pip install 'clray[pocl]'), for a GPU its vendor's OpenCL driver");
  }
  std::vector<FoundDevice> chosen;
  if (choice.empty()) {
    chosen = {by_default(devices)};
  } else if (choice == "cpu" || choice == "gpu") {
    chosen = of_type(devices, choice == "cpu" ? CL_DEVICE_TYPE_CPU : CL_DEVICE_TYPE_GPU, true);
    if (chosen.empty()) throw none_such(devices, choice == "cpu" ? "CPU device" : "GPU device");
    chosen.resize(1);
  } else if (choice == "all") {
    chosen = select(devices, [](const FoundDevice& found) {
      return found.info.fp64 && (found.type & kCpuAndGpu) != 0 && (found.type & kCpuAndGpu) != kCpuAndGpu;
    });
    if (chosen.empty()) chosen = {by_default(devices)};
  } else if (choice.size() < 6 &&
             std::all_of(choice.begin(), choice.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    const auto index = static_cast<std::size_t>(std::stoul(choice));
    if (index >= devices.size()) throw none_such(devices, "device " + choice);
    chosen = {devices[index]};
  } else {
    chosen = by_name(devices, choice);
  }
  for (const auto& found : chosen) {
    if (!found.info.fp64) {
      throw Error(ErrorCode::device, "the device lacks double precision (fp64), which clray needs", found.info.name);
    }
  }
  return chosen;
}

std::vector<FoundDevice> deal_devices(const std::vector<FoundDevice>& devices, const std::string& choice,
                                      NodePlace place) {
  std::vector<FoundDevice> chosen = choose_devices(devices, choice);
  if (place.of <= 1) return chosen;
  if (choice == "gpu" || (choice.empty() && (chosen.front().type & CL_DEVICE_TYPE_GPU) != 0)) {
    const auto all = select(of_type(devices, CL_DEVICE_TYPE_GPU, false), [](const auto& d) { return d.info.fp64; });
    if (!all.empty()) chosen = all;
  } else if (choice != "all") {
    return chosen;
  }
  if (place.of >= chosen.size()) return {chosen[place.number % chosen.size()]};
  std::vector<FoundDevice> dealt;
  for (std::size_t k = place.number; k < chosen.size(); k += place.of) dealt.push_back(chosen[k]);
  return dealt;
}

OpenedDevice open_device(const FoundDevice& found) {
  return with_cl_errors(found.info.name, [&] {
    OpenedDevice opened;
    opened.info = found.info;
    opened.device = found.device;
    opened.context = cl::Context(found.device);
    opened.queue = cl::CommandQueue(opened.context, found.device, CL_QUEUE_PROFILING_ENABLE);
    opened.shares_memory = found.type == CL_DEVICE_TYPE_CPU && found.device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>();
    for (const std::string& define : quirks_of(found.info)) opened.defines[define] = "1";
    opened.defines.erase("CLRAY_HOST_PREFERRED");
    opened.no_optimiser = opened.defines.erase("CLRAY_HOST_NO_OPTIMISER") > 0;
    opened.has_cache = opened.defines.erase("CLRAY_HOST_HAS_CACHE") > 0;
    // Rounding up to work-groups of at most 1024 leaves it below 65535.
    if (opened.defines.erase("CLRAY_HOST_SMALL_LAUNCHES") > 0) opened.most_items = 60 * 1024;
    if (!found.info.int64_atomics) opened.defines["CLRAY_NO_INT64_ATOMICS"] = "1";
    opened.int64_atomics = opened.defines.count("CLRAY_NO_INT64_ATOMICS") == 0;
    return opened;
  });
}

std::vector<OpenedDevice> open_devices(const std::vector<FoundDevice>& devices, const std::string& choice,
                                       NodePlace place, const std::function<OpenedDevice(const FoundDevice&)>& open,
                                       std::vector<std::string>* notes) {
  std::vector<FoundDevice> chosen = deal_devices(devices, choice, place);
  const std::size_t asked = chosen.size();
  if (choice.empty()) {
    for (const FoundDevice& cpu : of_type(devices, CL_DEVICE_TYPE_CPU, false)) {
      if (cpu.info.fp64 && cpu.info.index != chosen.front().info.index) chosen.push_back(cpu);
    }
  }
  std::vector<OpenedDevice> opened;
  std::exception_ptr first;
  for (const FoundDevice& found : chosen) {
    if (choice.empty() && !opened.empty()) break;
    try {
      opened.push_back(open(found));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::device || (asked == 1 && !choice.empty())) throw;
      if (!first) first = std::current_exception();
      notes->push_back(fmt::format("{} is left out: {}", found.info.name, error.message()));
    }
  }
  if (opened.empty()) std::rethrow_exception(first);
  if (choice.empty() && !notes->empty())
    notes->back() += fmt::format("; {} ({}) is taken", opened.front().info.name, opened.front().info.type);
  return opened;
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> list;
  for (const auto& found : find_devices()) list.push_back(found.info);
  return list;
}

Device::Device(const std::string& choice, NodePlace place) : impl_(std::make_unique<Impl>()) {
  const auto open = [](const FoundDevice& found) {
    OpenedDevice opened = open_device(found);
    run_self_test(opened);
    return opened;
  };
  impl_->devices = open_devices(find_devices(), choice, place, open, &impl_->notes);
}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const DeviceInfo& Device::info() const {
  const std::vector<OpenedDevice>& devices = const_cast<Device*>(this)->impl().devices;
  const auto used = std::find_if(devices.begin(), devices.end(), [](const OpenedDevice& d) { return !d.left_out; });
  return used != devices.end() ? used->info : devices.front().info;
}

void Device::limit_memory(std::uint64_t bytes) {
  impl().memory_bytes = bytes;
}

Device::Impl& Device::impl() {
  if (!impl_) throw Error(ErrorCode::usage, "this Device was moved from");
  return *impl_;
}

DeviceUse::DeviceUse(Device& device) : impl_(device.impl()) {
  // Only this thread can put its own id there, so the answer cannot change meanwhile.
  if (impl_.user == std::this_thread::get_id()) {
    throw Error(ErrorCode::usage, "the device is busy with the call that this one comes from", device.info().name);
  }
  impl_.busy.lock();
  impl_.user = std::this_thread::get_id();
}

DeviceUse::~DeviceUse() {
  impl_.user = std::thread::id();
  impl_.busy.unlock();
}

}  // namespace clray
