// SPDX-License-Identifier: Apache-2.0
// Built programs kept as files, beside the driver's own kernel cache. Only for drivers that a quirk marks
// (CLRAY_HOST_KEEPS_BINARIES): PoCL starts its compiler even for a program it knows (70 ms and more on a warm start;
// from a binary 1 ms to 15 ms). Making a binary costs PoCL a further compilation, so only what every run needs is kept.
#pragma once

#include <optional>
#include <string>

#include "device/device_impl.hpp"

namespace clray {

/// The program kept for that device, build flags and source, built; nothing if there is none or it does not load.
std::optional<cl::Program> load_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source);

/// Keeps a built program. Best called after its kernels have run (drivers compile at the first launch). A failure
/// to write is no error: the next run builds again.
void save_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source,
                 const cl::Program& program);

/// Whether `what` (a program's source, say) was remembered for that device and driver: a file beside the kernels, with
/// a checksum.
bool remembered(const OpenedDevice& opened, const std::string& what);
/// Remembers it. A failure to write is no error: it is forgotten.
void remember(const OpenedDevice& opened, const std::string& what);

/// What to tell about a folder of compiled kernels that cannot be written.
std::string unwritable_cache();

}  // namespace clray
