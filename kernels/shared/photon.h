// SPDX-License-Identifier: Apache-2.0
// The first photon of a shot: inverse of the expected count of a non-homogeneous Poisson process (Wilkman, "Ray-tracer
// for modeling interactions of light with space objects", eqs. 5-7), piecewise linear over the edges of a gate.
// Compiles as OpenCL C and as C++ and gives the same bits in both. Times in ns after the gate opens, rates per ns.
//
// `gate` holds pairs (time, signal) for each edge: the signal photons expected from the gate's opening up to that
// time at brightness 1. The first pair is (0, 0), times increase strictly, signal never decreases.
#ifndef CLRAY_PHOTON_H
#define CLRAY_PHOTON_H

#include "shared/elementary.h"
#include "shared/philox.h"

// What a shot recorded; the numbers are those of the filter flag of a CRD range record.
#define CLRAY_PHOTON_NONE 0u
#define CLRAY_PHOTON_NOISE 1u
#define CLRAY_PHOTON_SIGNAL 2u
// Third word of the counter: keeps these numbers apart from those of the tracer under the same seed.
#define CLRAY_PHOTON_STREAM 0x736c7200u

/// Uniform in [0,1), a multiple of 2^-53.
CLRAY_FN f64 photon_uniform(u32 high, u32 low) { return (f64)((((u64)high << 32) | (u64)low) >> 11) * 0x1p-53; }

/// Photons expected from the gate's opening to an edge; never decreases from edge to edge, also when rounded.
CLRAY_FN f64 photon_expected(const CLRAY_GLOBAL f64* gate, u32 edge, f64 brightness, f64 noise_per_ns) {
  return fma(brightness, gate[2u * edge + 1u], noise_per_ns * gate[2u * edge]);
}

/// The last edge at which not more than `level` photons are expected. `level` must be below the whole gate's count:
/// then the next edge has more, and stretches without light are stepped over.
CLRAY_FN u32 photon_bin(const CLRAY_GLOBAL f64* gate, u32 edges, f64 brightness, f64 noise_per_ns, f64 level) {
  u32 low = 0u;
  u32 count = edges - 1u;
  while (count > 1u) {
    const u32 half_count = count >> 1;
    low = photon_expected(gate, low + half_count, brightness, noise_per_ns) <= level ? low + half_count : low;
    count -= half_count;
  }
  return low;
}

/// The time at which `level` photons are expected, given its bin.
CLRAY_FN f64 photon_time(const CLRAY_GLOBAL f64* gate, u32 bin, f64 brightness, f64 noise_per_ns, f64 level) {
  const f64 before = photon_expected(gate, bin, brightness, noise_per_ns);
  const f64 after = photon_expected(gate, bin + 1u, brightness, noise_per_ns);
  const f64 start = gate[2u * bin];
  return fma((level - before) / (after - before), gate[2u * bin + 2u] - start, start);
}

/// Standard normal number, independent of the shot's other random numbers (Box & Muller 1958).
CLRAY_FN f64 photon_normal(u32 key0, u32 key1, u64 shot) {
  const u32 counter[4] = {(u32)shot, (u32)(shot >> 32), CLRAY_PHOTON_STREAM, 1u};
  u32 random[4];
  f64 s, c;
  philox4x32(key0, key1, counter, random);
  el_sincos(2.0 * CLRAY_PI * photon_uniform(random[3], random[2]), &s, &c);
  return sqrt(-2.0 * el_log1p(-photon_uniform(random[1], random[0]))) * c;
}

/// One shot: CLRAY_PHOTON_* and, unless NONE, the recorded time. It is a function of key and shot alone.
/// `blind`: photons expected while the detector still recovers (0 when it is ready as the gate opens).
/// `jitter_ns`: standard deviation of the timing, which may carry a photon across the gate's ends.
CLRAY_FN u32 photon_shot(const CLRAY_GLOBAL f64* gate, u32 edges, f64 brightness, f64 noise_per_ns, f64 blind,
                         f64 jitter_ns, u32 key0, u32 key1, u64 shot, f64* time_ns) {
  const u32 counter[4] = {(u32)shot, (u32)(shot >> 32), CLRAY_PHOTON_STREAM, 0u};
  u32 random[4];
  philox4x32(key0, key1, counter, random);
  const f64 level = blind - el_log1p(-photon_uniform(random[1], random[0]));
  *time_ns = 0.0;
  if (!(level < photon_expected(gate, edges - 1u, brightness, noise_per_ns))) {
    return CLRAY_PHOTON_NONE;
  }
  const u32 bin = photon_bin(gate, edges, brightness, noise_per_ns, level);
  f64 time = photon_time(gate, bin, brightness, noise_per_ns, level);
  if (jitter_ns > 0.0) {
    time = fma(jitter_ns, photon_normal(key0, key1, shot), time);
  }
  *time_ns = time;
  const f64 signal = brightness * (gate[2u * bin + 3u] - gate[2u * bin + 1u]);
  const f64 noise = noise_per_ns * (gate[2u * bin + 2u] - gate[2u * bin]);
  const f64 draw = photon_uniform(random[3], random[2]);
  return signal * (1.0 - draw) > noise * draw ? CLRAY_PHOTON_SIGNAL : CLRAY_PHOTON_NOISE;
}

#endif
