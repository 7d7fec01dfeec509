// SPDX-License-Identifier: Apache-2.0
// Takes an exact pass to its end; see pass_driver.hpp.
#include <limits>

#include "pipeline/clock.hpp"
#include "pipeline/pass_driver.hpp"
#include "pipeline/shares.hpp"

namespace clray {

PassOutcome solve_pass(const PassPlan& plan, const std::function<PointRunner&()>& make, const TraceOptions& options,
                       const TraceHooks& hooks, RunSaver& saver, double time_left_s) {
  PassOutcome out;
  SavedPass& saved = saver.pass(plan);
  const char* stopped_by = "";
  double start = now();
  const auto tell = [&](double share, bool keeps) {
    if (!hooks.progress) return;
    Progress p;
    p.phase = "exact";
    p.fraction = share;
    p.relative_error = 0.0;
    p.seconds_left = share > 0.0 ? (now() - start) * (1.0 / share - 1.0) : std::numeric_limits<double>::quiet_NaN();
    p.keeps = keeps;
    hooks.progress(p);
  };
  const auto keep_going = [&](double share) {
    if (hooks.stop != nullptr && hooks.stop->load()) stopped_by = "interrupt";
    if (time_left_s > 0.0 && now() - start > time_left_s) stopped_by = "time limit";
    tell(share, false);
    return *stopped_by == '\0';
  };
  out.target_asked = options.target_error_percent > 0.0;
  if (!saved.complete) {
    OpenStep step = views_of_share(plan, saver.share());
    if (!saved.step.is_same(step)) saved.step = std::move(step);
    PointRunner& pass = make();
    start = now();
    saved.complete = pass.run(&saved.found, &saved.step, keep_going, saver.checkpoint());
    out.seconds = now() - start;
    if (!saved.complete) {
      saved.found = Sums();
      saver.save();
      out.partial = true;
      out.ending.by = stopped_by;
      return out;
    }
    saved.step = OpenStep();
    ErrorPoint point;
    point.phase = "exact";
    point.seconds = out.seconds;
    saved.errors = {point};
  }
  out.sums = saver.hand_over(plan, true);
  out.errors = saved.errors;
  tell(1.0, true);
  out.target_reached = out.target_asked;
  out.ending = {"exact", 0.0, 0};
  return out;
}

}  // namespace clray
