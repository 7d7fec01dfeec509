// SPDX-License-Identifier: Apache-2.0
// Runs a pass on the devices: launches of bounded time, sums drained into 128 bits on the host. Knows nothing of what
// the sums mean.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "clray/device.hpp"
#include "pipeline/plan.hpp"

namespace clray {

class DevicePass;

/// Finds the sums of points.
class PointRunner {
 public:
  virtual ~PointRunner() = default;

  /// Brings *sums to `points` of epoch `epoch` for `views` (ascending), which have as many so far, all of them.
  /// `keep_going` is asked now and then with the share done; when it says no, returns false and *sums is as it was.
  virtual bool run(Sums* sums, const std::vector<std::uint32_t>& views, std::uint64_t points, std::uint32_t epoch,
                   const std::function<bool(double)>& keep_going) = 0;

  /// Seconds spent building programs.
  double compile_seconds() const { return compile_seconds_; }

 protected:
  double compile_seconds_ = 0.0;
};

/// Device passes that stay when their runner goes, for the next one of the same body.
using KeptPass = std::vector<std::shared_ptr<DevicePass>>;

/// Traces points as rays: one program and its buffers on every opened device.
class PassRunner : public PointRunner {
 public:
  /// Takes what suits the plan from *kept, and leaves there what the next runner may take.
  PassRunner(Device& device, const PassPlan& plan, const Geometry& geometry, const TraceOptions& options,
             KeptPass* kept);
  ~PassRunner() override;

  /// Adds the points that are missing.
  bool run(Sums* sums, const std::vector<std::uint32_t>& views, std::uint64_t points, std::uint32_t epoch,
           const std::function<bool(double)>& keep_going) override;

 private:
  void drain(Sums* sums);
  bool run_block(std::size_t views, std::uint32_t first_point, std::uint32_t points,
                 const std::function<bool(double)>& keep_going);

  const PassPlan& plan_;
  const TraceOptions& options_;
  KeptPass devices_;
};

}  // namespace clray
