// SPDX-License-Identifier: Apache-2.0
// Gate table and host sampling; see gate.hpp.
#include "slr/gate.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "shared/photon.h"

namespace clray::slr {

namespace {

constexpr std::uint32_t kShotsWorthAThread = 16384;

void sample_range(const Gate& gate, const std::vector<double>& brightness, const ShotSettings& settings,
                  std::uint64_t first, std::uint32_t begin, std::uint32_t end, Shots* shots) {
  const auto key0 = static_cast<std::uint32_t>(settings.seed), key1 = static_cast<std::uint32_t>(settings.seed >> 32);
  const double* table = gate.table.data();
  const std::uint32_t edges = gate.edges();
  const bool same = brightness.size() == 1;
  for (std::uint32_t i = begin; i < end; ++i) {
    shots->kind[i] = photon_shot(table, edges, brightness[same ? 0 : i], settings.noise_per_ns, 0.0, settings.jitter_ns,
                                 key0, key1, first + i, &shots->time_ns[i]);
  }
}

}  // namespace

Gate make_gate(const Histogram& photons, double gate_s) {
  Gate gate;
  gate.opens_s = -0.5 * gate_s;
  const double length_ns = gate_s * 1e9, width_ns = photons.width_s * 1e9;
  const double origin_ns = (photons.first_s - gate.opens_s) * 1e9;
  double sum = 0.0, at = 0.0;
  gate.table = {0.0, 0.0};
  for (std::size_t i = 0; i < photons.mass.size(); ++i) {
    const double begin = origin_ns + static_cast<double>(i) * width_ns;
    const double end = origin_ns + static_cast<double>(i + 1) * width_ns;
    if (end <= 0.0 || begin >= length_ns) continue;
    if (begin > at) {
      gate.table.insert(gate.table.end(), {begin, sum});
      at = begin;
    }
    const double stop = std::min(end, length_ns);
    const bool whole = begin >= 0.0 && end <= length_ns;
    sum += whole ? photons.mass[i] : photons.mass[i] * ((stop - std::max(begin, 0.0)) / width_ns);
    if (stop > at) {
      gate.table.insert(gate.table.end(), {stop, sum});
      at = stop;
    } else {
      gate.table.back() = sum;
    }
  }
  if (at < length_ns) gate.table.insert(gate.table.end(), {length_ns, sum});
  return gate;
}

double expected_until(const Gate& gate, double time_ns, double brightness, double noise_per_ns) {
  const auto edges = gate.edges();
  if (!(time_ns > 0.0)) return 0.0;
  if (time_ns >= gate.table[2 * (edges - 1)])
    return photon_expected(gate.table.data(), edges - 1, brightness, noise_per_ns);
  std::uint32_t low = 0, high = edges - 1;
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    (gate.table[2 * middle] <= time_ns ? low : high) = middle;
  }
  const double before = photon_expected(gate.table.data(), low, brightness, noise_per_ns);
  const double after = photon_expected(gate.table.data(), high, brightness, noise_per_ns);
  const double share = (time_ns - gate.table[2 * low]) / (gate.table[2 * high] - gate.table[2 * low]);
  return std::fma(share, after - before, before);
}

void sample_shots(const Gate& gate, const std::vector<double>& brightness, const ShotSettings& settings,
                  std::uint64_t first, std::uint32_t count, Shots* shots) {
  shots->time_ns.resize(count);
  shots->kind.resize(count);
  const unsigned cores = settings.threads > 0 ? static_cast<unsigned>(settings.threads)
                                              : std::max(1u, std::thread::hardware_concurrency());
  const std::uint32_t parts = std::clamp(count / kShotsWorthAThread, 1u, cores);
  std::vector<std::thread> threads;
  for (std::uint32_t p = 1; p < parts; ++p) {
    const auto begin = static_cast<std::uint32_t>(std::uint64_t{count} * p / parts);
    const auto end = static_cast<std::uint32_t>(std::uint64_t{count} * (p + 1) / parts);
    threads.emplace_back([&, begin, end] { sample_range(gate, brightness, settings, first, begin, end, shots); });
  }
  sample_range(gate, brightness, settings, first, 0, count / parts, shots);
  for (auto& thread : threads) thread.join();
}

}  // namespace clray::slr
