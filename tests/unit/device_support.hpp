// SPDX-License-Identifier: Apache-2.0
// What tests of devices share: the CPU device opened, and kernels with a planted fault.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "device/embedded.hpp"
#include "device/platforms.hpp"
#include "device/program.hpp"

namespace clray::test {

inline OpenedDevice opened_cpu() {
  return open_device(choose_devices(find_devices(), "cpu").front());
}

/// The kernel files, where the first `text` in file `path` reads `fault`.
inline KernelFiles files_with_fault(const std::string& path, const std::string& text, const std::string& fault) {
  KernelFiles files = embedded_kernels();
  std::string& file = files.at(path);
  const std::size_t at = file.find(text);
  REQUIRE(at != std::string::npos);
  file.replace(at, text.size(), fault);
  return files;
}

}  // namespace clray::test
