// SPDX-License-Identifier: Apache-2.0
// The kernel sources, embedded at build time: path below kernels/ -> text.
#pragma once

#include <map>
#include <string>

namespace clray {

const std::map<std::string, std::string>& embedded_kernels();

}  // namespace clray
