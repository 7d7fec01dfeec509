// SPDX-License-Identifier: Apache-2.0
// Takes a pass along the courses of its views (docs/physics.md, section 6, "Stopping"). Every view has a course of its
// own: it stops where its own totals are good, so its result does not depend on the other views. Views whose courses
// ask for the same points are traced together.
#pragma once

#include <functional>

#include "body/geometry.hpp"
#include "clray/trace.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/run_saver.hpp"

namespace clray {

/// Traces a pass until the options say stop, or takes a share of it, going on from what the saver has. `runner` is
/// called once, and only where something is to be traced. `time_left_s`: of the run's time limit; 0: there is none.
/// Throws Error(usage) for more rays than can be numbered, Error(device).
PassOutcome drive_pass(const Geometry& geometry, const PassPlan& plan, const std::function<PointRunner&()>& runner,
                       const TraceOptions& options, const TraceHooks& hooks, RunSaver& saver, double time_left_s);

/// Solves an exact pass: there is one step, and it ends whole or, where time or an interrupt ends it, without sums.
PassOutcome solve_pass(const PassPlan& plan, const std::function<PointRunner&()>& make, const TraceOptions& options,
                       const TraceHooks& hooks, RunSaver& saver, double time_left_s);

}  // namespace clray
