// SPDX-License-Identifier: Apache-2.0
// Runs a pass on the devices: launches of bounded time, sums drained into 128 bits on the host. Knows nothing of what
// the sums mean.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "clray/device.hpp"
#include "pipeline/course.hpp"
#include "pipeline/crew.hpp"
#include "pipeline/device_team.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/saved_sums.hpp"

namespace clray {

/// When a step stops for a moment, so that what it has found can be saved.
struct Checkpoint {
  double every_s = 0.0;        ///< 0: never
  std::function<bool()> due;   ///< asked where step->more could hold all that is done
  std::function<void()> save;  ///< called when it does
};

/// Finds the sums of points.
class PointRunner {
 public:
  virtual ~PointRunner() = default;

  /// Brings *sums from step->from to step->points points of the step's epoch, for its views (ascending), going on where
  /// step->done says. `keep_going` is asked now and then with the share done. When it says no, returns false: *sums is
  /// as it was, and *step has what was done, or the part of it that was last saved.
  virtual bool run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                   const Checkpoint& checkpoint) = 0;

  /// Seconds spent building programs.
  double compile_seconds() const { return compile_seconds_; }

 protected:
  double compile_seconds_ = 0.0;
};

/// Traces points as rays: one program and its buffers on every opened device, of other processes, too. Goes on with the
/// plan's lasting program before rays take longer without it than it takes to build.
class PassRunner : public PointRunner {
 public:
  /// Takes what suits the plan from *kept, and leaves there what the next runner may take.
  PassRunner(Device& device, PassPlan& plan, const Geometry& geometry, const TraceOptions& options, KeptPass* kept,
             const SharedPass& shared = {});
  ~PassRunner() override;

  /// Adds the points that are missing.
  bool run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
           const Checkpoint& checkpoint) override;

 private:
  void drain(Sums* sums);
  void drain_into(OpenStep* step, std::uint64_t done);
  void forget();
  void build();
  /// Whether rays of a step are likely to take longer with the plan's first program than its lasting one to build.
  bool is_long(const OpenStep& step) const;
  bool run_block(const OpenStep& step, std::uint32_t first_point, std::uint32_t points,
                 const std::function<bool(double)>& keep_going);

  Device& device_;
  PassPlan& plan_;
  const Geometry& geometry_;
  const TraceOptions& options_;
  KeptPass* const kept_;
  std::unique_ptr<DeviceTeam> devices_;
  const SharedPass shared_;
  double points_traced_ = 0.0, seconds_ = 0.0;  // of all views, with the program that the plan begins with
  std::uint64_t block_points_ = kFirstPoints;   // of the next block, where sums are saved
};

}  // namespace clray
