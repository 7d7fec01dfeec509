// SPDX-License-Identifier: Apache-2.0
// Points of a pass whose clean tiles are solved and whose others are sampled (docs/exact.md): so many points are as
// many tiles that are sampled, each by one point of every replicate.
#pragma once

#include <memory>

#include "clray/device.hpp"
#include "pipeline/pass_runner.hpp"

namespace clray {

class TilesRunner : public PointRunner {
 public:
  TilesRunner(Device& device, const PassPlan& plan, const Geometry& geometry);
  ~TilesRunner() override;

  /// Gives *sums the sums of the step's views on so many tiles each. Nothing is added to what was there: more points
  /// are other tiles.
  bool run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
           const Checkpoint& checkpoint) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace clray
