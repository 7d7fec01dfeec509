// SPDX-License-Identifier: Apache-2.0
// The call that traces a scene: geometry, passes, when each stops, and the result (docs/physics.md, section 6,
// "Stopping").
#include "clray/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "body/geometry.hpp"
#include "clray/error.hpp"
#include "clray/result.hpp"
#include "pipeline/course.hpp"
#include "pipeline/estimate.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/warnings.hpp"
#include "text/hash.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kLeastRays = 1u << 22;     // with no stopping option
constexpr std::uint64_t kZeroRays = 1u << 20;      // after which a zero total counts as zero
constexpr std::uint64_t kMostPoints = 1ull << 32;  // of a 32-bit Sobol sequence
constexpr double kDefaultTarget = 0.01;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t power_of_two_above(std::uint64_t value) {
  std::uint64_t p = 1;
  while (p < value) p *= 2;
  return p;
}

/// Points of each half of a picture's pixel.
std::uint64_t picture_points(const PassPlan& plan, const TraceOptions& options) {
  const PictureSize& size = plan.request.picture;
  double samples = 8.0;
  if (size.samples > 0) {
    samples = size.samples;
  } else if (options.rays != 0) {
    samples = static_cast<double>(options.rays) / (static_cast<double>(size.width) * size.height);
  } else if (options.target_error_percent > 0.0) {
    samples = 64.0;  // a picture's search for a target gives up there; `samples` or --rays ask for more
  }
  if (plan.request.mirrors) samples *= static_cast<double>(size.width) * size.height;  // as many rays, from the light
  return power_of_two_above(static_cast<std::uint64_t>(std::max(1.0, std::ceil(samples / plan.request.replicates))));
}

CourseRules rules_of(const PassPlan& plan, const TraceOptions& o) {
  const std::uint64_t replicates = plan.request.replicates;
  CourseRules rules;
  rules.target_asked = o.target_error_percent > 0.0;
  rules.target = o.target_error_percent / 100.0;
  rules.enough_points = (kZeroRays + replicates - 1) / replicates;
  // A pixel's half-difference has one degree of freedom; a picture's error is the mean over all pixels and has many.
  rules.t95 = plan.request.paints() ? 1.96 : student_t95(static_cast<int>(replicates) - 1);
  if (plan.request.paints()) {
    rules.fixed_points = picture_points(plan, o);
    rules.fixed_end = o.rays != 0 || !rules.target_asked ? "rays" : "samples";
    // Large cubes take longer to read than to trace. Without a target three doublings show how the error falls.
    rules.first_points = rules.target_asked ? 1 : std::max<std::uint64_t>(1, rules.fixed_points / 4);
    rules.enough_points = 0;
    rules.least_to_stop = 4;
  } else if (o.rays != 0) {
    rules.fixed_points = power_of_two_above((o.rays + replicates - 1) / replicates);
  } else if (!rules.target_asked && o.time_limit_s > 0.0) {
    rules.fixed_points = kMostPoints;
  } else {
    rules.most_points = std::clamp<std::uint64_t>(o.max_rays / replicates, 1, kMostPoints);
    if (!rules.target_asked) {
      rules.target = kDefaultTarget;
      rules.least_points = power_of_two_above(kLeastRays / replicates / plan.beams.views.size());
    }
  }
  if (rules.fixed_points > kMostPoints)
    throw Error(ErrorCode::usage, fmt::format("at most {} rays per orientation can be traced with {} replicates",
                                              kMostPoints * replicates, replicates));
  return rules;
}

/// The root mean square of the standard errors of all covered pixels, over their mean radiance; in a pass of mirrors,
/// of those that light reaches.
double picture_error(const PassPlan& plan, const Sums& sums) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(plan.request.picture.width) * plan.request.picture.height;
  const PassDetector& detector = *find_detector(plan, plan.request.pixels ? "pixels" : "caustics");
  const std::uint64_t radiance = plan.layout.blocks[detector.first_block].offset;
  const std::uint64_t covered = plan.layout.blocks[detector.first_block + 1].offset;
  const std::size_t lanes = plan.request.lanes.size();
  double squares = 0.0, mean = 0.0, count = 0.0;
  for (std::size_t row = 0; row < plan.beams.views.size() * lanes; ++row) {
    for (std::uint64_t p = 0; p < pixels; ++p) {
      const std::uint64_t at = radiance + 2 * row * pixels + p;
      const double a = static_cast<double>(sums.values[at]), b = static_cast<double>(sums.values[at + pixels]);
      if (plan.request.pixels ? sums.counts[covered + row / lanes * pixels + p] == 0 : a + b == 0.0) continue;
      mean += 0.5 * (a + b);
      squares += 0.25 * (a - b) * (a - b);
      count += 1.0;
    }
  }
  return mean > 0.0 ? std::sqrt(squares / count) / (mean / count) : kNan;
}

/// Takes a pass along its course, step by step.
class PassDriver {
 public:
  PassDriver(const Geometry& geometry, const PassPlan& plan, PassRunner& runner, const TraceOptions& options,
             const TraceHooks& hooks, double time_left_s)
      : geometry_(geometry),
        plan_(plan),
        runner_(runner),
        hooks_(hooks),
        course_(rules_of(plan, options)),
        start_(now()),
        time_left_s_(time_left_s) {}

  PassOutcome run() {
    while (const std::optional<CourseStep> step = course_.next()) take(*step);
    return answer();
  }

 private:
  void take(const CourseStep& step) {
    Sums& sums = step.confirms ? confirmed_ : searched_;
    double& seconds = step.confirms ? confirm_seconds_ : search_seconds_;
    if (!step.confirms || step.epoch != confirmed_epoch_) confirmed_ = Sums();  // the last one missed
    if (step.confirms && sums.points == 0) seconds = 0.0;
    if (step.confirms) confirmed_epoch_ = step.epoch;
    const double begin = now();
    const std::uint64_t from = sums.points;
    const auto ask = [&](double share) { return keep_going(step, share, from, seconds + now() - begin); };
    if (!runner_.run(&sums, step.points, step.epoch, ask)) return course_.cut(stopped_by_);
    seconds += now() - begin;
    course_.took(note(step, sums, seconds));
  }

  double note(const CourseStep& step, const Sums& sums, double seconds) {
    ErrorPoint point;
    point.phase = step.phase;
    point.rays = static_cast<std::uint64_t>(static_cast<double>(sums.points) * rays_per_point());
    point.seconds = seconds;
    if (plan_.request.paints()) {
      point.relative_standard_error = picture_error(plan_, sums);
    } else {
      largest_error(targets_of(plan_, geometry_, sums), static_cast<double>(sums.points), &point);
    }
    out_.errors.push_back(point);
    return point.relative_standard_error;
  }

  bool keep_going(const CourseStep& step, double share, std::uint64_t from, double seconds) {
    if (hooks_.stop != nullptr && hooks_.stop->load()) {
      stopped_by_ = "interrupt";
      return false;
    }
    if (time_left_s_ > 0.0 && now() - start_ > time_left_s_) {
      stopped_by_ = "time limit";
      return false;
    }
    if (hooks_.progress) {
      Progress p;
      p.phase = step.phase;
      const double points = static_cast<double>(from) + share * static_cast<double>(step.points - from);
      p.rays = static_cast<std::uint64_t>(points * rays_per_point());
      p.rays_per_s =
          static_cast<double>(p.rays) * static_cast<double>(plan_.beams.views.size()) / std::max(seconds, 1e-9);
      p.relative_error = course_.rules().t95 * course_.state().error;
      const double goal = goal_points(step);
      p.fraction = std::min(1.0, points / goal);
      p.seconds_left = points > 0.0 ? seconds * (goal / points - 1.0) : kNan;
      hooks_.progress(p);
    }
    return true;
  }

  /// The points at which this phase is likely to end, as the error falls at least as N^-1/2.
  double goal_points(const CourseStep& step) const {
    const CourseRules& rules = course_.rules();
    const std::uint64_t known = step.confirms ? course_.state().confirm_size : rules.fixed_points;
    double goal = static_cast<double>(std::max(step.points, known));
    const double error = course_.state().error;
    if (known == 0 && error > 0.0 && rules.target > 0.0) {
      const double ratio = rules.t95 * error / rules.target;
      goal = std::max(goal, static_cast<double>(step.points) / 2.0 * ratio * ratio);
    }
    return goal;
  }

  double rays_per_point() const {
    const PictureSize& size = plan_.request.picture;
    return plan_.request.pixels ? 2.0 * size.width * size.height : static_cast<double>(plan_.request.replicates);
  }

  PassOutcome answer() {
    const CourseState& state = course_.state();
    const CourseRules& rules = course_.rules();
    out_.sums = std::move(state.answer_confirmed ? confirmed_ : searched_);
    // A run that was given a time and nothing else is complete when its time is over.
    const bool only_time = rules.fixed_points == kMostPoints && std::string(state.ended_by) == "time limit";
    out_.partial = state.partial && !only_time;
    out_.target_asked = rules.target_asked;
    out_.target_reached = rules.target_asked && state.reached;
    out_.ending.by = state.ended_by;
    out_.ending.half_width = rules.t95 * state.error;
    out_.ending.rays = static_cast<std::uint64_t>(static_cast<double>(out_.sums.points) * rays_per_point());
    out_.rays_total =
        static_cast<std::uint64_t>(static_cast<double>(state.searched + state.confirmed) * rays_per_point());
    return std::move(out_);
  }

  const Geometry& geometry_;
  const PassPlan& plan_;
  PassRunner& runner_;
  const TraceHooks& hooks_;
  Course course_;
  double start_, time_left_s_;
  double search_seconds_ = 0.0, confirm_seconds_ = 0.0;
  const char* stopped_by_ = "";
  std::uint32_t confirmed_epoch_ = 0;
  Sums searched_, confirmed_;
  PassOutcome out_;
};

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

}  // namespace

Result trace(const Scene& scene, Device& device, const TraceHooks& hooks) {
  check_scene(scene);
  const DeviceUse use(device);
  const double start = now();
  Result result;
  result.device = device.info();
  result.seed = scene.trace.seed;
  result.replicates = scene.trace.replicates;
  const Geometry geometry = build_geometry(scene);
  result.mesh = geometry.report;
  result.extent_m = geometry.extent;
  const std::vector<PassPlan> plans = plan_passes(scene, geometry);
  result.seconds.bvh = now() - start;
  result.digest = kFnvStart;
  bool target_reached = true;
  double spent = 0.0;
  Ending ending;
  LitRecords lit;
  for (const PassPlan& plan : plans) {
    PassRunner runner(device, plan, geometry, scene.trace);
    result.seconds.compile += runner.compile_seconds();
    const double begin = now();
    const double left = scene.trace.time_limit_s > 0.0 ? std::max(1e-6, scene.trace.time_limit_s - spent) : 0.0;
    const PassOutcome outcome = PassDriver(geometry, plan, runner, scene.trace, hooks, left).run();
    spent += now() - begin;
    if (outcome.sums.points == 0) {
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
    const std::uint64_t rays = outcome.sums.points * plan.request.replicates *
                               (plan.request.pixels ? static_cast<std::uint64_t>(size.width) * size.height : 1);
    if (result.rays == 0) result.rays = rays;
    result.rays_total += std::max(outcome.rays_total, rays) * plan.beams.views.size();
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
        "order is hit; remove one of each",
        text::counted(geometry.conflicts, "pair")));
  std::vector<std::string> early = std::move(result.warnings);
  add_warnings(scene, ending, lit, &result);
  result.warnings.insert(result.warnings.end(), early.begin(), early.end());
  return result;
}

std::string kernel_source(const Scene& scene, Device& device) {
  check_scene(scene);
  const DeviceUse use(device);
  const Geometry geometry = build_geometry(scene);
  const std::vector<PassPlan> plans = plan_passes(scene, geometry);
  return program_source(device.impl().devices.front(), "trace.cl", plans.front().program.options);
}

}  // namespace clray
