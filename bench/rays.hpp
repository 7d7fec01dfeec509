// SPDX-License-Identifier: Apache-2.0
// What clray-bench rays measures, and its rival on Embree. A path is a primary ray and all that follow it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "support/scenes.hpp"

namespace clray_bench {

/// Kinds of paths: rays of a beam that hit or miss; those and a shadow ray from each hit toward an observer elsewhere;
/// up to four bounces off Lambert surfaces of albedo 0.5, with shadow rays from the second on.
enum class PathKind { beam, bistatic, bounces };

/// Who lights and who looks, m.
struct PathViews {
  clray::Vec3 light, observer;
};

/// What a run of a rival took, and what it met.
struct PathRun {
  double seconds = 0.0;
  std::uint64_t paths = 0, rays = 0, hits = 0;  ///< hits of primary rays
};

/// A tracer of bare rays on Embree: no light is added up.
class PathRival {
 public:
  virtual ~PathRival() = default;
  /// Points of a jittered grid in blocks of 4 x 4, a block a packet, or (`single`) random points, a ray at a time.
  virtual PathRun run(PathKind kind, bool single, int log2_paths) const = 0;
  /// Seconds of its tree, of medium quality.
  virtual double build_s() const = 0;
};

/// None where clray-bench was built without Embree. `robust`: no ray slips between triangles, as in clray.
std::unique_ptr<PathRival> path_rival(const clray::Mesh& mesh, const PathViews& views, bool robust, unsigned threads);

}  // namespace clray_bench
