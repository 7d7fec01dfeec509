// SPDX-License-Identifier: Apache-2.0
// A pass whose visibility is solved, not sampled (docs/exact.md): the host cuts the beams into tiles, devices find the
// visible part of every face in every tile, and each detector's room makes its sums from them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "clray/device.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// One program and its buffers on every opened device.
class ExactPass {
 public:
  ExactPass(Device& device, const PassPlan& plan, const Geometry& geometry);
  ~ExactPass();

  /// Solves every view and gives *sums what the detectors make of them. `keep_going` is asked with the share done; when
  /// it says no, returns false and *sums is of no use.
  bool run(Sums* sums, const std::function<bool(double)>& keep_going);

  /// Seconds spent building programs.
  double compile_seconds() const { return compile_seconds_; }

 private:
  const PassPlan& plan_;
  const Geometry& geometry_;
  struct Parts;
  std::unique_ptr<Parts> parts_;
  double compile_seconds_ = 0.0;
};

}  // namespace clray
