// SPDX-License-Identifier: Apache-2.0
// What of a scene stays from one trace to the next: the body, which no view, light or surface changes, and the passes
// on the devices with what they hold of it. Whatever differs is made anew, so that a trace gives the same bits with a
// preparation of any scene as without one.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "body/geometry.hpp"
#include "clray/device.hpp"
#include "clray/scene.hpp"
#include "pipeline/pass_runner.hpp"

namespace clray {

class Preparation {
 public:
  /// For tracing on that device, and no other; `used_again`: more than once.
  explicit Preparation(Device& device, bool used_again = false) : device_(device), used_again_(used_again) {}

  Device& device() const { return device_; }
  bool used_again() const { return used_again_; }

  /// The body of a scene, with trees or without: the kept one, or, where it is another, a new one.
  const Geometry& body(const Scene& scene, bool trees);

  /// What was kept of the scene's pass of this number.
  KeptPass* pass(std::size_t number);

  /// Forgets the passes, as after an error that leaves their sums unknown.
  void drop_passes() { passes_.clear(); }

 private:
  /// All that a geometry is made of.
  struct Kept {
    std::vector<Component> components;
    std::vector<std::uint32_t> material_ranks;
    Geometry geometry;
  };

  Device& device_;
  const bool used_again_;
  std::optional<Kept> with_trees_, without_;
  const Geometry* on_devices_ = nullptr;  // that the passes hold
  std::vector<KeptPass> passes_;
};

/// What is known of a scene before the first ray.
struct Planned {
  const Geometry& geometry;
  std::vector<PassPlan> plans;
};

/// The body, with trees only where a pass has rays, and the plans of its passes.
Planned plan_scene(Preparation& kept, const Scene& scene);

}  // namespace clray
