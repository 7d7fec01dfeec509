// SPDX-License-Identifier: Apache-2.0
// Sums as data. A pass adds to blocks of integers; what a block holds, how it is laid out, scaled, merged and read is
// said here once, and nothing below names a detector. Every integer is exact: parts add up in any order, on any device.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/paged_numbers.hpp"
#include "scene/tables.hpp"
#include "shared/abi.h"

namespace clray {

using Sum = __int128;

/// One block: rows of equally many numbers, one after the other. Rows run over views, then lanes, then connections (as
/// far as the block has them), then replicates (but in a block of views).
struct SumBlock {
  std::string name;
  SumRows rows = SumRows::connection;
  SumScale scale = SumScale::weight;
  std::uint64_t row_count = 0;
  std::uint32_t width = 0;
  std::uint64_t offset = 0;  ///< of its first number, among the values or among the counts
  std::string unit;          ///< not empty: its numbers are results by themselves

  bool counts() const { return scale == SumScale::count || scale == SumScale::greatest; }
  std::uint64_t size() const { return row_count * width; }
};

/// What rows run over.
struct SumShape {
  std::uint64_t views = 1, lanes = 1, connections = 1, replicates = 1;

  std::uint64_t rows(SumRows kind) const;
};

/// The blocks of a pass, in the order in which their detectors' rows state them.
struct SumLayout {
  SumShape shape;
  std::vector<SumBlock> blocks;
  std::uint64_t values = 0, counts = 0;  ///< numbers of each kind

  /// Appends a block behind those of its kind; returns its number.
  std::uint32_t add(const TableSum& sum, std::uint32_t width);
};

/// Integer sums of a pass so far; two runs of the same points have equal sums. Views have points of their own.
struct Sums {
  PagedNumbers<std::int64_t, Sum> values;  ///< at scale 2^S
  PagedNumbers<std::uint32_t, std::uint64_t> counts;
  std::vector<std::array<std::uint64_t, CLRAY_COUNTERS>> events;  ///< of each view, CLRAY_COUNT_*
  std::vector<std::uint64_t> points;                              ///< of each view, per replicate (and pixel)
  /// Of exact passes: a bound of the rounding of A in m²/sr, of each view, lane and connection.
  std::vector<double> rounding;
  std::vector<double> area_rounding;  ///< of exact passes: that of the lit area, m², of each view

  Sums() = default;
  /// Zeros for every view.
  explicit Sums(const SumLayout& layout);

  /// No view has any points.
  bool empty() const;
  /// Adds what other points of the same pass brought. The points of the views stay as they are.
  void add(const SumLayout& layout, const Sums& more);
  /// Gives a view the sums that it has in `other`, or zeros.
  void set_view(const SumLayout& layout, std::size_t view, const Sums* other);
};

/// Numbers of a block that belong to views first … end - 1.
struct SumRange {
  std::uint64_t begin = 0, end = 0;
};
SumRange range_of(const SumLayout& layout, const SumBlock& block, std::size_t first_view, std::size_t end_view);

/// FNV-1a over the blocks of a detector (numbers `first` to `last`), continued from `state`: the values of each block
/// as integers of 128 bits, or row by row its counts as integers of 64.
std::uint64_t digest_values(std::uint64_t state, const SumLayout& layout, const Sums& sums, std::uint32_t first,
                            std::uint32_t last);
std::uint64_t digest_counts(std::uint64_t state, const SumLayout& layout, const Sums& sums, std::uint32_t first,
                            std::uint32_t last);

}  // namespace clray
