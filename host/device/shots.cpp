// SPDX-License-Identifier: Apache-2.0
// Shots on a device; see shots.hpp.
#include "device/shots.hpp"

#include "device/buffers.hpp"
#include "device/program.hpp"

namespace clray {

void sample_shots_on(Device& device, const DeviceShots& request, std::vector<double>* time_ns,
                     std::vector<std::uint32_t>* kind) {
  const DeviceUse use(device);
  OpenedDevice& opened = device.impl().devices.front();
  const cl::Program program = build_program(opened, "slr/shots.cl", {});
  cl::Kernel kernel = make_kernel(opened, program, "slr_shots");
  const cl::Buffer gate = make_buffer(opened, request.gate), brightness = make_buffer(opened, request.brightness);
  const cl::Buffer times = make_buffer<double>(opened, request.count);
  const cl::Buffer kinds = make_buffer<std::uint32_t>(opened, request.count);
  set_arguments(opened, kernel, gate, static_cast<cl_uint>(request.gate.size() / 2), brightness,
                static_cast<cl_uint>(request.brightness.size()), request.noise_per_ns, request.jitter_ns,
                static_cast<cl_uint>(request.seed), static_cast<cl_uint>(request.seed >> 32),
                static_cast<cl_ulong>(request.first), static_cast<cl_uint>(request.count), times, kinds);
  launch(opened, kernel, request.count, 64);
  *time_ns = read_buffer<double>(opened, times, request.count);
  *kind = read_buffer<std::uint32_t>(opened, kinds, request.count);
}

}  // namespace clray
