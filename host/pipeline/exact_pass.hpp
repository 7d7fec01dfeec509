// SPDX-License-Identifier: Apache-2.0
// A pass whose visibility is solved, not sampled (docs/exact.md): the host cuts the beams into tiles, devices find the
// visible part of every face in every tile, and each detector's room makes its sums from them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "clray/device.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// One program and its buffers on every opened device.
class ExactPass : public PointRunner {
 public:
  ExactPass(Device& device, const PassPlan& plan, const Geometry& geometry);
  ~ExactPass() override;

  /// Solves views step->from to step->points - 1, going on where step->done says, and gives *sums what the detectors
  /// make of them. `keep_going` is asked with the share done. When it says no, returns false: *sums is of no use, and
  /// *step has what was last saved.
  bool run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
           const Checkpoint& checkpoint) override;

 private:
  void add_bins(Sums* sums) const;

  const PassPlan& plan_;
  const Geometry& geometry_;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace clray
