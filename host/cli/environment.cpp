// SPDX-License-Identifier: Apache-2.0
// PoCL's variables; see environment.hpp.
#include "environment.hpp"

#include <stdlib.h>

namespace clray::cli {

Environment::Environment() {
  ::setenv("POCL_SIGFPE_HANDLER", "0", 1);
  ::setenv("POCL_CACHE_DIR", kernels_.path().c_str(), 1);
}

}  // namespace clray::cli
