// SPDX-License-Identifier: Apache-2.0
// The kernel of exact passes on a device against the same text on the host, with stacks so small that the host must
// finish most items.
#include <doctest/doctest.h>

#include <string>

#include "clray/device.hpp"
#include "device/buffers.hpp"
#include "pipeline/exact_self_test.hpp"

using namespace clray;

TEST_CASE("exact passes: what a full stack leaves is finished by the host, to the last bit") {
  Device device("cpu");
  OpenedDevice& opened = device.impl().devices.front();
  const ExactNumbers numbers{2, 2, true, true};
  for (const char* room : {"2", "5", "24"}) {
    CAPTURE(room);
    ProgramOptions options;
    options.defines = {{"CLRAY_LANES", "2"},
                       {"CLRAY_BINNINGS", "2"},
                       {"CLRAY_EXACT_STACK", room},
                       {"CLRAY_FROM_SOURCE", "1"},
                       {"CLRAY_CARRY", "1"}};
    const std::string source = program_source(opened, "exact.cl", options);
    const cl::Kernel kernel = make_kernel(opened, build_source(opened, "exact.cl", source, true), "clray_exact");
    // The name is new to the memory of what passed, so the test runs.
    const std::string name = std::string("test of ") + room + std::to_string(reinterpret_cast<std::uintptr_t>(&opened));
    CHECK_NOTHROW(run_exact_self_test(opened, name, kernel, numbers));
  }
}
