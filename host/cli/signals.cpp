// SPDX-License-Identifier: Apache-2.0
// See signals.hpp.
#include "signals.hpp"

#include <unistd.h>

#include <cstdio>

#include "text/temporaries.hpp"

namespace clray::cli {

namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

}  // namespace

Signals::Signals() {
  sigemptyset(&all_);
  sigemptyset(&ignored_);
  for (const int signal : kSignals) {
    sigaddset(&all_, signal);
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) sigaddset(&ignored_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &all_, nullptr);
  thread_ = std::thread([this] { take_signals(); });
}

Signals::~Signals() {
  wait_if_ending();
  over_ = true;
  for (const int signal : kSignals) pthread_kill(thread_.native_handle(), signal);
  thread_.join();
}

void Signals::take_signals() {
  // The driver's compiler puts handlers of its own in place of all, of ignored signals too. Blocked ones meet none.
  while (true) {
    int signal = 0;
    if (sigwait(&all_, &signal) != 0) continue;
    if (over_) return;
    if (sigismember(&ignored_, signal) == 1) continue;
    const bool second = taken_ != 0;
    if (!second) taken_ = signal;
    stop_ = true;
    if (second || !patient_) end(signal);
  }
}

void Signals::end(int signal) {
  ending_ = true;
  text::remove_temporaries_for_good();
  const char* const saved = patient_ ? "the result was not written" : "nothing was finished, so there is no result";
  std::fprintf(stderr, "%sclray: interrupted: %s\n", ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", saved);
  ::_exit(128 + signal);
}

void Signals::wait_if_ending() const {
  while (ending_) ::pause();
}

}  // namespace clray::cli
