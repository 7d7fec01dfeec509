// SPDX-License-Identifier: Apache-2.0
// Building the linear BVH: boxes to fp32 (outward) in the box frame, a binary tree by binned SAH, merged by fours.
#include "body/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clray {
namespace {

constexpr int kBins = 16;
constexpr std::uint32_t kSahDepth = 40;
constexpr float kTraversalCost = 1.0f;  // in units of one triangle test; measured on the three spacecraft

struct FloatBox {
  float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                  std::numeric_limits<float>::infinity()};
  float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};

  void add(const FloatBox& b) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], b.low[k]);
      high[k] = std::max(high[k], b.high[k]);
    }
  }
  float half_area() const {
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x < 0.0f ? 0.0f : x * y + y * z + z * x;
  }
  float middle(int axis) const { return low[axis] + high[axis]; }
};

struct BinaryNode {
  FloatBox box;
  std::uint32_t first = 0;  // of its positions, or of its two children
  std::uint32_t count = 0;  // 0: inner
};

// Two steps outward: one for the conversion, one for the fp64 rounding of (x - centre)·scale.
float round_down(double x) {
  const float f = static_cast<float>(x);
  const float low = -std::numeric_limits<float>::infinity();
  return std::nextafter(static_cast<double>(f) > x ? std::nextafter(f, low) : f, low);
}
float round_up(double x) {
  return -round_down(-x);
}

class Builder {
 public:
  explicit Builder(const std::vector<Box>& boxes) {
    Box all;
    for (const Box& b : boxes) all.add(b);
    double half = 0.0;
    for (int k = 0; k < 3; ++k) {
      tree_.frame.centre[k] = 0.5 * all.low[k] + 0.5 * all.high[k];
      half = std::max(half, all.high[k] - tree_.frame.centre[k]);
    }
    tree_.frame.scale = half > 0.0 ? std::ldexp(1.0, -(std::ilogb(half) + 1)) : 1.0;
    boxes_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        boxes_[i].low[k] = round_down((boxes[i].low[k] - tree_.frame.centre[k]) * tree_.frame.scale);
        boxes_[i].high[k] = round_up((boxes[i].high[k] - tree_.frame.centre[k]) * tree_.frame.scale);
      }
    }
    tree_.order.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) tree_.order[i] = static_cast<std::uint32_t>(i);
  }

  LinearBvh build() {
    split_all();
    tree_.nodes.emplace_back();
    tree_.stack_needed = flatten(0, 0, 1);
    return std::move(tree_);
  }

 private:
  struct Task {
    std::uint32_t node, depth;
  };

  FloatBox bounds(std::uint32_t first, std::uint32_t count) const {
    FloatBox box;
    for (std::uint32_t i = first; i < first + count; ++i) box.add(boxes_[tree_.order[i]]);
    return box;
  }

  void split_all() {
    BinaryNode root;
    root.count = static_cast<std::uint32_t>(boxes_.size());
    root.box = bounds(0, root.count);
    binary_.push_back(root);
    std::vector<Task> tasks{{0, 0}};
    while (!tasks.empty()) {
      const Task task = tasks.back();
      tasks.pop_back();
      const BinaryNode node = binary_[task.node];
      if (node.count <= 1) continue;
      const std::uint32_t left = task.depth < kSahDepth ? sah_split(node) : median_split(node);
      if (left == 0) continue;
      BinaryNode a, b;
      a.first = node.first;
      a.count = left;
      b.first = node.first + left;
      b.count = node.count - left;
      a.box = bounds(a.first, a.count);
      b.box = bounds(b.first, b.count);
      const auto child = static_cast<std::uint32_t>(binary_.size());
      binary_[task.node].first = child;
      binary_[task.node].count = 0;
      binary_.push_back(a);
      binary_.push_back(b);
      tasks.push_back({child, task.depth + 1});
      tasks.push_back({child + 1, task.depth + 1});
    }
  }

  // Splits by position in the middle along the longest axis of the centres; 0 for a leaf.
  std::uint32_t median_split(const BinaryNode& node) {
    if (node.count <= kLeafPrimitives) return 0;
    const int axis = longest_axis(node);
    const auto begin = tree_.order.begin() + node.first;
    std::nth_element(begin, begin + node.count / 2, begin + node.count, [&](std::uint32_t x, std::uint32_t y) {
      const float mx = boxes_[x].middle(axis), my = boxes_[y].middle(axis);
      return mx < my || (mx == my && x < y);
    });
    return node.count / 2;
  }

  int longest_axis(const BinaryNode& node) const {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (node.box.high[k] - node.box.low[k] > node.box.high[axis] - node.box.low[axis]) axis = k;
    }
    return axis;
  }

  std::uint32_t sah_split(const BinaryNode& node) {
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::numeric_limits<float>::infinity();
      high[k] = -low[k];
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const float m = boxes_[tree_.order[i]].middle(k);
        low[k] = std::min(low[k], m);
        high[k] = std::max(high[k], m);
      }
    }
    float best = std::numeric_limits<float>::infinity();
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(high[axis] > low[axis])) continue;
      FloatBox box[kBins];
      std::uint32_t count[kBins] = {};
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const FloatBox& b = boxes_[tree_.order[i]];
        const int bin = bin_of(b.middle(axis), low[axis], high[axis]);
        box[bin].add(b);
        ++count[bin];
      }
      float right_cost[kBins];
      FloatBox right;
      std::uint32_t n = 0;
      for (int bin = kBins - 1; bin > 0; --bin) {
        right.add(box[bin]);
        n += count[bin];
        right_cost[bin] = right.half_area() * static_cast<float>(n);
      }
      FloatBox left;
      n = 0;
      for (int bin = 0; bin + 1 < kBins; ++bin) {
        left.add(box[bin]);
        n += count[bin];
        if (n == 0 || n == node.count) continue;
        const float cost = left.half_area() * static_cast<float>(n) + right_cost[bin + 1];
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_bin = bin;
        }
      }
    }
    if (best_axis < 0) return median_split(node);
    const float area = node.box.half_area();
    const bool leaf_allowed = node.count <= kLeafPrimitives;
    if (leaf_allowed && best + kTraversalCost * area >= area * static_cast<float>(node.count)) return 0;
    const auto begin = tree_.order.begin() + node.first;
    const auto middle = std::partition(begin, begin + node.count, [&](std::uint32_t i) {
      return bin_of(boxes_[i].middle(best_axis), low[best_axis], high[best_axis]) <= best_bin;
    });
    return static_cast<std::uint32_t>(middle - begin);
  }

  static int bin_of(float middle, float low, float high) {
    const int bin = static_cast<int>((middle - low) / (high - low) * static_cast<float>(kBins));
    return std::clamp(bin, 0, kBins - 1);
  }

  // Fills wide node `at` from binary node `from`; returns the stack entries that walking it can need.
  std::uint32_t flatten(std::uint32_t from, std::uint32_t at, std::uint32_t depth) {
    tree_.depth = std::max(tree_.depth, depth);
    std::vector<std::uint32_t> children{from};
    if (binary_[from].count == 0) {
      children = {binary_[from].first, binary_[from].first + 1};
      while (children.size() < 4) {
        int widest = -1;
        for (std::size_t k = 0; k < children.size(); ++k) {
          if (binary_[children[k]].count != 0) continue;
          if (widest < 0 || binary_[children[k]].box.half_area() > binary_[children[widest]].box.half_area())
            widest = static_cast<int>(k);
        }
        if (widest < 0) break;
        const std::uint32_t opened = binary_[children[widest]].first;
        children[widest] = opened;
        children.push_back(opened + 1);
      }
    }
    ClrayNode node;
    std::uint32_t inner[4] = {};
    for (std::uint32_t k = 0; k < 4; ++k) {
      const FloatBox box = k < children.size() ? binary_[children[k]].box : FloatBox();
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[2 * axis][k] = box.low[axis];
        node.bounds[2 * axis + 1][k] = box.high[axis];
      }
      node.child[k] = CLRAY_NO_CHILD;
      if (k >= children.size()) continue;
      const BinaryNode& child = binary_[children[k]];
      if (child.count != 0) {
        node.child[k] = node_child(child.first, child.count);
      } else {
        inner[k] = static_cast<std::uint32_t>(tree_.nodes.size());
        node.child[k] = node_child(inner[k], 0);
        tree_.nodes.emplace_back();
      }
    }
    tree_.nodes[at] = node;
    const auto count = static_cast<std::uint32_t>(children.size());
    std::uint32_t needed = count;
    for (std::uint32_t k = 0; k < count; ++k) {
      if (inner[k] != 0) needed = std::max(needed, count - 1 + flatten(children[k], inner[k], depth + 1));
    }
    return needed;
  }

  std::vector<FloatBox> boxes_;
  std::vector<BinaryNode> binary_;
  LinearBvh tree_;
};

}  // namespace

void Box::add(const std::array<double, 3>& point) {
  for (int k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], point[k]);
    high[k] = std::max(high[k], point[k]);
  }
}

void Box::add(const Box& box) {
  add(box.low);
  add(box.high);
}

LinearBvh build_bvh(const std::vector<Box>& boxes) {
  return Builder(boxes).build();
}

void append_tree(const LinearBvh& tree, std::uint32_t first_leaf, std::vector<ClrayNode>* nodes) {
  const auto first_node = static_cast<std::uint32_t>(nodes->size());
  for (ClrayNode node : tree.nodes) {
    for (std::uint32_t& child : node.child) {
      if (child == CLRAY_NO_CHILD) continue;
      const std::uint32_t count = child_count(child);
      child = node_child(child_index(child) + (count != 0 ? first_leaf : first_node), count);
    }
    nodes->push_back(node);
  }
}

}  // namespace clray
