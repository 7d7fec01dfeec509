// SPDX-License-Identifier: Apache-2.0
// The environment of the process, which belongs to the program and never to the library: PoCL reads its settings
// there at its first call.
#pragma once

#include "kernel_folder.hpp"

namespace clray::cli {

/// Sets PoCL's variables; made before the first thread and the first OpenCL call. PoCL's handler would turn a host
/// division by zero into 0. The ranks of a node share its cores.
class Environment {
 public:
  Environment();

  KernelFolder& kernels() { return kernels_; }

 private:
  KernelFolder kernels_;
};

}  // namespace clray::cli
