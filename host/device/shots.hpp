// SPDX-License-Identifier: Apache-2.0
// Shots of a laser-ranging session on an opened device (kernels/slr/shots.cl), without OpenCL types, so that host/slr
// can ask for them.
#pragma once

#include <cstdint>
#include <vector>

#include "clray/device.hpp"

namespace clray {

/// Arguments of the kernel; see shared/photon.h. Times in ns after the gate opens, rates per ns.
struct DeviceShots {
  const std::vector<double>& gate;        ///< pairs (time, signal)
  const std::vector<double>& brightness;  ///< one per shot, or a single one
  double noise_per_ns = 0.0, jitter_ns = 0.0;
  std::uint64_t seed = 1, first = 0;
  std::uint32_t count = 0;
};

/// Samples them on the first of the opened devices: the same bits as on the host. Throws Error(device).
void sample_shots_on(Device& device, const DeviceShots& request, std::vector<double>* time_ns,
                     std::vector<std::uint32_t>* kind);

}  // namespace clray
