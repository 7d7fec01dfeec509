// SPDX-License-Identifier: Apache-2.0
// What the inner detector `books` found, for those that read it.
#pragma once

#include "detector/books.h"
#include "pipeline/sum_reader.hpp"

namespace clray {

/// A book (CLRAY_BOOK_*) of a view in a record's light per replicate, m²; the pass has paths that scatter.
inline std::vector<double> book(const PassPlan& plan, const SumReader& read, std::size_t v, const LaneRecord& record,
                                int which) {
  const std::uint32_t block = find_detector(plan, "books")->first_block;
  return per_replicate_of(plan, record, [&](std::size_t l, std::uint32_t r) {
    return read.value(block, v, l, 0, r, static_cast<std::uint64_t>(which));
  });
}

}  // namespace clray
