// SPDX-License-Identifier: Apache-2.0
// The detector's gate over one pulse: what is expected, in the form that shared/photon.h inverts, and the sampling of
// shots on the host's cores. Times in ns after the gate opens.
#pragma once

#include <cstdint>
#include <vector>

#include "slr/pulse.hpp"

namespace clray::slr {

/// Edges of a gate as pairs (time, signal photons up to it at brightness 1), as in shared/photon.h.
struct Gate {
  double opens_s = 0.0;  ///< as a delay relative to the reference point: minus half the gate
  std::vector<double> table;

  std::uint32_t edges() const { return static_cast<std::uint32_t>(table.size() / 2); }
  double signal() const { return table.empty() ? 0.0 : table.back(); }
};

/// The gate, centred on delay zero, over a histogram of signal photons; bins are cut at the gate's ends.
Gate make_gate(const Histogram& photons, double gate_s);

/// Photons expected up to a time within the gate.
double expected_until(const Gate& gate, double time_ns, double brightness, double noise_per_ns);

/// What is the same for all shots of a session.
struct ShotSettings {
  double noise_per_ns = 0.0;  ///< background and dark counts
  double jitter_ns = 0.0;     ///< standard deviation
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one per core
};

/// Results of consecutive shots.
struct Shots {
  std::vector<double> time_ns;      ///< after the gate opens; 0 where there is none
  std::vector<std::uint32_t> kind;  ///< CLRAY_PHOTON_*
};

/// Samples `count` shots from number `first` on. `brightness`: one per shot, or a single one for all.
void sample_shots(const Gate& gate, const std::vector<double>& brightness, const ShotSettings& settings,
                  std::uint64_t first, std::uint32_t count, Shots* shots);

}  // namespace clray::slr
