// SPDX-License-Identifier: Apache-2.0
// The buffers of a pass, in the order of the kernel's arguments. One row makes the argument, the member of Buffers
// (stage/state.cl) and the host's binding (host/pipeline/pass_runner.cpp). X(type, name)
#ifndef CLRAY_BUFFERS_H
#define CLRAY_BUFFERS_H

// What a pass reads: constants, where rays start, which views a launch is asked for, what rays are connected to, the
// body (its tree, what leaves hold, faces), its surfaces, the Sobol numbers (bits reversed), the detectors with their
// sums and settings, the strata of the views' beams, and bits of the primitives whose first bounce is not solved in
// each view (docs/exact.md). Then what it adds to: sums at the first and the second scale, counts, and the counters of
// events of each view.
#define CLRAY_BUFFERS(X)                             \
  X(const CLRAY_GLOBAL ClrayPass, pass)              \
  X(const CLRAY_GLOBAL ClrayView, views)             \
  X(const CLRAY_GLOBAL u32, asked)                   \
  X(const CLRAY_GLOBAL ClrayConnection, connections) \
  X(const CLRAY_GLOBAL ClrayNode, nodes)             \
  X(const CLRAY_GLOBAL u32, leaves)                  \
  X(const CLRAY_GLOBAL ClrayPrimitive, primitives)   \
  X(const CLRAY_GLOBAL f64, shapes)                  \
  X(const CLRAY_GLOBAL ClrayInstance, instances)     \
  X(const CLRAY_GLOBAL ClrayMaterial, materials)     \
  X(const CLRAY_GLOBAL f64, tables)                  \
  X(const CLRAY_GLOBAL u32, directions)              \
  X(const CLRAY_GLOBAL ClrayDetector, detectors)     \
  X(const CLRAY_GLOBAL ClrayBlock, blocks)           \
  X(const CLRAY_GLOBAL f64, settings)                \
  X(const CLRAY_GLOBAL ClrayStratum, strata)         \
  X(const CLRAY_GLOBAL u32, unsolved)                \
  X(volatile CLRAY_GLOBAL i64, sums)                 \
  X(volatile CLRAY_GLOBAL i64, wide)                 \
  X(volatile CLRAY_GLOBAL u32, counts)               \
  X(volatile CLRAY_GLOBAL i64, counters)

#endif
