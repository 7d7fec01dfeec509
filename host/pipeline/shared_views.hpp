// SPDX-License-Identifier: Apache-2.0
// Runs passes that take views as a whole (tiles, exact) with all processes of a run: each does some of the views.
#pragma once

#include <memory>

#include "pipeline/crew.hpp"
#include "pipeline/pass_runner.hpp"

namespace clray {

/// `own` does this process's share.
class SharedViews : public PointRunner {
 public:
  SharedViews(std::unique_ptr<PointRunner> own, const PassPlan& plan, const SharedPass& shared);

  bool run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
           const Checkpoint& checkpoint) override;

 private:
  bool run_round(const CrewTask& task, Sums* found, const std::function<bool(double)>& keep_going);

  std::unique_ptr<PointRunner> own_;
  const PassPlan& plan_;
  const SharedPass shared_;
  std::uint64_t round_;  // views of the next round, where sums are saved
};

}  // namespace clray
