// SPDX-License-Identifier: Apache-2.0
// PoCL's variables; see environment.hpp.
#include "environment.hpp"

#include <stdlib.h>

#include <filesystem>

#include "clray/device.hpp"

namespace clray::cli {

namespace fs = std::filesystem;

Environment::Environment() {
  ::setenv("POCL_SIGFPE_HANDLER", "0", 1);
  if (kernel_cache_writable()) return;
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "clray-kernels-XXXXXX").string();
  if (error || !::mkdtemp(name.data())) return;  // PoCL alone needs the folder, and will say that a build failed
  temporary_kernels_ = name;
  noted_ = std::make_unique<text::Temporary>(name);
  ::setenv("POCL_CACHE_DIR", name.c_str(), 1);
}

Environment::~Environment() {
  std::error_code ignored;
  if (!temporary_kernels_.empty()) fs::remove_all(temporary_kernels_, ignored);
}

}  // namespace clray::cli
