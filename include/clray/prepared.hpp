// SPDX-License-Identifier: Apache-2.0
// A scene prepared for many traces: the body, the programs and what devices hold of them stay, while suns, observers,
// attitudes, surfaces and options change from call to call.
#pragma once

#include <memory>
#include <vector>

#include "clray/export.hpp"
#include "clray/result.hpp"
#include "clray/scene.hpp"
#include "clray/trace.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Keeps what a trace needs and no view changes. Every trace gives the same bits as trace() of the same scene.
///
/// Threads: one Prepared serves one thread at a time. Any number of them may share a Device, whose calls wait for each
/// other. The Device must outlive them.
class Prepared {
 public:
  /// Checks the scene, builds its body and its programs, and copies them to the device. Throws Error(input, device).
  Prepared(const Scene& scene, Device& device);
  ~Prepared();
  /// Moves what is kept; the other may then be assigned to or destroyed.
  Prepared(Prepared&&) noexcept;
  /// Frees what was kept here and moves.
  Prepared& operator=(Prepared&&) noexcept;

  /// The scene that it was made of.
  const Scene& scene() const;

  /// Traces that scene. Throws as clray::trace() does.
  Result trace(const TraceHooks& hooks = {});

  /// The same from other views (see Scene::views), all in one call.
  Result trace(const std::vector<Orientation>& views, const TraceHooks& hooks = {});

  /// Traces another scene. Whatever differs from the scene before is made anew: a changed component costs a new body,
  /// and options that need another program cost its build; suns, observers, motions, angles of hinges and parameters of
  /// materials cost neither. Meshes are compared by their address: give a changed mesh a new one.
  Result trace(const Scene& scene, const TraceHooks& hooks = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace clray
CLRAY_API_END
