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
  virtual ~WorkSource() = default;

  /// At most `most` items; none when all are taken.
  virtual std::optional<WorkRange> take(std::uint64_t most) = 0;
  std::uint64_t items() const { return items_; }

 private:
  const std::uint64_t items_;
};

/// The items of this process, one range behind the other.
class OwnWork : public WorkSource {
 public:
  /// Items `first` … `end` - 1.
  explicit OwnWork(std::uint64_t end, std::uint64_t first = 0) : WorkSource(end), next_(first) {}

  std::optional<WorkRange> take(std::uint64_t most) override {
    const std::uint64_t first = next_.fetch_add(most);
    if (first >= items()) return std::nullopt;
    return WorkRange{first, std::min(most, items() - first)};
  }

 private:
  std::atomic<std::uint64_t> next_;
};

}  // namespace clray
