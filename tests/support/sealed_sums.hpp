// SPDX-License-Identifier: Apache-2.0
// Files of sums around any content, for tests that change what is believed once the checksum is right.
#pragma once

#include <string>

#include "pipeline/saved_sums.hpp"
#include "text/bytes.hpp"
#include "text/hash.hpp"

namespace clray_test {

constexpr std::size_t kSumsHead = clray::kSavedMagic.size() + 8;  ///< bytes before the sums: magic and version
constexpr std::size_t kSumsSeal = 8;                              ///< bytes behind them: the checksum

/// What stands between head and seal of a file that has both.
inline std::string between_seals(const std::string& file) {
  return file.substr(kSumsHead, file.size() - kSumsHead - kSumsSeal);
}

/// A file of this content, with a right version and checksum.
inline std::string sealed(const std::string& sums) {
  clray::text::BytesWriter out;
  out.raw(clray::kSavedMagic);
  out.number(2);
  out.raw(sums);
  out.number(clray::checksum(sums.data(), sums.size()));
  return out.take();
}

}  // namespace clray_test
