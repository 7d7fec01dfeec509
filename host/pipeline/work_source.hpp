// SPDX-License-Identifier: Apache-2.0
// Hands out a block's work-items in ranges, to whichever device asks next. Sums are integers: it does not matter who
// takes which range.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>

namespace clray {

/// Work-items first … first + count - 1.
struct WorkRange {
  std::uint64_t first = 0, count = 0;
};

/// Safe to ask from several threads.
class WorkSource {
 public:
  explicit WorkSource(std::uint64_t items) : items_(items) {}

  /// The next `most` items, or what is left of them; none when all are taken.
  std::optional<WorkRange> take(std::uint64_t most) {
    const std::uint64_t first = next_.fetch_add(most);
    if (first >= items_) return std::nullopt;
    return WorkRange{first, std::min(most, items_ - first)};
  }
  std::uint64_t items() const { return items_; }

 private:
  const std::uint64_t items_;
  std::atomic<std::uint64_t> next_{0};
};

}  // namespace clray
