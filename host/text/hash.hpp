// SPDX-License-Identifier: Apache-2.0
// The hashes of clray: 64-bit FNV-1a (Fowler, Noll & Vo), which digests of results and names of remembered self-tests
// use, and a quick checksum.
#pragma once

#include <cstddef>
#include <cstdint>

namespace clray {

constexpr std::uint64_t kFnvStart = 14695981039346656037ull;

/// FNV-1a over `count` bytes, continued from `state`.
inline std::uint64_t fnv1a(std::uint64_t state, const void* bytes, std::size_t count) {
  const auto* p = static_cast<const unsigned char*>(bytes);
  for (std::size_t k = 0; k < count; ++k) state = (state ^ p[k]) * 1099511628211ull;
  return state;
}

/// A checksum of many bytes, eight at a time: for files of our own, where FNV-1a would take seconds.
inline std::uint64_t checksum(const void* bytes, std::size_t count, std::uint64_t state = kFnvStart) {
  const auto* p = static_cast<const unsigned char*>(bytes);
  for (; count >= 8; p += 8, count -= 8) {
    std::uint64_t word = 0;
    for (int k = 7; k >= 0; --k) word = word << 8 | p[k];
    state = (state ^ word) * 0x9e3779b97f4a7c15ull;
    state ^= state >> 29;
  }
  return fnv1a(state, p, count);
}

}  // namespace clray
