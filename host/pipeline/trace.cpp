// SPDX-License-Identifier: Apache-2.0
// The call that traces a scene: geometry, passes, and the result.
#include "clray/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/geometry.hpp"
#include "clray/error.hpp"
#include "clray/pass.hpp"
#include "clray/result.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/exact_pass.hpp"
#include "pipeline/method.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_driver.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/tiles_runner.hpp"
#include "pipeline/warnings.hpp"
#include "text/hash.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

void check_diagnostics(const Result& result, bool allowed) {
  const Diagnostics& d = result.diagnostics;
  if (d.non_finite + d.stack_overflow + d.accumulator_overflow == 0 || allowed) return;
  throw Error(ErrorCode::bug,
              fmt::format("the result is not sound: {} not finite, {}, {}", text::counted(d.non_finite, "weight"),
                          text::counted(d.stack_overflow, "stack overflow"),
                          text::counted(d.accumulator_overflow, "accumulator overflow")));
}

void add_unique(const std::vector<std::string>& from, std::vector<std::string>* to) {
  for (const std::string& line : from) {
    if (std::find(to->begin(), to->end(), line) == to->end()) to->push_back(line);
  }
}

/// The body, with trees only where a pass has rays, and what the passes are for.
Geometry geometry_of(const Scene& scene, std::vector<PassRequest>* requests) {
  Geometry geometry = build_geometry(scene, !may_need_no_rays(scene));
  *requests = pass_requests(scene, geometry);
  const bool rays =
      std::any_of(requests->begin(), requests->end(), [](const PassRequest& r) { return !r.without_rays(); });
  return rays && !geometry.trees ? build_geometry(scene) : geometry;
}

/// Solves a pass. Adds to the seconds spent compiling and tracing.
PassOutcome solved(const Scene& scene, Device& device, const PassPlan& plan, const Geometry& geometry,
                   const TraceHooks& hooks, double time_left_s, double* compiling, double* tracing) {
  ExactPass pass(device, plan, geometry);
  *compiling += pass.compile_seconds();
  const double begin = now();
  PassOutcome outcome = solve_pass(pass, scene.trace, hooks, time_left_s);
  *tracing += now() - begin;
  return outcome;
}

/// Takes a pass along its course. Adds to the seconds spent compiling and tracing.
PassOutcome driven(const Scene& scene, const PassPlan& plan, const Geometry& geometry, PointRunner& runner,
                   const TraceHooks& hooks, double time_left_s, double* compiling, double* tracing) {
  *compiling += runner.compile_seconds();
  const double begin = now();
  PassOutcome outcome = drive_pass(geometry, plan, runner, scene.trace, hooks, time_left_s);
  *tracing += now() - begin;
  return outcome;
}

/// Traces or solves a pass, or solves its first bounce and traces the rest. Adds to the seconds spent compiling and
/// tracing.
PassOutcome outcome_of(const Scene& scene, Device& device, const PassPlan& plan, const Geometry& geometry,
                       const TraceHooks& hooks, double time_left_s, double* compiling, double* tracing) {
  if (plan.request.exact()) return solved(scene, device, plan, geometry, hooks, time_left_s, compiling, tracing);
  if (plan.request.tiles()) {
    TilesRunner runner(device, plan, geometry);
    return driven(scene, plan, geometry, runner, hooks, time_left_s, compiling, tracing);
  }
  double solving = 0.0;
  if (plan.first) {
    PassOutcome first = solved(scene, device, plan.first->plan, geometry, hooks, time_left_s, compiling, &solving);
    *tracing += solving;
    if (first.sums.empty()) return first;
    plan.first->sums = std::move(first.sums);
    if (time_left_s > 0.0) time_left_s = std::max(1e-6, time_left_s - solving);
  }
  PassRunner runner(device, plan, geometry, scene.trace);
  PassOutcome outcome = driven(scene, plan, geometry, runner, hooks, time_left_s, compiling, tracing);
  for (ErrorPoint& point : outcome.errors) point.seconds += solving;
  return outcome;
}

}  // namespace

Result trace(const Scene& scene, Device& device, const TraceHooks& hooks) {
  check_scene(scene);
  Result result;
  result.instants = pass_instants(scene);
  const DeviceUse use(device);
  const double start = now();
  result.device = device.info();
  result.seed = scene.trace.seed;
  result.replicates = scene.trace.replicates;
  std::vector<PassRequest> requests;
  const Geometry geometry = geometry_of(scene, &requests);
  result.mesh = geometry.report;
  result.extent_m = geometry.extent;
  std::vector<PassPlan> plans = plan_passes(scene, geometry, std::move(requests));
  fit_to(device, &plans);
  result.seconds.bvh = now() - start;
  result.digest = kFnvStart;
  bool target_reached = true;
  double spent = 0.0;
  Ending ending;
  LitRecords lit;
  for (const PassPlan& plan : plans) {
    const double left = scene.trace.time_limit_s > 0.0 ? std::max(1e-6, scene.trace.time_limit_s - spent) : 0.0;
    const PassOutcome outcome = outcome_of(scene, device, plan, geometry, hooks, left, &result.seconds.compile, &spent);
    if (outcome.sums.empty()) {
      result.partial = true;
      result.warnings.push_back("stopped before the first result");
      continue;
    }
    result.partial = result.partial || outcome.partial;
    result.target_asked = result.target_asked || outcome.target_asked;
    if (outcome.target_asked) {
      // The result's ending is that of the first pass that missed the target, else of the one with the largest error.
      if (target_reached && (!outcome.target_reached || !(outcome.ending.half_width <= ending.half_width)))
        ending = outcome.ending;
      target_reached = target_reached && outcome.target_reached;
    } else if (!result.target_asked) {
      ending = outcome.ending;
    }
    const PictureSize& size = plan.request.picture;
    const std::uint64_t per_point =
        plan.request.replicates * (plan.request.pixels ? static_cast<std::uint64_t>(size.width) * size.height : 1);
    const std::vector<std::uint64_t>& points = outcome.sums.points;
    if (result.rays == 0 && !plan.request.exact())
      result.rays = *std::max_element(points.begin(), points.end()) * per_point;
    result.rays_total += outcome.rays_total;
    result.digest = digest_of(result.digest, plan, outcome.sums);
    result.errors.insert(result.errors.end(), outcome.errors.begin(), outcome.errors.end());
    add_unique(plan.program.kept, &result.kept);
    add_unique(plan.program.left_out, &result.left_out);
    add_results(scene, plan, outcome, &result, &lit);
    add_unique(doubtful_claims(plan, geometry, outcome.sums), &result.warnings);
  }
  result.target_reached = result.target_asked && target_reached && !result.partial;
  if (result.target_asked) result.target_percent = scene.trace.target_error_percent;
  result.reached_percent = 100.0 * ending.half_width;
  result.stopped_by = ending.by;
  result.seconds.trace = spent;
  result.seconds.total = now() - start;
  check_diagnostics(result, scene.trace.allow_failures);
  order_results(scene, &result);
  if (geometry.conflicts != 0)
    result.warnings.push_back(fmt::format(
        "faces of different materials overlap in one plane and look the same way ({}): the first in canonical "
        "order is hit; remove the others",
        text::counted(geometry.conflicts, "face")));
  std::vector<std::string> early = std::move(result.warnings);
  add_warnings(scene, ending, lit, &result);
  result.warnings.insert(result.warnings.end(), early.begin(), early.end());
  add_unique(pass_warnings(scene), &result.warnings);
  return result;
}

std::string kernel_source(const Scene& scene, Device& device) {
  check_scene(scene);
  const DeviceUse use(device);
  const Geometry geometry = build_geometry(scene);
  std::vector<PassPlan> plans = plan_passes(scene, geometry);
  fit_to(device, &plans);
  return program_source(device.impl().devices.front(), plans.front().program.entry, plans.front().program.options);
}

}  // namespace clray
