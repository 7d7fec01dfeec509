// SPDX-License-Identifier: Apache-2.0
// The start-up self-test: a small kernel with known answers, so that a device that computes otherwise is refused
// instead of giving wrong numbers.
#pragma once

#include "device/program.hpp"

namespace clray {

/// Runs kernels/device/self_test.cl: unfused and fused multiply-add, subnormals, division, square root, rounding to
/// integers, 64-bit sums, Philox, exp and log; once per device and driver: what passed is remembered beside the kernel
/// cache. Throws Error(device) that names what was wrong ("refused: ..."). `files` differ from the embedded ones in
/// tests alone.
void run_self_test(OpenedDevice& opened, const KernelFiles& files = embedded_kernels());

}  // namespace clray
