// SPDX-License-Identifier: Apache-2.0
// Splitting ranges of boxes; see bvh_split.hpp.
#include "body/bvh_split.hpp"

#include <algorithm>
#include <cmath>

#include "body/bvh.hpp"

namespace clray {
namespace {

constexpr int kBins = 16;               // at most: 4, and one for every 16 boxes
constexpr float kTraversalCost = 1.0f;  // in units of one triangle test; measured on the three spacecraft

using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Which bin a centre falls in, along each axis.
struct Binning {
  int bins;
  Float4 low, scale;

  explicit Binning(const BoxRange& range)
      : bins(static_cast<int>(std::min<std::uint32_t>(kBins, 4 + range.count / 16))), low(range.centres.low) {
    scale = static_cast<float>(bins) / (range.centres.high - range.centres.low);
    for (int axis = 0; axis < 4; ++axis) {
      if (axis == 3 || !std::isfinite(scale[axis])) scale[axis] = 0.0f;  // all are in one place
    }
  }
  Int4 of(Float4 centre) const {
    const Int4 bin = __builtin_convertvector((centre - low) * scale, Int4), last = Int4{} + (bins - 1);
    return bin < last ? bin : last;
  }
};

/// The boxes of the bins along each axis. (No constructor, since most ranges are small and use few bins.)
struct Bins {
  struct Bin {
    Float4 low, high;
    std::uint32_t count;
  };
  Bin bin[3][kBins];

  void fill(const Binning& binning, const Ref* begin, const Ref* end) {
    const Bounds none;
    for (auto& along : bin) {
      for (int b = 0; b < binning.bins; ++b) along[b] = {none.low, none.high, 0};
    }
    for (const Ref* ref = begin; ref != end; ++ref) {
      const Int4 place = binning.of(ref->centre());
      for (int axis = 0; axis < 3; ++axis) {
        Bin& in = bin[axis][place[axis]];
        in.low = ref->low < in.low ? ref->low : in.low;
        in.high = ref->high > in.high ? ref->high : in.high;
        ++in.count;
      }
    }
  }
};

/// The best plane between bins: after bin `bin` along `axis` (-1: none).
struct Plane {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1, bin = 0;
};

void find_plane(const Bins& bins, int axis, int last, std::uint32_t all, Plane* best) {
  float right_cost[kBins];
  Bounds high;
  std::uint32_t n = 0;
  for (int bin = last; bin > 0; --bin) {
    high.add(bins.bin[axis][bin].low, bins.bin[axis][bin].high);
    n += bins.bin[axis][bin].count;
    right_cost[bin] = high.half_area() * static_cast<float>(n);
  }
  Bounds low;
  n = 0;
  for (int bin = 0; bin < last; ++bin) {
    low.add(bins.bin[axis][bin].low, bins.bin[axis][bin].high);
    n += bins.bin[axis][bin].count;
    if (n == 0 || n == all) continue;
    const float cost = low.half_area() * static_cast<float>(n) + right_cost[bin + 1];
    if (cost < best->cost) *best = {cost, axis, bin};
  }
}

void set_ranges(Split* split, std::uint32_t low) {
  const BoxRange& whole = split->whole;
  split->low.first = whole.first;
  split->low.count = low;
  split->high.first = whole.first + low;
  split->high.count = whole.count - low;
  split->low.depth = split->high.depth = whole.depth + 1;
}

// Puts the boxes of the bins up to the plane before the others.
void part(Ref* refs, Split* split, const Binning& binning, const Plane& plane) {
  const BoxRange& whole = split->whole;
  Ref *begin = refs + whole.first, *end = begin + whole.count, *const first = begin;
  const auto is_low = [&](const Ref& ref) { return binning.of(ref.centre())[plane.axis] <= plane.bin; };
  for (;;) {
    for (; begin < end && is_low(*begin); ++begin) split->low.centres.add(begin->centre(), begin->centre());
    for (; begin < end && !is_low(end[-1]); --end) split->high.centres.add(end[-1].centre(), end[-1].centre());
    if (begin >= end) break;
    std::swap(*begin, end[-1]);
  }
  set_ranges(split, static_cast<std::uint32_t>(begin - first));
}

// Splits by position in the middle along the longest axis, unless a leaf holds them all.
void split_in_middle(Ref* refs, Split* split) {
  const BoxRange& whole = split->whole;
  split->leaf = whole.count <= kLeafPrimitives;
  if (split->leaf) return;
  const Float4 size = whole.box.high - whole.box.low;
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (size[k] > size[axis]) axis = k;
  }
  Ref *const begin = refs + whole.first, *const middle = begin + whole.count / 2;
  std::nth_element(begin, middle, begin + whole.count, [axis](const Ref& a, const Ref& b) {
    const float x = a.centre()[axis], y = b.centre()[axis];
    return x < y || (x == y && a.number() < b.number());
  });
  for (std::uint32_t i = 0; i < whole.count; ++i) {
    BoxRange& half = begin + i < middle ? split->low : split->high;
    half.box.add(begin[i].low, begin[i].high);
    half.centres.add(begin[i].centre(), begin[i].centre());
  }
  set_ranges(split, whole.count / 2);
}

}  // namespace

void try_split(Ref* refs, Split* split) {
  if (split->tried) return;
  split->tried = true;
  const BoxRange& whole = split->whole;
  split->leaf = whole.count <= 1;
  if (split->leaf) return;
  if (whole.depth >= kSahDepth) return split_in_middle(refs, split);
  const Binning binning(whole);
  Bins bins;
  Ref* const begin = refs + whole.first;
  bins.fill(binning, begin, begin + whole.count);
  Plane plane;
  for (int axis = 0; axis < 3; ++axis) {
    if (binning.scale[axis] > 0.0f) find_plane(bins, axis, binning.bins - 1, whole.count, &plane);
  }
  if (plane.axis < 0) return split_in_middle(refs, split);
  const float area = whole.box.half_area();
  split->leaf =
      whole.count <= kLeafPrimitives && plane.cost + kTraversalCost * area >= area * static_cast<float>(whole.count);
  if (split->leaf) return;
  for (int bin = 0; bin < binning.bins; ++bin)
    (bin <= plane.bin ? split->low : split->high)
        .box.add(bins.bin[plane.axis][bin].low, bins.bin[plane.axis][bin].high);
  part(refs, split, binning, plane);
}

}  // namespace clray
