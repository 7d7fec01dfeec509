// SPDX-License-Identifier: Apache-2.0
// Shots of a laser-ranging session, one work-item each; see shared/photon.h. Units ns and photons per ns.
#include "shared/photon.h"

/// `gate`: edges pairs (time, signal). `brightness`: one per shot, or the same for all where `brightnesses` is 1.
/// Results per shot: `time` after the gate opens, `kind` CLRAY_PHOTON_*.
__kernel void slr_shots(const __global f64* gate, u32 edges, const __global f64* brightness, u32 brightnesses,
                        f64 noise_per_ns, f64 jitter_ns, u32 key0, u32 key1, u64 first_shot, u32 shots,
                        __global f64* time, __global u32* kind) {
  const u32 id = (u32)get_global_id(0);
  if (id >= shots) {
    return;
  }
  f64 t;
  kind[id] = photon_shot(gate, edges, brightness[brightnesses == 1u ? 0u : id], noise_per_ns, 0.0, jitter_ns, key0,
                         key1, first_shot + (u64)id, &t);
  time[id] = t;
}
