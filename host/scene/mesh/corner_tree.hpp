// SPDX-License-Identifier: Apache-2.0
// The corners of a polygon in a k-d tree (Bentley 1975), for ear clipping: finds a corner in a triangle without looking
// at all of them. Corners leave as their ears are cut. A node is passed over only where no corner in its box can
// satisfy the caller's inequalities as they are computed, so answers equal those of a loop over all corners.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/portable.h"

namespace clray {

/// A corner in the plane.
struct PlanePoint {
  double x, y;
};

/// Twice the signed area of a, b, c. The sign is exact for the rounded differences of coordinates.
inline double plane_turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return difference_of_products(b.x - a.x, c.y - a.y, b.y - a.y, c.x - a.x);
}

class CornerTree {
 public:
  explicit CornerTree(const std::vector<PlanePoint>& points);

  void remove(std::uint32_t corner);
  bool has(std::uint32_t corner) const { return there_[corner] != 0; }

  /// Calls `blocks(corner)` for corners that may lie in or on the triangle a, b, c until it returns true. Returns that
  /// corner, or kNone. All corners with plane_turn >= 0 along the three edges are among them.
  template <class Blocks>
  std::uint32_t find(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const Blocks& blocks) const {
    return find_below(0, a, b, c, blocks);
  }

  static constexpr std::uint32_t kNone = ~0u;

 private:
  struct Node {
    PlanePoint low, high;
    std::uint32_t begin, end;  // of order_
    std::uint32_t left;        // number of corners that are still there
    std::uint32_t child;       // the first of two, 0 in a leaf
    bool along_x;              // how it is split
  };

  void split(std::uint32_t index, const std::vector<PlanePoint>& points);

  // Whether a point of the box may lie left of the line from a to b. Rounding of differences is monotonic, so the
  // corner of the box that lies farthest to the left decides for all points of the box.
  static bool may_be_left(const Node& n, const PlanePoint& a, const PlanePoint& b) {
    return plane_turn(a, b, {b.y > a.y ? n.low.x : n.high.x, b.x > a.x ? n.high.y : n.low.y}) >= 0.0;
  }

  template <class Blocks>
  std::uint32_t find_below(std::uint32_t index, const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                           const Blocks& blocks) const {
    const Node& node = nodes_[index];
    if (node.left == 0 || !may_be_left(node, a, b) || !may_be_left(node, b, c) || !may_be_left(node, c, a))
      return kNone;
    if (node.child != 0) {
      const std::uint32_t found = find_below(node.child, a, b, c, blocks);
      return found != kNone ? found : find_below(node.child + 1, a, b, c, blocks);
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (there_[order_[i]] && blocks(order_[i])) return order_[i];
    }
    return kNone;
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;   // corners, those of a node together
  std::vector<std::uint32_t> parent_;  // of each node
  std::vector<std::uint32_t> leaf_;    // of each corner
  std::vector<char> there_;
};

}  // namespace clray
