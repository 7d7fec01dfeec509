// SPDX-License-Identifier: Apache-2.0
// The self-test of the kernel of exact passes: faces that cross, share edges and lie in one place, solved on the device
// and by the same text on the host. Every sum must be equal.
#pragma once

#include "device/device_impl.hpp"
#include "device/program.hpp"
#include "exact/portable_faces.hpp"

namespace clray {

/// Tests a program of exact.cl, unless it passed on this device before. Throws Error(device) with the first sum that is
/// wrong.
void run_exact_self_test(OpenedDevice& opened, const std::string& source, const cl::Kernel& kernel,
                         const ExactNumbers& numbers);

/// The same of its sampling.
void run_sample_self_test(OpenedDevice& opened, const std::string& source, const cl::Kernel& kernel,
                          const ExactNumbers& numbers);

}  // namespace clray
