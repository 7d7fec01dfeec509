// SPDX-License-Identifier: Apache-2.0
// The environment of the process, which belongs to the program and never to the library: PoCL reads its settings
// there at its first call.
#pragma once

#include <memory>
#include <string>

#include "text/temporaries.hpp"

namespace clray::cli {

/// Sets PoCL's variables for as long as it lives; made before the first thread and the first OpenCL call.
/// PoCL's handler would turn a host division by zero into 0. If the folder of compiled kernels cannot be written, every
/// build would fail, so a temporary folder replaces it.
class Environment {
 public:
  Environment();
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::string temporary_kernels_;
  std::unique_ptr<text::Temporary> noted_;
};

}  // namespace clray::cli
