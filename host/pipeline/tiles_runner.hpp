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

  /// Gives *sums the sums of `views` on `points` tiles each. Nothing is added to what was there: more points are other
  /// tiles.
  bool run(Sums* sums, const std::vector<std::uint32_t>& views, std::uint64_t points, std::uint32_t epoch,
           const std::function<bool(double)>& keep_going) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace clray
