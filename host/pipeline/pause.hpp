// SPDX-License-Identifier: Apache-2.0
// Long work on the host calls a Pause often: now and then that asks whether to go on.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "pipeline/clock.hpp"

namespace clray {

class Pause {
 public:
  /// Thrown where the answer is no.
  struct Stopped {};

  explicit Pause(std::function<bool()> keep_going) : keep_going_(std::move(keep_going)) {}

  /// For work of less than a millisecond.
  void operator()() {
    if (++calls_ % 64 == 0) ask();
  }
  /// For longer work.
  void ask() {
    if (now() - asked_s_ < 0.02) return;
    asked_s_ = now();
    if (!keep_going_()) throw Stopped();
  }

 private:
  std::function<bool()> keep_going_;
  std::uint64_t calls_ = 0;
  double asked_s_ = now();
};

}  // namespace clray
