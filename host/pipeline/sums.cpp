// SPDX-License-Identifier: Apache-2.0
// See sums.hpp.
#include "pipeline/sums.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "pipeline/estimate.hpp"
#include "text/hash.hpp"

namespace clray {

namespace {

template <typename Number, typename Numbers>
std::uint64_t digest_numbers(std::uint64_t state, const Numbers& numbers, std::uint64_t first, std::uint64_t count) {
  std::array<Number, 1024> some{};
  for (std::uint64_t done = 0; done < count; done += some.size()) {
    const std::size_t now = std::min<std::uint64_t>(some.size(), count - done);
    for (std::size_t k = 0; k < now; ++k) some[k] = numbers[first + done + k];
    state = fnv1a(state, some.data(), now * sizeof(Number));
  }
  return state;
}

}  // namespace

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

void Sums::add(const SumLayout& layout, const Sums& more) {
  for (std::uint64_t k = more.values.next(0); k < layout.values; k = more.values.next(k + 1))
    values.add(k, more.values[k]);
  for (const SumBlock& block : layout.blocks) {
    if (!block.counts()) continue;
    const std::uint64_t end = block.offset + block.size();
    for (std::uint64_t k = more.counts.next(block.offset); k < end; k = more.counts.next(k + 1)) {
      if (block.scale != SumScale::greatest) {
        counts.add(k, more.counts[k]);
      } else if (more.counts[k] > counts[k]) {
        counts.set(k, more.counts[k]);
      }
    }
  }
  for (std::size_t v = 0; v < events.size(); ++v)
    std::transform(events[v].begin(), events[v].end(), more.events[v].begin(), events[v].begin(), std::plus<>());
  const auto add_bounds = [](const std::vector<double>& from, std::vector<double>* to) {
    to->resize(std::max(to->size(), from.size()));
    std::transform(from.begin(), from.end(), to->begin(), to->begin(), std::plus<>());
  };
  add_bounds(more.rounding, &rounding);
  add_bounds(more.area_rounding, &area_rounding);
}

void Sums::set_view(const SumLayout& layout, std::size_t view, const Sums* other) {
  for (const SumBlock& block : layout.blocks) {
    const SumRange range = range_of(layout, block, view, view + 1);
    for (std::uint64_t k = range.begin; k < range.end; ++k) {
      if (block.counts()) {
        counts.set(k, other != nullptr ? other->counts[k] : 0);
      } else {
        values.set(k, other != nullptr ? other->values[k] : 0);
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
      state = digest_numbers<Sum>(state, sums.values, block.offset, block.size());
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
      state = digest_numbers<std::uint64_t>(state, sums.counts, block.offset + row * block.width, block.width);
    }
  }
  return state;
}

}  // namespace clray
