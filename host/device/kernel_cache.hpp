// SPDX-License-Identifier: Apache-2.0
// The folder where the driver keeps compiled kernels (see clray/device.hpp), and what clray remembers beside them.
#pragma once

#include <string>

#include "device/device_impl.hpp"

namespace clray {

/// Whether `what` (a self-test's name and program, say) was remembered for that device and driver.
bool remembered(const OpenedDevice& opened, const std::string& what);
/// Remembers it. If it cannot be written it is forgotten, which is no error.
void remember(const OpenedDevice& opened, const std::string& what);

/// What to tell about a folder of compiled kernels that cannot be written.
std::string unwritable_cache();

}  // namespace clray
