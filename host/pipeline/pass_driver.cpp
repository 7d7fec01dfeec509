// SPDX-License-Identifier: Apache-2.0
// See pass_driver.hpp.
#include "pipeline/pass_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "clray/error.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/course.hpp"
#include "pipeline/estimate.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kZeroRays = 1u << 20;      // after which a zero total counts as zero
constexpr std::uint64_t kMostPoints = 1ull << 32;  // of a 32-bit Sobol sequence
constexpr double kDefaultTarget = 0.01;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
      rules.least_points = power_of_two_above(kDefaultRays / replicates / plan.beams.views.size());
    }
  }
  if (rules.fixed_points > kMostPoints)
    throw Error(ErrorCode::usage, fmt::format("at most {} rays per orientation can be traced with {} replicates",
                                              kMostPoints * replicates, replicates));
  return rules;
}

/// Views whose courses ask for the same points.
struct Step {
  CourseStep points;
  std::uint64_t from = 0;  ///< points that they have
  std::vector<std::uint32_t> views;
};

class PassDriver {
 public:
  PassDriver(const Geometry& geometry, const PassPlan& plan, PointRunner& runner, const TraceOptions& options,
             const TraceHooks& hooks, double time_left_s)
      : geometry_(geometry),
        plan_(plan),
        runner_(runner),
        hooks_(hooks),
        courses_(plan.beams.views.size(), Course(rules_of(plan, options))),
        confirmed_epochs_(courses_.size(), 0),
        start_(now()),
        time_left_s_(time_left_s),
        searched_(plan.layout) {}

  PassOutcome run() {
    for (std::vector<Step> steps = next_steps(); !steps.empty(); steps = next_steps()) {
      for (const Step& step : steps) {
        if (!take(step)) return answer();
      }
    }
    return answer();
  }

 private:
  /// What the courses ask for next, in an order that depends on nothing but them.
  std::vector<Step> next_steps() {
    std::map<std::tuple<bool, std::uint32_t, std::uint64_t, std::uint64_t>, Step> steps;
    for (std::uint32_t v = 0; v < courses_.size(); ++v) {
      const std::optional<CourseStep> next = courses_[v].next();
      if (!next) continue;
      if (next->confirms && confirmed_.points.empty()) confirmed_ = Sums(plan_.layout);  // pictures never need it
      if (next->confirms && next->epoch != confirmed_epochs_[v]) {                       // the last confirmation missed
        confirmed_.set_view(plan_.layout, v, nullptr);
        confirmed_epochs_[v] = next->epoch;
      }
      const std::uint64_t from = (next->confirms ? confirmed_ : searched_).points[v];
      Step& step = steps[{next->confirms, next->epoch, from, next->points}];
      step.points = *next;
      step.from = from;
      step.views.push_back(v);
    }
    std::vector<Step> list;
    for (auto& [key, step] : steps) list.push_back(std::move(step));
    return list;
  }

  /// Traces a step; false where time or an interrupt ended the pass.
  bool take(const Step& step) {
    Sums& sums = step.points.confirms ? confirmed_ : searched_;
    double& seconds = step.points.confirms ? confirm_seconds_ : search_seconds_;
    if (step.points.confirms && step.from == 0 && step.views.size() == courses_.size()) seconds = 0.0;
    const double begin = now();
    const auto ask = [&](double share) { return keep_going(step, share, seconds + now() - begin); };
    if (!runner_.run(&sums, step.views, step.points.points, step.points.epoch, ask)) {
      for (Course& course : courses_) {
        if (course.next()) course.cut(stopped_by_);
      }
      return false;
    }
    seconds += now() - begin;
    note(step, sums, seconds);
    finished_a_step_ = true;
    if (hooks_.progress) hooks_.progress(progress(step, 1.0, seconds));
    return true;
  }

  /// Tells the courses the errors of their views, and notes the largest.
  void note(const Step& step, const Sums& sums, double seconds) {
    ErrorPoint worst;
    worst.relative_standard_error = kNan;
    for (const std::uint32_t v : step.views) {
      ErrorPoint point;
      if (plan_.request.paints()) {
        point.relative_standard_error = picture_error(plan_, geometry_, sums, v);
      } else {
        largest_error(targets_of(plan_, geometry_, sums, v), static_cast<double>(sums.points[v]), &point);
      }
      courses_[v].took(point.relative_standard_error);
      if (v == 0) {
        worst.first_total = point.first_total;
        worst.first_standard_error = point.first_standard_error;
      }
      if (!(worst.relative_standard_error >= point.relative_standard_error))
        worst.relative_standard_error = point.relative_standard_error;
    }
    worst.phase = step.points.phase;
    worst.rays = static_cast<std::uint64_t>(static_cast<double>(step.points.points) * rays_per_point());
    worst.seconds = seconds;
    out_.errors.push_back(worst);
  }

  bool keep_going(const Step& step, double share, double seconds) {
    if (hooks_.stop != nullptr && hooks_.stop->load()) {
      stopped_by_ = "interrupt";
      return false;
    }
    if (time_left_s_ > 0.0 && now() - start_ > time_left_s_) {
      stopped_by_ = "time limit";
      return false;
    }
    if (hooks_.progress) hooks_.progress(progress(step, share, seconds));
    return true;
  }

  Progress progress(const Step& step, double share, double seconds) const {
    Progress p;
    p.phase = step.points.phase;
    const double points = static_cast<double>(step.from) + share * static_cast<double>(step.points.points - step.from);
    const auto views = static_cast<double>(courses_.size());
    double error = kNan, done = views - static_cast<double>(step.views.size());
    for (const std::uint32_t v : step.views) {
      const double one = courses_[v].state().error;
      if (!(error >= one)) error = one;
      done += std::min(1.0, points / goal_points(courses_[v], step.points));
    }
    p.rays = static_cast<std::uint64_t>(points * rays_per_point());
    p.rays_per_s = static_cast<double>(p.rays) * static_cast<double>(step.views.size()) / std::max(seconds, 1e-9);
    p.relative_error = courses_.front().rules().t95 * error;
    p.fraction = done / views;
    p.seconds_left = points > 0.0 ? seconds * (1.0 / p.fraction - 1.0) : kNan;
    p.keeps = finished_a_step_;
    return p;
  }

  /// The points at which this phase of a view is likely to end, as the error falls at least as N^-1/2.
  static double goal_points(const Course& course, const CourseStep& step) {
    const CourseRules& rules = course.rules();
    const std::uint64_t known = step.confirms ? course.state().confirm_size : rules.fixed_points;
    double goal = static_cast<double>(std::max(step.points, known));
    const double error = course.state().error;
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
    out_.sums = std::move(searched_);
    out_.target_asked = courses_.front().rules().target_asked;
    out_.target_reached = out_.target_asked;
    for (std::size_t v = 0; v < courses_.size(); ++v) {
      const CourseState& state = courses_[v].state();
      const CourseRules& rules = courses_[v].rules();
      if (state.answer_confirmed) out_.sums.set_view(plan_.layout, v, &confirmed_);
      // A run that was given a time and nothing else is complete when its time is over.
      const bool only_time = rules.fixed_points == kMostPoints && std::string(state.ended_by) == "time limit";
      out_.partial = out_.partial || (state.partial && !only_time);
      out_.rays_total +=
          static_cast<std::uint64_t>(static_cast<double>(state.searched + state.confirmed) * rays_per_point());
      const double half_width = rules.t95 * state.error;
      // A view that missed the target speaks for the pass, else the one with the largest error.
      const bool first_to_miss = out_.target_reached && !state.reached;
      const bool larger = state.reached == out_.target_reached && !(half_width <= out_.ending.half_width);
      if (v == 0 || first_to_miss || larger) {
        out_.ending = {state.ended_by, half_width,
                       static_cast<std::uint64_t>(static_cast<double>(out_.sums.points[v]) * rays_per_point())};
      }
      out_.target_reached = out_.target_reached && state.reached;
    }
    return std::move(out_);
  }

  const Geometry& geometry_;
  const PassPlan& plan_;
  PointRunner& runner_;
  const TraceHooks& hooks_;
  std::vector<Course> courses_;  // of each view
  std::vector<std::uint32_t> confirmed_epochs_;
  double start_, time_left_s_;
  double search_seconds_ = 0.0, confirm_seconds_ = 0.0;
  const char* stopped_by_ = "";
  bool finished_a_step_ = false;
  Sums searched_, confirmed_;
  PassOutcome out_;
};

}  // namespace

PassOutcome drive_pass(const Geometry& geometry, const PassPlan& plan, PointRunner& runner, const TraceOptions& options,
                       const TraceHooks& hooks, double time_left_s) {
  return PassDriver(geometry, plan, runner, options, hooks, time_left_s).run();
}

PassOutcome solve_pass(ExactPass& pass, const TraceOptions& options, const TraceHooks& hooks, double time_left_s) {
  const double start = now();
  PassOutcome out;
  const char* stopped_by = "";
  const auto tell = [&](double share, bool keeps) {
    if (!hooks.progress) return;
    Progress p;
    p.phase = "exact";
    p.fraction = share;
    p.relative_error = 0.0;
    p.seconds_left = share > 0.0 ? (now() - start) * (1.0 / share - 1.0) : kNan;
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
  if (!pass.run(&out.sums, keep_going)) {
    out.sums = Sums();
    out.partial = true;
    out.ending.by = stopped_by;
    return out;
  }
  tell(1.0, true);
  out.target_reached = out.target_asked;
  out.ending = {"exact", 0.0, 0};
  ErrorPoint point;
  point.phase = "exact";
  point.seconds = now() - start;
  out.errors.push_back(point);
  return out;
}

}  // namespace clray
