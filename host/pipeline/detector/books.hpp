// SPDX-License-Identifier: Apache-2.0
// What the inner detector `books` found, for those that read it.
#pragma once

#include "detector/books.h"
#include "pipeline/sum_reader.hpp"

namespace clray {

/// A book (CLRAY_BOOK_*) of a view and lane per replicate, m²; the pass has paths that scatter.
inline std::vector<double> book(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, int which) {
  const std::uint32_t block = find_detector(plan, "books")->first_block;
  return per_replicate(
      plan, [&](std::uint32_t r) { return read.value(block, v, l, 0, r, static_cast<std::uint64_t>(which)); });
}

}  // namespace clray
