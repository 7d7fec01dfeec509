// SPDX-License-Identifier: Apache-2.0
// SIGINT, SIGTERM and SIGHUP, which belong to the program and never to the library. They are blocked in all threads and
// taken in one. So they interrupt no system call, and programs that drivers start inherit the block: Ctrl-C in a
// terminal goes to all of them, and a linker that dies of it would take clray with it.
#pragma once

#include <signal.h>

#include <atomic>
#include <thread>

namespace clray::cli {

/// Made before the first thread. The first signal ends the process at once while nothing is finished that could be
/// saved; afterwards it asks for an early end, and the second one ends at once. Temporary files are removed each time.
/// Signals that were ignored when the program started (nohup, a shell's background job) stay so.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// Set by the first signal.
  const std::atomic<bool>& stop() const { return stop_; }
  /// The first signal, or 0.
  int taken() const { return taken_; }
  /// From now on an early end has something to save.
  void keep_what_is_finished() { patient_ = true; }
  /// Does not return if the process is about to end: what fails meanwhile is no fault.
  void wait_if_ending() const;

 private:
  void take_signals();
  [[noreturn]] void end(int signal);

  sigset_t all_{}, ignored_{};
  std::thread thread_;
  std::atomic<bool> stop_{false}, patient_{false}, ending_{false}, over_{false};
  std::atomic<int> taken_{0};
};

}  // namespace clray::cli
