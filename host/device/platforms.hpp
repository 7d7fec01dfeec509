// SPDX-License-Identifier: Apache-2.0
// The OpenCL platforms of this machine: enumeration, choice of a device, opening.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "device/device_impl.hpp"

namespace clray {

/// A device with its OpenCL type bits, as it was found.
struct FoundDevice {
  DeviceInfo info;
  cl::Device device;
  cl_device_type type = 0;
};

/// All devices of all platforms, by platform name and then in the platform's own order.
std::vector<FoundDevice> find_devices();

/// The members of `devices` that `choice` (see Device) means. Throws Error(device) when there is none, when a part
/// of a name fits different devices, or when what was chosen lacks fp64.
std::vector<FoundDevice> choose_devices(const std::vector<FoundDevice>& devices, const std::string& choice);

/// Those of them that a process at a place takes, see Device.
std::vector<FoundDevice> deal_devices(const std::vector<FoundDevice>& devices, const std::string& choice,
                                      NodePlace place);

/// "cpu", "gpu", "accelerator", "custom" joined by "+", from OpenCL's bit mask.
std::string device_type_name(cl_device_type type);

/// Makes context and queue, and works out the capabilities. No self-test.
OpenedDevice open_device(const FoundDevice& found);

/// Opens and tests the devices that `choice` means; `open` throws Error(device) for one that does not work. Of "all"
/// those that fail are left out. A default device that fails gives way to the CPU, one that was asked for does not.
/// *notes gets a sentence for each that was left out. Throws the error where none is left.
std::vector<OpenedDevice> open_devices(const std::vector<FoundDevice>& devices, const std::string& choice,
                                       NodePlace place, const std::function<OpenedDevice(const FoundDevice&)>& open,
                                       std::vector<std::string>* notes);

}  // namespace clray
