// SPDX-License-Identifier: Apache-2.0
// The OpenCL platforms of this machine: enumeration, choice of a device, opening.
#pragma once

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

/// "cpu", "gpu", "accelerator", "custom" joined by "+", from OpenCL's bit mask.
std::string device_type_name(cl_device_type type);

/// Makes context and queue, and works out the capabilities. No self-test.
OpenedDevice open_device(const FoundDevice& found);

}  // namespace clray
