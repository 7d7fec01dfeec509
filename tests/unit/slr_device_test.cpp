// SPDX-License-Identifier: Apache-2.0
// The shots' kernel against the host: the same bits, on every device of this machine that computes in fp64.
#include <doctest/doctest.h>

#include <ctime>

#include "clray/device.hpp"
#include "device/shots.hpp"
#include "slr/gate.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

Gate gate_of(double photons) {
  std::vector<double> mass(512, 0.0);
  for (std::size_t i = 100; i < 400; ++i) mass[i] = i % 5 == 0 ? 0.0 : photons / 240.0;
  return make_gate({-25.6e-9, 0.1e-9, mass}, 100e-9);
}

void check_same(Device& device, const Gate& gate, const std::vector<double>& brightness, const ShotSettings& settings,
                std::uint64_t first, std::uint32_t count) {
  Shots host, other;
  sample_shots(gate, brightness, settings, first, count, &host);
  sample_shots_on(device,
                  {gate.table, brightness, settings.noise_per_ns, settings.jitter_ns, settings.seed, first, count},
                  &other.time_ns, &other.kind);
  std::size_t different = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    different += host.kind[i] != other.kind[i] || host.time_ns[i] != other.time_ns[i];
  }
  CHECK(different == 0);
}

}  // namespace

TEST_CASE("device and host sample the same shots, bit for bit") {
  for (const DeviceInfo& info : list_devices()) {
    if (!info.fp64) continue;
    CAPTURE(info.name);
    Device device(std::to_string(info.index));
    const std::uint32_t count = 200001;  // not a multiple of a work-group
    std::vector<double> brightness(count);
    for (std::uint32_t i = 0; i < count; ++i) brightness[i] = 0.5 + 1e-5 * i;
    check_same(device, gate_of(1.0), {1.0}, {0.001, 0.0, 1, 0}, 0, count);
    check_same(device, gate_of(1e6), {1.0}, {0.001, 0.0, 7, 0}, 1ull << 40, count);
    check_same(device, gate_of(0.3), brightness, {0.002, 0.05, 0xfedcba9876543210ull, 0}, 123456789, count);
    check_same(device, gate_of(0.0), {1.0}, {0.0, 0.0, 1, 0}, 0, 1);
    const std::uint32_t many = 1u << 22;
    const Gate gate = gate_of(1.0);
    const std::vector<double> one{1.0};
    Shots shots;
    const std::clock_t begin = std::clock();  // CPU time, which on a CPU device holds the kernel's
    sample_shots_on(device, {gate.table, one, 0.001, 0.0, 1, 0, many}, &shots.time_ns, &shots.kind);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    MESSAGE(info.name << ": " << many / seconds << " shots per second of CPU time, transfers included");
  }
}
