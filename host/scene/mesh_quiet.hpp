// SPDX-License-Identifier: Apache-2.0
// The library never prints: OpenMesh's own complaints are silenced while it works; what matters is checked
// afterwards and thrown. Only for files of host/scene that use OpenMesh.
#pragma once

#include <OpenMesh/Core/System/omstream.hh>
#include <mutex>

namespace clray {

/// Silences OpenMesh's streams and serialises its use (its streams and readers are shared objects).
class QuietOpenMesh {
 public:
  QuietOpenMesh() : lock_(mutex()) {
    error_was_on_ = omerr().is_enabled();
    log_was_on_ = omlog().is_enabled();
    out_was_on_ = omout().is_enabled();
    omerr().disable();
    omlog().disable();
    omout().disable();
  }
  ~QuietOpenMesh() {
    if (error_was_on_) omerr().enable();
    if (log_was_on_) omlog().enable();
    if (out_was_on_) omout().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  bool error_was_on_, log_was_on_, out_was_on_;
};

}  // namespace clray
