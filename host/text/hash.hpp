// SPDX-License-Identifier: Apache-2.0
// The one hash of clray: 64-bit FNV-1a (Fowler, Noll & Vo). Digests of results and names of remembered self-tests use
// it.
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

}  // namespace clray
