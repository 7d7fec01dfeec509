// SPDX-License-Identifier: Apache-2.0
// How deep the keys of a TOML text are, seen before it is parsed: each part of a dotted key is a table in a table, and
// tables of a million levels end the program when they are taken down.
#pragma once

#include <cstddef>
#include <string_view>

namespace clray {

constexpr std::size_t kMostKeyParts = 16;

struct TextPlace {
  std::size_t line = 0, column = 0;  // from 1; 0: none
};

/// Where a key of more than kMostKeyParts parts begins to have too many, or a place of zeros.
TextPlace deep_key(std::string_view toml);

}  // namespace clray
