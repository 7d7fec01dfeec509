// SPDX-License-Identifier: Apache-2.0
// Builds the tree of a polygon's corners; see corner_tree.hpp. Nodes are split at the median, by x and y in turn: then
// a straight line meets the square root of the number of nodes, wherever the corners lie.
#include "scene/mesh/corner_tree.hpp"

#include <algorithm>
#include <numeric>

namespace clray {

namespace {

constexpr std::uint32_t kLeafCorners = 8;

}  // namespace

CornerTree::CornerTree(const std::vector<PlanePoint>& points)
    : order_(points.size()), leaf_(points.size()), there_(points.size(), 1) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.push_back({{}, {}, 0, static_cast<std::uint32_t>(points.size()), 0, 0, true});
  parent_.push_back(kNone);
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) split(node, points);
}

void CornerTree::split(std::uint32_t index, const std::vector<PlanePoint>& points) {
  Node node = nodes_[index];
  node.low = node.high = points[order_[node.begin]];
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const PlanePoint& p = points[order_[i]];
    node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
    node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
  }
  node.left = node.end - node.begin;
  if (node.left <= kLeafCorners) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) leaf_[order_[i]] = index;
  } else {
    const bool along_x = node.high.y == node.low.y || (node.high.x != node.low.x && node.along_x);
    const std::uint32_t middle = node.begin + node.left / 2;
    std::nth_element(order_.begin() + node.begin, order_.begin() + middle, order_.begin() + node.end,
                     [&](std::uint32_t i, std::uint32_t j) {
                       return along_x ? points[i].x < points[j].x : points[i].y < points[j].y;
                     });
    node.child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({{}, {}, node.begin, middle, 0, 0, !along_x});
    nodes_.push_back({{}, {}, middle, node.end, 0, 0, !along_x});
    parent_.insert(parent_.end(), 2, index);
  }
  nodes_[index] = node;
}

void CornerTree::remove(std::uint32_t corner) {
  there_[corner] = 0;
  for (std::uint32_t node = leaf_[corner]; node != kNone; node = parent_[node]) --nodes_[node].left;
}

}  // namespace clray
