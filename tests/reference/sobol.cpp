// SPDX-License-Identifier: Apache-2.0
// See sobol.hpp.
#include "sobol.hpp"

#include <cstring>

namespace clray_reference {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 2> key, std::array<std::uint32_t, 4> x) {
  for (int round = 0; round < 10; ++round) {
    if (round > 0) key = {key[0] + 0x9E3779B9u, key[1] + 0xBB67AE85u};
    const std::uint64_t left = 0xD2511F53ull * x[0], right = 0xCD9E8D57ull * x[2];
    const auto high = [](std::uint64_t p) { return static_cast<std::uint32_t>(p >> 32); };
    const auto low = [](std::uint64_t p) { return static_cast<std::uint32_t>(p); };
    x = {high(right) ^ x[1] ^ key[0], low(right), high(left) ^ x[3] ^ key[1], low(left)};
  }
  return x;
}

std::uint32_t sobol_bits(std::uint32_t index, int dimension) {
  // Direction numbers m_k of the polynomial x + 1 with m_1 = 1 obey m_k = 2 m_{k-1} ^ m_{k-1}: Pascal's triangle
  // modulo 2. As fractions: v_k = v_{k-1} ^ (v_{k-1} >> 1).
  std::uint32_t v = 0x80000000u, bits = 0;
  for (; index != 0; index >>= 1) {
    if (index & 1u) bits ^= v;
    v = dimension == 0 ? v >> 1 : v ^ (v >> 1);
  }
  return bits;
}

std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed) {
  const auto mirrored = [](std::uint32_t bits) {
    std::uint32_t out = 0;
    for (int k = 0; k < 32; ++k) out |= ((bits >> k) & 1u) << (31 - k);
    return out;
  };
  std::uint32_t h = mirrored(fraction);
  h ^= h * 0x3d20adeau;
  h = (h + seed) * ((seed >> 16) | 1u);
  h ^= h * 0x05526c56u;
  h ^= h * 0x53a22864u;
  return mirrored(h);
}

std::uint64_t view_key(const std::vector<std::array<double, 3>>& directions) {
  std::uint64_t key = 14695981039346656037ull;
  for (const auto& direction : directions) {
    for (double number : direction) {
      if (number == 0.0) number = 0.0;  // negative zero counts as zero
      std::uint64_t bits = 0;
      std::memcpy(&bits, &number, sizeof bits);
      for (int byte = 0; byte < 8; ++byte) key = (key ^ (bits >> 8 * byte & 0xff)) * 1099511628211ull;
    }
  }
  return key;
}

std::array<double, 2> beam_point(const Sampling& sampling, std::uint32_t replicate, std::uint32_t index) {
  const std::array<std::uint32_t, 2> key = {static_cast<std::uint32_t>(sampling.seed),
                                            static_cast<std::uint32_t>(sampling.seed >> 32)};
  // Dimension d takes word (d + 2) mod 4 of group (d + 2)/4: both beam dimensions are in group 0.
  const std::uint32_t draw = sampling.sobol ? 0xffffffffu : index;
  const auto words = philox(key, {replicate, sampling.epoch << 24, draw, 0});
  std::array<double, 2> point{};
  for (int d = 0; d < 2; ++d) {
    const std::uint32_t word = words[static_cast<std::size_t>(d) + 2];
    const std::uint32_t bits = sampling.sobol ? owen_scramble(sobol_bits(index, d), word) : word;
    point[static_cast<std::size_t>(d)] = (static_cast<double>(bits) + 0.5) / 4294967296.0;
  }
  return point;
}

std::vector<std::array<double, 2>> beam_points(const Sampling& sampling, std::uint32_t replicates, std::uint64_t rays) {
  std::vector<std::array<double, 2>> points;
  points.reserve(rays);
  for (std::uint32_t r = 0; r < replicates; ++r)
    for (std::uint32_t i = 0; i < rays / replicates; ++i) points.push_back(beam_point(sampling, r, i));
  return points;
}

}  // namespace clray_reference
