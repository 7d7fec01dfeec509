// SPDX-License-Identifier: Apache-2.0
// The linear BVH as a data structure: whatever the boxes, the tree holds each once inside boxes that contain it, is
// bounded in depth, says truly how much stack a walk needs, and depends on nothing but the boxes' shape. What a ray
// finds in it is tested on the device (tests/kernels/probe_bvh_test.cpp).
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "body/bvh.hpp"

using namespace clray;

namespace {

using Boxes = std::vector<Box>;
constexpr std::uint32_t kSahDepth = 40;  // below it the tree halves: bvh.hpp

Box box_at(std::array<double, 3> centre, std::array<double, 3> half) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    box.low[k] = centre[k] - half[k];
    box.high[k] = centre[k] + half[k];
  }
  return box;
}

Boxes random_boxes(std::size_t count, double spread, double size, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> at(-spread, spread), half(0.0, size);
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i)
    boxes.push_back(box_at({at(random), at(random), at(random)}, {half(random), half(random), half(random)}));
  return boxes;
}

bool is_leaf(std::uint32_t child) {
  return child_count(child) != 0;
}

/// What a walk over the whole tree finds wrong with it.
struct Audit {
  const Boxes& boxes;
  const LinearBvh& tree;
  std::vector<int> seen, visited;
  std::size_t outside = 0, not_nested = 0, bad_leaves = 0, bad_empty = 0;
  std::uint32_t depth = 0, most_stack = 0;

  Audit(const Boxes& b, const LinearBvh& t) : boxes(b), tree(t), seen(b.size(), 0), visited(t.nodes.size(), 0) {
    walk(0, 1, 1);
  }

  // `stack` entries lie on the stack when this node's is popped, its own included: all children are pushed in its
  // place, and the one that is opened next is popped first.
  void walk(std::uint32_t at, std::uint32_t level, std::uint32_t stack) {
    REQUIRE(at < tree.nodes.size());
    if (++visited[at] > 1) return;
    depth = std::max(depth, level);
    const ClrayNode& node = tree.nodes[at];
    std::uint32_t count = 0;
    for (const std::uint32_t child : node.child) count += child != CLRAY_NO_CHILD;
    most_stack = std::max(most_stack, stack - 1 + count);
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t child = node.child[k];
      if (child == CLRAY_NO_CHILD) {
        for (int axis = 0; axis < 3; ++axis) bad_empty += !(node.bounds[2 * axis][k] > node.bounds[2 * axis + 1][k]);
        continue;
      }
      if (is_leaf(child)) {
        check_leaf(node, k);
        continue;
      }
      check_nested(node, k, child_index(child));
      walk(child_index(child), level + 1, stack - 1 + count);
    }
  }

  void check_leaf(const ClrayNode& node, int k) {
    const std::uint32_t first = child_index(node.child[k]), count = child_count(node.child[k]);
    bad_leaves += count > kLeafPrimitives || first + count > tree.order.size();
    for (std::uint32_t i = first; i < first + count && i < tree.order.size(); ++i) {
      ++seen.at(tree.order[i]);
      const Box& box = boxes[tree.order[i]];
      for (int axis = 0; axis < 3; ++axis) {
        // Exact but for one rounding of 64 bits, far below the fp32 steps in question.
        const long double centre = tree.frame.centre[axis], scale = tree.frame.scale;
        outside += (box.low[axis] - centre) * scale < static_cast<long double>(node.bounds[2 * axis][k]);
        outside += (box.high[axis] - centre) * scale > static_cast<long double>(node.bounds[2 * axis + 1][k]);
      }
    }
  }

  void check_nested(const ClrayNode& node, int k, std::uint32_t inner) {
    for (int j = 0; j < 4; ++j) {
      if (tree.nodes.at(inner).child[j] == CLRAY_NO_CHILD) continue;
      for (int axis = 0; axis < 3; ++axis) {
        not_nested += tree.nodes[inner].bounds[2 * axis][j] < node.bounds[2 * axis][k];
        not_nested += tree.nodes[inner].bounds[2 * axis + 1][j] > node.bounds[2 * axis + 1][k];
      }
    }
  }
};

/// CHECKs everything that must hold for any boxes; returns the tree.
LinearBvh check_tree(const Boxes& boxes) {
  const LinearBvh tree = build_bvh(boxes);
  REQUIRE(tree.order.size() == boxes.size());
  const Audit audit(boxes, tree);
  CHECK(audit.outside == 0);
  CHECK(audit.not_nested == 0);
  CHECK(audit.bad_leaves == 0);
  CHECK(audit.bad_empty == 0);
  std::size_t not_once = 0, not_reached = 0;
  for (const int n : audit.seen) not_once += n != 1;
  for (const int n : audit.visited) not_reached += n != 1;
  CHECK(not_once == 0);
  CHECK(not_reached == 0);
  CHECK(tree.depth == audit.depth);
  CHECK(tree.depth <= kSahDepth + 1 + static_cast<std::uint32_t>(std::ceil(std::log2(boxes.size() + 1.0))));
  CHECK(tree.stack_needed == audit.most_stack);
  for (int k = 0; k < 3; ++k) {  // the box frame holds everything within [-1, 1]
    for (const Box& box : boxes) {
      if (std::fabs((box.low[k] - tree.frame.centre[k]) * tree.frame.scale) <= 1.0 &&
          std::fabs((box.high[k] - tree.frame.centre[k]) * tree.frame.scale) <= 1.0)
        continue;
      FAIL_CHECK("a box leaves the frame");
      break;
    }
  }
  int exponent = 0;
  CHECK(std::frexp(tree.frame.scale, &exponent) == 0.5);  // a power of two
  return tree;
}

bool same_nodes(const LinearBvh& a, const LinearBvh& b) {
  return a.nodes.size() == b.nodes.size() && a.order == b.order && a.stack_needed == b.stack_needed &&
         a.depth == b.depth && std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(ClrayNode)) == 0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TEST_CASE("any boxes: contained, each once, depth and stack as stated") {
  for (const std::size_t count : {1, 2, 3, 4, 5, 7, 16, 17, 100, 3000})
    for (const double size : {0.0, 1e-6, 0.1, 3.0}) {
      CAPTURE(count);
      CAPTURE(size);
      check_tree(random_boxes(count, 2.0, size, count));
    }
}

TEST_CASE("boxes far from the origin stay contained although fp64 itself is coarse there") {
  for (const double far : {1e3, 1e9, -1e15}) {
    Boxes boxes = random_boxes(500, 1.0, 0.05);
    for (Box& box : boxes)
      for (int k = 0; k < 3; ++k) {
        box.low[k] += far * (k + 1);
        box.high[k] += far * (k + 1);
      }
    check_tree(boxes);
  }
}

TEST_CASE("a single box, a single point, points in one place") {
  const LinearBvh one = check_tree({box_at({3, -4, 5}, {1, 2, 0.5})});
  CHECK(one.nodes.size() == 1);
  CHECK(one.stack_needed == 1);
  CHECK(one.depth == 1);
  CHECK(one.nodes[0].child[0] == 1u);
  check_tree({box_at({3, -4, 5}, {0, 0, 0})});
  check_tree(Boxes(100, box_at({0.1, 0.2, 0.3}, {0, 0, 0})));
}

TEST_CASE("flat boxes along every axis") {
  for (int axis = 0; axis < 3; ++axis) {
    Boxes boxes = random_boxes(800, 1.0, 0.1);
    for (Box& box : boxes) box.high[axis] = box.low[axis] = 0.3;
    check_tree(boxes);
    for (Box& box : boxes) box.high[(axis + 1) % 3] = box.low[(axis + 1) % 3] = -7.0;
    check_tree(boxes);
  }
}

TEST_CASE("one huge box among many tiny ones") {
  for (const std::size_t place : {std::size_t{0}, std::size_t{500}, std::size_t{1000}}) {
    Boxes boxes = random_boxes(1000, 1e-3, 1e-5);
    boxes.insert(boxes.begin() + static_cast<std::ptrdiff_t>(place), box_at({0, 0, 0}, {1e6, 1e6, 1e6}));
    const LinearBvh tree = check_tree(boxes);
    CHECK(tree.depth < 30);
  }
  // The tiny ones are still told apart when the huge one leaves them some fp32 steps.
  Boxes boxes = random_boxes(1000, 1.0, 1e-4);
  boxes.push_back(box_at({0, 0, 0}, {100, 100, 100}));
  CHECK(check_tree(boxes).depth < 15);
}

TEST_CASE("the depth stays bounded for a million coincident boxes, and the time too") {
  const Boxes boxes(1000000, box_at({1, 2, 3}, {0.5, 0.25, 0.125}));
  const auto start = std::chrono::steady_clock::now();
  const LinearBvh tree = build_bvh(boxes);
  const double seconds = seconds_since(start);
  MESSAGE(seconds << " s");
  CHECK(seconds < 60.0);    // about 1 s alone on one core; quadratic time would take days
  CHECK(tree.depth <= 20);  // halving: log2(10^6 / 4), merged by pairs of levels at best
  const Audit audit(boxes, tree);
  std::size_t not_once = 0;
  for (const int n : audit.seen) not_once += n != 1;
  CHECK(not_once == 0);
  CHECK(audit.outside == 0);
  CHECK(tree.stack_needed == audit.most_stack);
}

TEST_CASE("the depth stays bounded where the surface-area heuristic peels boxes off one by one") {
  // Each box is twice as far and twice as large as the one before: bins of equal width part one box from the rest.
  Boxes boxes{box_at({-1.1, -1.1, -1.1}, {0, 0, 0})};  // opposite: the frame's middle is where they gather
  for (int i = 0; i < 120; ++i) {
    const double x = std::ldexp(1.0, -i);
    boxes.push_back(box_at({x, x, x}, {0.1 * x, 0.1 * x, 0.1 * x}));
  }
  const std::uint32_t alone = check_tree(boxes).depth;
  CHECK(alone >= 5);
  // The same with a crowd at the small end.
  for (int i = 0; i < 20000; ++i) boxes.push_back(box_at({0, 0, 0}, {1e-38, 1e-38, 1e-38}));
  check_tree(boxes);
}

TEST_CASE("below depth 40 the tree halves: boxes that peel off few by few for 75 levels do not") {
  // Along each axis in turn boxes lie at powers of 2: bins of equal width part a few from all the rest. One box
  // opposite puts the middle of the frame, where fp32 is finest, where they gather.
  Boxes boxes{box_at({-1, -1, -1}, {0, 0, 0})};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 120; ++i) {
      std::array<double, 3> at{{0, 0, 0}};
      at[axis] = std::ldexp(1.0, -i);
      boxes.push_back(box_at(at, {0, 0, 0}));
    }
  // A node of four takes in up to three levels of a chain: 40/3, then log2(360/4) by twos. Unbounded it is 25.
  CHECK(check_tree(boxes).depth <= 14 + 4);
}

TEST_CASE("the stack that a walk uses in any order never exceeds what the tree says") {
  // The kernel's loop, with every child hit and children in random order of distance.
  for (const double size : {1e-3, 0.5}) {
    const Boxes boxes = random_boxes(4000, 1.0, size);
    const LinearBvh tree = build_bvh(boxes);
    std::mt19937 random(9);
    for (int round = 0; round < 20; ++round) {
      std::vector<std::uint32_t> stack{0};
      std::size_t most = 1, primitives = 0;
      while (!stack.empty()) {
        const std::uint32_t child = stack.back();
        stack.pop_back();
        if (is_leaf(child)) {
          primitives += child_count(child);
          continue;
        }
        std::vector<std::uint32_t> next;
        for (const std::uint32_t c : tree.nodes[child_index(child)].child)
          if (c != CLRAY_NO_CHILD) next.push_back(c);
        std::shuffle(next.begin(), next.end(), random);
        stack.insert(stack.end(), next.begin(), next.end());
        most = std::max(most, stack.size());
      }
      CHECK(most <= tree.stack_needed);
      CHECK(primitives == boxes.size());
    }
  }
}

TEST_CASE("same boxes, same tree; 2^40 times larger or smaller, the same nodes") {
  const Boxes boxes = random_boxes(5000, 1.0, 0.02);
  const LinearBvh tree = build_bvh(boxes);
  CHECK(same_nodes(tree, build_bvh(Boxes(boxes))));
  for (const int power : {40, -40, 1}) {
    Boxes scaled = boxes;
    for (Box& box : scaled)
      for (int k = 0; k < 3; ++k) {
        box.low[k] = std::ldexp(box.low[k], power);
        box.high[k] = std::ldexp(box.high[k], power);
      }
    const LinearBvh other = build_bvh(scaled);
    CHECK(same_nodes(tree, other));
    CHECK(other.frame.scale == std::ldexp(tree.frame.scale, -power));
    for (int k = 0; k < 3; ++k) CHECK(other.frame.centre[k] == std::ldexp(tree.frame.centre[k], power));
  }
}

TEST_CASE("the tree parts what is apart, along every axis: a line opens few of the nodes") {
  // Guards against a tree that is correct and useless. 20,000 boxes of 1/1000 the body fill 17 leaves along a side;
  // a line that crosses them opens a few nodes for each.
  const LinearBvh tree = build_bvh(random_boxes(20000, 1.0, 5e-4));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> at(-0.9f, 0.9f);
  for (int along = 0; along < 3; ++along) {
    std::size_t opened = 0;
    const int lines = 200;
    for (int n = 0; n < lines; ++n) {
      const float x[3] = {at(random), at(random), at(random)};
      std::vector<std::uint32_t> stack{0};
      while (!stack.empty()) {
        const ClrayNode& node = tree.nodes[child_index(stack.back())];
        stack.pop_back();
        ++opened;
        for (int k = 0; k < 4; ++k) {
          bool in = node.child[k] != CLRAY_NO_CHILD && !is_leaf(node.child[k]);
          for (int axis = 0; axis < 3; ++axis)
            in = in &&
                 (axis == along || (x[axis] >= node.bounds[2 * axis][k] && x[axis] <= node.bounds[2 * axis + 1][k]));
          if (in) stack.push_back(node.child[k]);
        }
      }
    }
    MESSAGE("nodes a line: " << static_cast<double>(opened) / lines << " of " << tree.nodes.size());
    CHECK(opened < tree.nodes.size() / 20 * lines);
  }
}

TEST_CASE("same boxes, same tree, whatever the number of threads") {
  // Two sizes of boxes: some tasks are far larger than others.
  Boxes boxes = random_boxes(90000, 1.0, 1e-3, 3);
  const Boxes small = random_boxes(30000, 1e-4, 1e-6, 4);
  boxes.insert(boxes.end(), small.begin(), small.end());
  const LinearBvh tree = build_bvh(boxes, 1);
  for (const unsigned threads : {2u, 3u, 7u}) CHECK(same_nodes(tree, build_bvh(boxes, threads)));
  const Audit audit(boxes, tree);
  CHECK(std::count(audit.seen.begin(), audit.seen.end(), 1) == static_cast<std::ptrdiff_t>(boxes.size()));
  CHECK(tree.depth == audit.depth);
  CHECK(tree.stack_needed == audit.most_stack);
}
