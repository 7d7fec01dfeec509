// SPDX-License-Identifier: Apache-2.0
// The folder where the driver keeps compiled kernels (see clray/device.hpp), and what clray keeps beside them: built
// programs, and which self-tests passed.
#pragma once

#include <optional>
#include <string>

#include "device/device_impl.hpp"

namespace clray {

/// Whether `what` (a self-test's name and program, say) was remembered for that device and driver.
bool remembered(const OpenedDevice& opened, const std::string& what);
/// Remembers it. If it cannot be written it is forgotten, which is no error.
void remember(const OpenedDevice& opened, const std::string& what);

/// The program of that text, as built by build_flags(), that was kept for that device and driver; none if there is
/// none, or it is damaged.
std::optional<std::string> kept_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source);
/// Keeps it. If it cannot be written there is none, which is no error.
void keep_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source,
                 const std::string& binary);

/// What to tell about a folder of compiled kernels that cannot be written.
std::string unwritable_cache();

}  // namespace clray
