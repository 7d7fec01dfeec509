// SPDX-License-Identifier: Apache-2.0
// The sample points of a run, made again from their definition: Sobol's first two dimensions, scrambled in
// Owen's sense by the hash that kernels/math/sobol.cl documents. No code in common with kernels/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace clray_reference {

/// Philox4x32-10 (Salmon et al. 2011): four words from a key and a counter.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 2> key, std::array<std::uint32_t, 4> counter);

/// Unscrambled 32-bit Sobol coordinate, dimension 0 (van der Corput) or 1 (polynomial x + 1; Joe & Kuo 2008).
std::uint32_t sobol_bits(std::uint32_t index, int dimension);

/// Owen scramble of a 32-bit fraction: Burley's (2020) hash on the reversed bits with Vegdahl's (2021) constants.
/// Bit k of the result depends on bits 0 … k of the fraction alone, counted from the most significant.
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed);

/// The key of a view: FNV-1a (64 bits; Fowler, Noll & Vo) over the bytes of its direction to the source and those to
/// its observers, each as three little-endian doubles.
std::uint64_t view_key(const std::vector<std::array<double, 3>>& directions);

/// How a run draws its beam points: TraceOptions of the same names.
struct Sampling {
  std::uint64_t seed = 1;   ///< exclusive or with the view's key
  std::uint32_t epoch = 0;  ///< 1 for the confirmation of a target
  bool sobol = true;
};

/// Beam point `index` of `replicate`: (bits + ½)·2⁻³² in both coordinates.
std::array<double, 2> beam_point(const Sampling& sampling, std::uint32_t replicate, std::uint32_t index);

/// All points of a run: `rays`/`replicates` of each replicate in turn.
std::vector<std::array<double, 2>> beam_points(const Sampling& sampling, std::uint32_t replicates, std::uint64_t rays);

}  // namespace clray_reference
