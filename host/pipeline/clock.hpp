// SPDX-License-Identifier: Apache-2.0
// The clock that times of a run are taken from: it never goes back, and its zero has no meaning.
#pragma once

#include <chrono>

namespace clray {

/// Seconds.
inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace clray
