// SPDX-License-Identifier: Apache-2.0
// The linear BVH: built on the host from fp64 bounds, flattened to ClrayNode (shared/bvh_node.h), walked by
// kernels/walk. Knows no OpenCL and no shapes. Everything about the layout (four children a node, leaves of
// at most kLeafPrimitives) stays behind this interface.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "shared/abi.h"

namespace clray {

/// An axis-aligned box in metres; empty while low > high.
struct Box {
  std::array<double, 3> low{{1e300, 1e300, 1e300}};
  std::array<double, 3> high{{-1e300, -1e300, -1e300}};

  void add(const std::array<double, 3>& point);
  void add(const Box& box);
  bool empty() const { return low[0] > high[0]; }
};

/// The box frame of a tree: x' = (x - centre)·scale lies in [-1, 1]; scale is a power of two, so scenes that differ by
/// one have the same tree.
struct BoxFrame {
  std::array<double, 3> centre{{0, 0, 0}};
  double scale = 1.0;
};

struct LinearBvh {
  BoxFrame frame;
  std::vector<ClrayNode> nodes;      ///< children's indices count from the start of this vector; [0] is the root
  std::vector<std::uint32_t> order;  ///< leaf position -> index of the box; leaves hold positions
  std::uint32_t stack_needed = 1;    ///< entries that a walk can need at most
  std::uint32_t depth = 0;
};

constexpr std::uint32_t kLeafPrimitives = 4;
static_assert(kLeafPrimitives <= CLRAY_LEAF_LARGEST);

/// Builds a tree over `boxes` (at least one) by binned SAH: Wald (2007), "On fast construction of SAH-based bounding
/// volume hierarchies"; 16 bins, 8 for few boxes. Below depth 40 it splits at the median, which bounds the depth at 40
/// + log2(n) even for coincident boxes. Chosen over Morton order because satellites mix very long and very small
/// triangles, which Morton order groups badly; pairs of levels are merged into nodes of four. Same boxes, same tree, on
/// any host and with any number of threads (0: those of the processor).
LinearBvh build_bvh(const std::vector<Box>& boxes, unsigned threads = 0);
/// The same over the boxes box_of(0) … box_of(count - 1), which are asked for twice, by several threads.
LinearBvh build_bvh(std::size_t count, const std::function<Box(std::size_t)>& box_of, unsigned threads = 0);

/// Appends a tree to *nodes, where its root then stands first; its leaves' positions count from `first_leaf`.
void append_tree(LinearBvh tree, std::uint32_t first_leaf, std::vector<ClrayNode>* nodes);

}  // namespace clray
