// SPDX-License-Identifier: Apache-2.0
// Mesh formats that are not read, and what to do with a file of one.
#pragma once

#include <string>

namespace clray {

/// The extension of a path in small letters, with its dot.
std::string extension_of(const std::string& path);

/// For the path of a file in a known format that is not read: what it is and how to convert it; else "".
std::string foreign_format(const std::string& path);

}  // namespace clray
