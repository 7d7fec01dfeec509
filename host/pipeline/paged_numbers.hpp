// SPDX-License-Identifier: Apache-2.0
// A long row of integers, most of them zero or small: histograms of ten million bins and 16 replicates are held in
// memory. Pages of numbers take memory when one of them is not zero, and wide numbers when one of them needs it. The
// values are exact whatever their page holds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "device/zero_pages.hpp"

namespace clray {

/// Integers of type Wide, held as Narrow where those are large enough.
template <typename Narrow, typename Wide>
class PagedNumbers {
 public:
  PagedNumbers() = default;
  explicit PagedNumbers(std::size_t size) : size_(size), pages_((size + kPage - 1) / kPage) {}

  std::size_t size() const { return size_; }

  Wide operator[](std::size_t i) const {
    const Page& page = pages_[i / kPage];
    if (!page.narrow.empty()) return static_cast<Wide>(page.narrow[i % kPage]);
    return page.wide.empty() ? Wide{0} : page.wide[i % kPage];
  }

  void set(std::size_t i, Wide value) {
    Page& page = pages_[i / kPage];
    if (page.wide.empty()) {
      if (page.narrow.empty()) {
        if (value == 0) return;
        page.narrow.resize(std::min(kPage, size_ - i / kPage * kPage));
      }
      const auto narrow = static_cast<Narrow>(value);
      if (static_cast<Wide>(narrow) == value) {
        page.narrow[i % kPage] = narrow;
        return;
      }
      page.wide.assign(page.narrow.begin(), page.narrow.end());
      page.narrow = {};
    }
    page.wide[i % kPage] = value;
  }

  /// i, or the first number behind it whose page takes memory; size() where there is none.
  std::size_t next(std::size_t i) const {
    while (i < size_ && pages_[i / kPage].narrow.empty() && pages_[i / kPage].wide.empty()) i = (i / kPage + 1) * kPage;
    return std::min(i, size_);
  }

  void add(std::size_t i, Wide more) {
    if (more != 0) set(i, (*this)[i] + more);
  }

  /// Bytes of the pages.
  std::size_t bytes() const {
    std::size_t all = 0;
    for (const Page& page : pages_) all += page.narrow.size() * sizeof(Narrow) + page.wide.size() * sizeof(Wide);
    return all;
  }

  /// Gives back the pages that lie in begin … end - 1, whose numbers nobody reads any more.
  void forget(std::size_t begin, std::size_t end) {
    for (std::size_t p = (begin + kPage - 1) / kPage; p < pages_.size() && std::min((p + 1) * kPage, size_) <= end; ++p)
      pages_[p] = Page();
  }

 private:
  static constexpr std::size_t kPage = 16384;

  struct Page {
    std::vector<Narrow, PageAllocator<Narrow>> narrow;
    std::vector<Wide, PageAllocator<Wide>> wide;
  };

  std::size_t size_ = 0;
  std::vector<Page> pages_;
};

}  // namespace clray
