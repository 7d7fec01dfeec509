// SPDX-License-Identifier: Apache-2.0
// The self-test that traces: a device that traces wrongly, for whatever reason, is refused instead of giving wrong
// numbers.
#pragma once

#include "device/program.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// Traces a small built-in scene (built_in_scene.hpp) with the program of `plan`, and compares every sum with that of
/// the host's kernels (host_pass.hpp). Their own answers to a few such scenes are known. It runs once per device,
/// driver and program; what passed is remembered beside the kernel cache, with a checksum. Throws Error(device) that
/// says "refused: …". `files` differ from the embedded ones in tests alone; they are never remembered.
void run_traced_self_test(OpenedDevice& opened, const PassPlan& plan, bool specialised,
                          const KernelFiles& files = embedded_kernels());

/// Throws Error(device) where the host's kernels do not give their known answers.
void check_host_kernels();

}  // namespace clray
