// SPDX-License-Identifier: Apache-2.0
// How a scene is traced: how many rays, when to stop, with which samples; and the call that does it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "clray/export.hpp"

CLRAY_API_BEGIN
namespace clray {

struct Scene;
struct Result;
class Device;

/// How numbers are found (docs/exact.md). Exact: visibility is solved; tiles: it is solved where one face covers a tile
/// of the beam, and sampled in other tiles until the error is what was asked for; points: rays sample it; automatic:
/// exact where the scene allows it and no rays are given, and tiles where they reach a target sooner.
enum class Method { automatic, exact, tiles, points };

/// How rays of a beam are spread (docs/sampling.md): plain random points on the rectangle that bounds the body, Sobol
/// points on it, or Sobol points on strata of silhouette, delays and peaks. Pictures take the first two alone.
enum class SamplerKind { random, sobol, strata };

/// When to stop and how to sample; `clray --list trace` has the ranges. Rays, target or time end the run, whichever
/// comes first. Without any of them it goes to 1 %, with at least 2^22 rays over all orientations together.
struct TraceOptions {
  int max_bounces = 1;                  ///< surface interactions
  Method method = Method::automatic;    ///< how numbers are found
  std::uint64_t rays = 0;               ///< primary rays per orientation, rounded up to 16·2^k; 0: not given
  double target_error_percent = 0.0;    ///< 95 % half-width over the value; 0: not given
  double time_limit_s = 0.0;            ///< of tracing; 0: none
  std::uint64_t max_rays = 1ull << 32;  ///< where a search for a target gives up
  std::uint64_t seed = 1;               ///< of all random numbers
  int replicates = 16;                  ///< independent replicates (the error's degrees of freedom + 1)
  std::string walk = "auto";  ///< through the BVH: auto, or a row of walk.def; results have the same bits under each
  SamplerKind sampler = SamplerKind::strata;  ///< how rays are spread
  bool specialise = true;                     ///< false: the generic program (same digest, slower)
  bool force_bistatic = false;                ///< shadow rays even where the observer is at the source
  bool allow_failures = false;                ///< report non-finite weights and overflows instead of throwing
  // For tests of identity; no result depends on them.
  std::uint32_t work_group_size = 64;  ///< work-items
  std::uint64_t slice_points = 0;      ///< points per replicate and launch; 0: sized to slices of at most 0.3 s
};

/// Where a run stands; passed to the progress callback a few times a second.
struct Progress {
  const char* phase = "";       ///< "search", "confirm", "trace", "pictures"
  double fraction = 0.0;        ///< of this phase, estimated, in [0,1]
  std::uint64_t rays = 0;       ///< per orientation, so far
  double rays_per_s = 0.0;      ///< of all orientations together
  double relative_error = 0.0;  ///< 95 % half-width over the value; NaN while unknown
  double seconds_left = 0.0;    ///< NaN while unknown
  bool keeps = false;           ///< something is finished: an early end would have a result
};

/// Callbacks of a run. Both may be empty.
struct TraceHooks {
  std::function<void(const Progress&)>
      progress;  ///< from threads of the run, one call at a time; what it throws ends the run
  const std::atomic<bool>* stop = nullptr;  ///< set it to end early with what is finished
};

/// Traces `scene` on `device` until its options say stop. Throws Error(input, device).
/// An early end (time, stop) is no error: the result says `partial`.
Result trace(const Scene& scene, Device& device, const TraceHooks& hooks = {});

/// The OpenCL C source that `trace` would build for the scene's main pass, flattened and with its options.
std::string kernel_source(const Scene& scene, Device& device);

}  // namespace clray
CLRAY_API_END
