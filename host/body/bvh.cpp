// SPDX-License-Identifier: Apache-2.0
// Building the linear BVH: boxes to fp32 (outward) in the box frame, split by binned SAH straight into nodes of four.
// Large ranges are tasks of a queue that several threads take; how a range is split depends on its boxes alone.
#include "body/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

#include "body/bvh_split.hpp"
#include "body/in_parts.hpp"

namespace clray {
namespace {

constexpr std::uint32_t kOwnTask = 8192;  // boxes of a range that is a task of its own

/// The next float toward minus infinity, of numbers in [-4, 4].
float next_below(float x) {
  std::int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits = x > 0.0f ? bits - 1 : x < 0.0f ? bits + 1 : std::numeric_limits<std::int32_t>::min() + 1;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

// Two steps outward: one for the conversion, one for the fp64 rounding of (x - centre)·scale.
float round_down(double x) {
  const float f = static_cast<float>(x);
  return next_below(static_cast<double>(f) > x ? next_below(f) : f);
}
float round_up(double x) {
  return -round_down(-x);
}

/// A subtree: its nodes, the root first. Children that are chunks of their own have no index yet.
struct Chunk {
  std::vector<ClrayNode> nodes;
  std::uint32_t stack_needed = 1, depth = 1;
  std::unique_ptr<Chunk> child[4];
};

class Builder {
 public:
  Builder(std::size_t count, const std::function<Box(std::size_t)>& box_of, unsigned threads) : refs_(count) {
    threads_ = threads_for(count, threads);
    Box all;
    in_parts(count, threads_, [&](std::size_t first, std::size_t end) {
      Box own;
      for (std::size_t i = first; i < end; ++i) own.add(box_of(i));
      const std::lock_guard<std::mutex> lock(mutex_);
      all.add(own);
    });
    double half = 0.0;
    for (int k = 0; k < 3; ++k) {
      tree_.frame.centre[k] = 0.5 * all.low[k] + 0.5 * all.high[k];
      half = std::max(half, all.high[k] - tree_.frame.centre[k]);
    }
    tree_.frame.scale = half > 0.0 ? std::ldexp(1.0, -(std::ilogb(half) + 1)) : 1.0;
    root_.count = static_cast<std::uint32_t>(count);
    in_parts(count, threads_, [&](std::size_t first, std::size_t end) { set_refs(first, end, box_of); });
  }

  LinearBvh build() {
    Split root;
    root.whole = root_;
    auto chunk = std::make_unique<Chunk>();
    tasks_.push_back({root, chunk.get()});
    std::vector<std::thread> others;
    for (unsigned k = 1; k < threads_; ++k) others.emplace_back([this] { take_tasks(); });
    take_tasks();
    for (std::thread& thread : others) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    std::size_t nodes = 0;
    count_nodes(*chunk, &nodes);
    tree_.order.resize(refs_.size());
    for (std::size_t i = 0; i < refs_.size(); ++i) tree_.order[i] = refs_[i].number();
    refs_ = {};
    tree_.nodes.reserve(nodes);
    append(std::move(chunk), 0);
    return std::move(tree_);
  }

 private:
  struct Task {
    Split split;
    Chunk* chunk;
  };

  void set_refs(std::size_t first, std::size_t end, const std::function<Box(std::size_t)>& box_of) {
    BoxRange own;
    for (std::size_t i = first; i < end; ++i) {
      const Box box = box_of(i);
      Ref& ref = refs_[i];
      ref.low = ref.high = all_of(0.0f);
      for (int k = 0; k < 3; ++k) {
        ref.low[k] = round_down((box.low[k] - tree_.frame.centre[k]) * tree_.frame.scale);
        ref.high[k] = round_up((box.high[k] - tree_.frame.centre[k]) * tree_.frame.scale);
      }
      ref.set_number(static_cast<std::uint32_t>(i));
      own.box.add(ref.low, ref.high);
      own.centres.add(ref.centre(), ref.centre());
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    root_.box.add(own.box);
    root_.centres.add(own.centres);
  }

  // Takes tasks until there are none left and none that could bring more.
  void take_tasks() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return !tasks_.empty() || busy_ == 0 || failure_; });
      if (tasks_.empty() || failure_) return;
      Task task = tasks_.front();
      tasks_.pop_front();
      ++busy_;
      lock.unlock();
      std::vector<Task> more;
      try {
        run(task, &more);
        lock.lock();
      } catch (...) {
        lock.lock();
        failure_ = std::current_exception();
      }
      for (const Task& next : more) tasks_.push_back(next);
      --busy_;
      wake_.notify_all();
    }
  }

  void run(Task& task, std::vector<Task>* more) {
    task.chunk->nodes.emplace_back();
    make_node(task.split, 0, 1, task.chunk, more);
  }

  // The up to four ranges that a node over a range holds: the widest is split as long as there is room.
  std::uint32_t open(Split& split, Split children[4]) {
    try_split(refs_.data(), &split);
    if (split.leaf) {
      children[0] = split;
      return 1;
    }
    children[0].whole = split.low;
    children[1].whole = split.high;
    std::uint32_t count = 2;
    while (count < 4) {
      int widest = -1;
      for (std::uint32_t k = 0; k < count; ++k) {
        if (children[k].leaf || children[k].whole.count <= 1) continue;
        if (widest < 0 || children[k].whole.box.half_area() > children[widest].whole.box.half_area())
          widest = static_cast<int>(k);
      }
      if (widest < 0) break;
      try_split(refs_.data(), &children[widest]);
      if (children[widest].leaf) continue;
      const Split opened = children[widest];
      children[widest] = Split();
      children[widest].whole = opened.low;
      children[count++].whole = opened.high;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      if (children[k].whole.count <= kLeafPrimitives) try_split(refs_.data(), &children[k]);
    }
    return count;
  }

  // Fills node `at` of a chunk, and all below it but what are tasks. Returns the stack entries that walking it can
  // need; without those of tasks, which append() adds.
  std::uint32_t make_node(Split& split, std::size_t at, std::uint32_t depth, Chunk* chunk, std::vector<Task>* more) {
    chunk->depth = std::max(chunk->depth, depth);
    Split children[4];
    const std::uint32_t count = open(split, children);
    ClrayNode node;
    std::size_t inner[4] = {};
    const bool tasks = split.whole.count > kOwnTask;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const BoxRange& child = children[k].whole;
      const Bounds box = k < count ? child.box : Bounds();
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[2 * axis][k] = box.low[axis];
        node.bounds[2 * axis + 1][k] = box.high[axis];
      }
      node.child[k] = CLRAY_NO_CHILD;
      if (k >= count) continue;
      if (children[k].leaf) {
        node.child[k] = node_child(child.first, child.count);
      } else if (tasks) {
        chunk->child[k] = std::make_unique<Chunk>();
        more->push_back({children[k], chunk->child[k].get()});
      } else {
        inner[k] = chunk->nodes.size();
        node.child[k] = node_child(static_cast<std::uint32_t>(inner[k]), 0);
        chunk->nodes.emplace_back();
      }
    }
    chunk->nodes[at] = node;
    std::uint32_t needed = count;
    for (std::uint32_t k = 0; k < count; ++k) {
      if (inner[k] != 0)
        needed = std::max(needed, count - 1 + make_node(children[k], inner[k], depth + 1, chunk, more));
    }
    if (at == 0) chunk->stack_needed = needed;
    return needed;
  }

  static void count_nodes(const Chunk& chunk, std::size_t* nodes) {
    *nodes += chunk.nodes.size();
    for (const auto& child : chunk.child) {
      if (child) count_nodes(*child, nodes);
    }
  }

  // Appends the nodes of a chunk and of those below it; frees them. `above`: levels above the chunk. Returns the stack
  // entries that walking it can need.
  std::uint32_t append(std::unique_ptr<Chunk> chunk, std::uint32_t above) {
    const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.depth = std::max(tree_.depth, above + chunk->depth);
    append_nodes(chunk->nodes, 0, first, &tree_.nodes);
    chunk->nodes = {};
    std::uint32_t needed = chunk->stack_needed, count = 0;
    for (const std::uint32_t child : tree_.nodes[first].child) count += child != CLRAY_NO_CHILD;
    for (const auto& child : chunk->child) count += child != nullptr;
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (!chunk->child[k]) continue;
      tree_.nodes[first].child[k] = node_child(static_cast<std::uint32_t>(tree_.nodes.size()), 0);
      needed = std::max(needed, count - 1 + append(std::move(chunk->child[k]), above + 1));
    }
    if (above == 0) tree_.stack_needed = needed;
    return needed;
  }

 public:
  static void append_nodes(const std::vector<ClrayNode>& from, std::uint32_t first_leaf, std::uint32_t first_node,
                           std::vector<ClrayNode>* to) {
    for (ClrayNode node : from) {
      for (std::uint32_t& child : node.child) {
        if (child == CLRAY_NO_CHILD) continue;
        const std::uint32_t count = child_count(child);
        child = node_child(child_index(child) + (count != 0 ? first_leaf : first_node), count);
      }
      to->push_back(node);
    }
  }

 private:
  unsigned threads_;
  std::vector<Ref> refs_;
  BoxRange root_;
  LinearBvh tree_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  unsigned busy_ = 0;
  std::exception_ptr failure_;
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

LinearBvh build_bvh(std::size_t count, const std::function<Box(std::size_t)>& box_of, unsigned threads) {
  return Builder(count, box_of, threads).build();
}

LinearBvh build_bvh(const std::vector<Box>& boxes, unsigned threads) {
  return build_bvh(
      boxes.size(), [&](std::size_t i) { return boxes[i]; }, threads);
}

void append_tree(LinearBvh tree, std::uint32_t first_leaf, std::vector<ClrayNode>* nodes) {
  if (nodes->empty() && first_leaf == 0) {
    *nodes = std::move(tree.nodes);
    return;
  }
  Builder::append_nodes(tree.nodes, first_leaf, static_cast<std::uint32_t>(nodes->size()), nodes);
}

}  // namespace clray
