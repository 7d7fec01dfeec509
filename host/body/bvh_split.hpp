// SPDX-License-Identifier: Apache-2.0
// How the builder of the BVH (bvh.cpp) splits boxes in two: by the surface area heuristic over bins, or in the middle
// where that cannot part them. fp32 boxes in the box frame.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

namespace clray {

using Float4 = float __attribute__((vector_size(16)));

constexpr std::uint32_t kSahDepth = 40;  ///< below it ranges are halved

inline Float4 all_of(float x) {
  return Float4{x, x, x, x};
}

/// An fp32 box; the fourth number of each corner means nothing.
struct Bounds {
  Float4 low = all_of(std::numeric_limits<float>::infinity());
  Float4 high = all_of(-std::numeric_limits<float>::infinity());

  void add(Float4 other_low, Float4 other_high) {
    low = other_low < low ? other_low : low;
    high = other_high > high ? other_high : high;
  }
  void add(const Bounds& other) { add(other.low, other.high); }
  float half_area() const {
    const Float4 size = high - low;
    return size[0] < 0.0f ? 0.0f : size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

/// A box that the tree holds. Its number stands in the fourth place of `low`, as the bits of a float from 1 on: sums
/// with it cost no more than others.
struct Ref {
  Float4 low, high;

  Float4 centre() const { return low + high; }  // twice
  std::uint32_t number() const {
    const float place = low[3];
    std::uint32_t bits;
    std::memcpy(&bits, &place, sizeof bits);
    return bits - kFirstBits;
  }
  void set_number(std::uint32_t number) {
    const std::uint32_t bits = number + kFirstBits;
    float place;
    std::memcpy(&place, &bits, sizeof place);
    low[3] = place;
  }
  static constexpr std::uint32_t kFirstBits = 0x3f800000u;
};

/// Boxes `first` … `first + count - 1`, in the tree's order.
struct BoxRange {
  Bounds box, centres;
  std::uint32_t first = 0, count = 0, depth = 0;  // depth in a tree of two children a node
};

/// A range that is a leaf, or its halves.
struct Split {
  BoxRange whole, low, high;
  bool tried = false, leaf = false;
};

/// Splits a range of `refs` in two, whose boxes then stand next to each other, unless it is a leaf. What was tried
/// stays.
void try_split(Ref* refs, Split* split);

}  // namespace clray
