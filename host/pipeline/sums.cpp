// SPDX-License-Identifier: Apache-2.0
// See sums.hpp.
#include "pipeline/sums.hpp"

#include <algorithm>

#include "pipeline/estimate.hpp"
#include "text/hash.hpp"

namespace clray {

std::uint64_t SumShape::rows(SumRows kind) const {
  if (kind == SumRows::view) return views;
  return views * lanes * (kind == SumRows::connection ? connections : 1) * replicates;
}

std::uint32_t SumLayout::add(const TableSum& sum, std::uint32_t width) {
  SumBlock block;
  block.name = sum.name;
  block.rows = sum.rows;
  block.scale = sum.scale;
  block.row_count = shape.rows(sum.rows);
  block.width = width;
  block.unit = sum.unit;
  std::uint64_t& end = block.counts() ? counts : values;
  block.offset = end;
  end += block.size();
  blocks.push_back(block);
  return static_cast<std::uint32_t>(blocks.size() - 1);
}

Sums::Sums(const SumLayout& layout)
    : values(layout.values), counts(layout.counts), events(layout.shape.views), points(layout.shape.views) {}

bool Sums::empty() const {
  return std::all_of(points.begin(), points.end(), [](std::uint64_t n) { return n == 0; });
}

void Sums::set_view(const SumLayout& layout, std::size_t view, const Sums* other) {
  for (const SumBlock& block : layout.blocks) {
    const SumRange range = range_of(layout, block, view, view + 1);
    for (std::uint64_t k = range.begin; k < range.end; ++k) {
      if (block.counts()) {
        counts[k] = other != nullptr ? other->counts[k] : 0;
      } else {
        values[k] = other != nullptr ? other->values[k] : 0;
      }
    }
  }
  events[view] = other != nullptr ? other->events[view] : std::array<std::uint64_t, CLRAY_COUNTERS>{};
  points[view] = other != nullptr ? other->points[view] : 0;
}

SumRange range_of(const SumLayout& layout, const SumBlock& block, std::size_t first_view, std::size_t end_view) {
  const std::uint64_t of_view = block.size() / layout.shape.views;
  return {block.offset + first_view * of_view, block.offset + end_view * of_view};
}

std::uint64_t digest_values(std::uint64_t state, const SumLayout& layout, const Sums& sums, std::uint32_t first,
                            std::uint32_t last) {
  for (std::uint32_t b = first; b < last; ++b) {
    const SumBlock& block = layout.blocks[b];
    if (!block.counts() && block.size() != 0)
      state = fnv1a(state, sums.values.data() + block.offset, block.size() * sizeof(Sum));
  }
  return state;
}

std::uint64_t digest_counts(std::uint64_t state, const SumLayout& layout, const Sums& sums, std::uint32_t first,
                            std::uint32_t last) {
  std::uint64_t rows = 0;
  for (std::uint32_t b = first; b < last; ++b) {
    if (layout.blocks[b].counts()) rows = std::max(rows, layout.blocks[b].row_count);
  }
  for (std::uint64_t row = 0; row < rows; ++row) {
    for (std::uint32_t b = first; b < last; ++b) {
      const SumBlock& block = layout.blocks[b];
      if (!block.counts() || row >= block.row_count) continue;
      state = fnv1a(state, sums.counts.data() + block.offset + row * block.width, block.width * sizeof(std::uint64_t));
    }
  }
  return state;
}

}  // namespace clray
