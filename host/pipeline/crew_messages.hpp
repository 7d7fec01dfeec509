// SPDX-License-Identifier: Apache-2.0
// What the processes of a run tell each other (crew.hpp): a letter, the number of the task that it belongs to, and what
// stands with the letter below. Tasks are numbered in their order; what belongs to an older one is not looked at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/device_pass.hpp"
#include "pipeline/saved_sums.hpp"
#include "pipeline/work_source.hpp"
#include "text/bytes.hpp"

namespace clray {

/// From rank 0: a task; a range of it, empty where nothing is left; hand over what was found; forget it; the run is
/// over. To rank 0: fingerprints of the passes; asking for so many items; the task's ranges are done; sums; what
/// failed.
enum class CrewWord : char {
  task = 'j',
  range = 'r',
  hand_over = 'h',
  forget = 'x',
  over = 'q',
  present = 'p',
  ask = 'a',
  done = 'd',
  sums = 's',
  failed = 'e'
};

/// What is shared: the work-items of a block of points or, where a pass takes views as a whole, the views of a step.
struct CrewTask {
  std::uint32_t pass = 0;  ///< its number
  bool rays = true;        ///< work-items of `block`; else views of `step`
  OpenStep step;
  PointBlock block;
  std::uint64_t items = 0;
};

struct CrewMessage {
  CrewWord word;
  std::uint64_t task = 0;
  std::string rest;
};

inline std::string to_bytes(CrewWord word, std::uint64_t task, const std::string& rest = {}) {
  text::BytesWriter out;
  out.number(static_cast<std::uint64_t>(word), 1);
  out.number(task);
  return out.bytes() + rest;
}

inline CrewMessage message_of(const std::string& bytes) {
  text::BytesReader in(bytes, "a message between ranks");
  const auto word = static_cast<CrewWord>(in.number(1));
  const std::uint64_t task = in.number();
  return {word, task, std::string(in.take(in.left()))};
}

inline std::string to_bytes(const CrewTask& task) {
  text::BytesWriter out;
  out.number(task.pass, 4);
  out.number(task.rays ? 1 : 0, 1);
  out.number(task.step.epoch, 4);
  out.number(task.step.from);
  out.number(task.step.points);
  out.numbers(task.step.views);
  for (const std::uint32_t n : {task.block.first, task.block.count, task.block.chunk, task.block.walk})
    out.number(n, 4);
  out.number(task.items);
  return out.bytes();
}

inline CrewTask task_of(const std::string& bytes) {
  text::BytesReader in(bytes, "a message between ranks");
  CrewTask task;
  task.pass = static_cast<std::uint32_t>(in.number(4));
  task.rays = in.number(1) != 0;
  task.step.epoch = static_cast<std::uint32_t>(in.number(4));
  task.step.from = in.number();
  task.step.points = in.number();
  task.step.views = in.numbers<std::uint32_t>();
  for (std::uint32_t* n : {&task.block.first, &task.block.count, &task.block.chunk, &task.block.walk})
    *n = static_cast<std::uint32_t>(in.number(4));
  task.items = in.number();
  return task;
}

inline std::string to_bytes(const WorkRange& range) {
  text::BytesWriter out;
  out.number(range.first);
  out.number(range.count);
  return out.bytes();
}

inline WorkRange range_of(const std::string& bytes) {
  text::BytesReader in(bytes, "a message between ranks");
  const std::uint64_t first = in.number();
  return {first, in.number()};
}

inline std::string to_bytes(const Sums& sums) {
  text::BytesWriter out;
  put(out, sums);
  return out.take();
}

inline Sums sums_of(const std::string& bytes) {
  text::BytesReader in(bytes, "a message between ranks");
  return get_sums(in);
}

/// The part of a step that a range of its views is. A step of an exact pass names its views by `from` and `points`.
inline OpenStep part_of(const OpenStep& step, const WorkRange& range) {
  OpenStep part;
  part.epoch = step.epoch;
  if (step.views.empty()) {
    part.from = step.from + range.first;
    part.points = part.from + range.count;
    return part;
  }
  part.from = step.from;
  part.points = step.points;
  const auto first = step.views.begin() + static_cast<std::ptrdiff_t>(range.first);
  part.views.assign(first, first + static_cast<std::ptrdiff_t>(range.count));
  return part;
}

/// How many views a step has.
inline std::uint64_t views_of(const OpenStep& step) {
  return step.views.empty() ? step.points - step.from : step.views.size();
}

/// Adds the sums of a range of views that nobody else has, and their points.
inline void add_views(const SumLayout& layout, const Sums& part, Sums* to) {
  to->add(layout, part);
  for (std::size_t v = 0; v < part.points.size(); ++v) {
    if (part.points[v] != 0) to->points[v] = part.points[v];
  }
}

}  // namespace clray
