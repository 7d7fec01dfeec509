// SPDX-License-Identifier: Apache-2.0
// A process that helps with a run (crew.hpp): it does the ranges that rank 0 gives it, on devices of its own, and hands
// over the sums when it is asked for them.
#pragma once

#include <vector>

#include "body/geometry.hpp"
#include "clray/device.hpp"
#include "clray/ranks.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// Helps until rank 0 says that the run is over. `passes`: by their numbers. What fails here is told to rank 0.
void help_with_run(Ranks& ranks, Device& device, const std::vector<const PassPlan*>& passes, const Geometry& geometry,
                   const TraceOptions& options);

}  // namespace clray
