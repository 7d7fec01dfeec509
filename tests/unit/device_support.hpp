// SPDX-License-Identifier: Apache-2.0
// What tests of devices share: the CPU device opened, and kernels with a planted fault.
#pragma once

#include "checks/planted.hpp"
#include "device/platforms.hpp"

namespace clray::test {

inline OpenedDevice opened_cpu() {
  return open_device(choose_devices(find_devices(), "cpu").front());
}

}  // namespace clray::test
