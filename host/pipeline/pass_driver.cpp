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
#include "pipeline/shares.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kZeroRays = 1u << 20;      // after which a zero total counts as zero
constexpr std::uint64_t kMostPoints = 1ull << 32;  // of a 32-bit Sobol sequence
constexpr double kDefaultTarget = 0.01;
constexpr double kTilesPower = 1.5;  // of their number, with which the error of tiles falls (docs/exact.md)
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
  // Where time may end the search, every doubling is a result to fall back on.
  if (plan.request.tiles() && o.time_limit_s == 0.0) rules.anew_power = kTilesPower;
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
  bool of_all = false;  ///< every view's course asks for it
};

class PassDriver {
 public:
  PassDriver(const Geometry& geometry, const PassPlan& plan, const TraceOptions& options, const TraceHooks& hooks,
             RunSaver& saver, double time_left_s)
      : geometry_(geometry),
        plan_(plan),
        hooks_(hooks),
        saver_(saver),
        checkpoint_(saver.checkpoint()),
        saved_(saver.pass(plan)),
        courses_(plan.beams.views.size(), Course(rules_of(plan, options))),
        slab_(plan.slab_views != 0 ? plan.slab_views : courses_.size()),
        time_left_s_(time_left_s) {
    if (saved_.found.points.empty()) saved_.found = Sums(plan.layout);
    saved_.epochs.resize(courses_.size());
    go_on();
  }

  PassOutcome run(const std::function<PointRunner&()>& runner) {
    for (std::vector<Step> steps = next_steps(); !steps.empty(); steps = next_steps()) {
      start(runner);
      for (const Step& step : steps) {
        if (take(step)) continue;
        saver_.save();
        return answer();
      }
    }
    saved_.complete = true;
    return answer();
  }

  /// Takes one of several shares of points or, where they are found anew, of views.
  PassOutcome run_share(const std::function<PointRunner&()>& runner) {
    const CourseRules& rules = courses_.front().rules();
    if (rules.target > 0.0 || rules.fixed_points == kMostPoints || time_left_s_ > 0.0)
      throw Error(ErrorCode::usage,
                  "a share needs a run whose end is known: --rays, and neither --target-error nor --time-limit");
    const OpenStep share = share_of(plan_, saver_.share(), rules.fixed_points);
    if (saved_.first.empty()) {
      saved_.first.assign(courses_.size(), 0);
      for (const std::uint32_t v : share.views) saved_.found.points[v] = saved_.first[v] = share.from;
    }
    Step left;
    left.points = {"share", 0, share.points, false};
    left.from = share.from;
    for (const std::uint32_t v : share.views) {
      if (saved_.found.points[v] != share.points) left.views.push_back(v);
    }
    std::vector<Step> slabs;
    add_slabs(left, &slabs);
    for (const Step& slab : slabs) {
      if (out_.partial) break;
      OpenStep step{0, slab.from, slab.points.points, slab.views, 0, {}};
      if (!saved_.step.is_same(step)) saved_.step = std::move(step);
      start(runner);
      const auto ask = [&](double part) { return keep_going(slab, part, traced_s()); };
      out_.partial = !runner_->run(&saved_.found, &saved_.step, ask, checkpoint_);
      if (!out_.partial) saved_.step = OpenStep();
    }
    saved_.complete = !out_.partial;
    saver_.save();
    out_.seconds = traced_s();
    return std::move(out_);
  }

 private:
  void start(const std::function<PointRunner&()>& runner) {
    if (runner_ != nullptr) return;
    runner_ = &runner();
    start_ = now() - runner_->compile_seconds();
  }

  double traced_s() const { return runner_ == nullptr ? 0.0 : now() - start_ - runner_->compile_seconds(); }

  /// Takes the courses to where the saved sums are.
  void go_on() {
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>, double> known;
    for (const StepNote& note : saved_.notes) known[{note.view, note.epoch, note.points}] = note.error;
    for (std::uint32_t v = 0; v < courses_.size(); ++v) {
      const std::uint64_t found = saved_.found.points[v];
      finished_a_step_ = finished_a_step_ || found > 0;
      for (auto next = courses_[v].next(); next; next = courses_[v].next()) {
        const auto note = known.find({v, next->epoch, next->points});
        if (note != known.end()) {
          courses_[v].took(note->second);
        } else if (!next->confirms && next->points == found) {
          courses_[v].took(error_of(saved_.found, v).relative_standard_error);
        } else if (!next->confirms && next->points < found && courses_[v].rules().target == 0.0) {
          courses_[v].took(kNan);  // of steps on the way, where no error decides anything
        } else {
          break;
        }
      }
      check_further(v);
    }
  }

  /// Points that a saved run has beyond what is asked cannot be taken away again.
  void check_further(std::uint32_t v) const {
    const CourseState& state = courses_[v].state();
    const auto next = courses_[v].next();
    const bool confirm = next ? next->confirms : state.answer_confirmed;
    const bool same_epoch = !saved_.confirmed.points.empty() && saved_.epochs[v] == state.epoch;
    const std::uint64_t has = !confirm ? saved_.found.points[v] : same_epoch ? saved_.confirmed.points[v] : 0;
    const std::uint64_t wanted = next ? next->points : confirm ? state.confirm_size : state.searched;
    if ((next && plan_.request.tiles()) || (next ? has <= wanted : has == wanted)) return;
    throw Error(ErrorCode::usage,
                fmt::format("the saved run has gone further ({} points of a replicate) than this one asks for ({})",
                            has, wanted));
  }

  /// What the courses ask for next, in an order that depends on nothing but them.
  std::vector<Step> next_steps() {
    std::map<std::tuple<bool, std::uint32_t, std::uint64_t, std::uint64_t>, Step> steps;
    Sums& confirmed = saved_.confirmed;
    for (std::uint32_t v = 0; v < courses_.size(); ++v) {
      const std::optional<CourseStep> next = courses_[v].next();
      if (!next) continue;
      if (next->confirms && confirmed.points.empty()) confirmed = Sums(plan_.layout);  // pictures never need it
      if (next->confirms && next->epoch != saved_.epochs[v]) {                         // the last confirmation missed
        confirmed.set_view(plan_.layout, v, nullptr);
        saved_.epochs[v] = next->epoch;
      }
      const std::uint64_t from = (next->confirms ? confirmed : saved_.found).points[v];
      Step& step = steps[{next->confirms, next->epoch, from, next->points}];
      step.points = *next;
      step.from = from;
      step.views.push_back(v);
    }
    std::vector<Step> list;
    for (auto& [key, step] : steps) {
      step.of_all = step.views.size() == courses_.size();
      add_slabs(step, &list);
    }
    return list;
  }

  /// Appends a step in parts, so that devices need not have room for all of its views at once.
  void add_slabs(const Step& step, std::vector<Step>* list) const {
    for (std::size_t first = 0; first < step.views.size(); first += slab_) {
      Step part = step;
      const auto begin = step.views.begin() + static_cast<std::ptrdiff_t>(first);
      part.views.assign(begin, begin + static_cast<std::ptrdiff_t>(std::min(slab_, step.views.size() - first)));
      part.of_all = step.of_all && first == 0;
      list->push_back(std::move(part));
    }
  }

  /// Traces a step; false where time or an interrupt ended the pass.
  bool take(const Step& step) {
    const bool confirms = step.points.confirms;
    Sums& sums = confirms ? saved_.confirmed : saved_.found;
    double& seconds = confirms ? saved_.confirm_s : saved_.search_s;
    if (confirms && step.from == 0 && step.of_all) seconds = 0.0;
    OpenStep open{step.points.epoch, step.from, step.points.points, step.views, 0, {}};
    if (!saved_.step.is_same(open)) saved_.step = std::move(open);
    const double begin = traced_s();
    const auto ask = [&](double share) { return keep_going(step, share, seconds + traced_s() - begin); };
    if (!runner_->run(&sums, &saved_.step, ask, checkpoint_)) {
      for (Course& course : courses_) {
        if (course.next()) course.cut(stopped_by_);
      }
      return false;
    }
    saved_.step = OpenStep();
    seconds += traced_s() - begin;
    note(step, sums, seconds);
    finished_a_step_ = true;
    if (hooks_.progress) hooks_.progress(progress(step, 1.0, seconds));
    if (checkpoint_.due && checkpoint_.due()) checkpoint_.save();
    return true;
  }

  ErrorPoint error_of(const Sums& sums, std::uint32_t v) const {
    ErrorPoint point;
    if (plan_.request.paints()) {
      point.relative_standard_error = picture_error(plan_, geometry_, sums, v);
    } else {
      largest_error(targets_of(plan_, geometry_, sums, v), static_cast<double>(sums.points[v]), &point);
    }
    return point;
  }

  /// Tells the courses the errors of their views, and notes the largest.
  void note(const Step& step, const Sums& sums, double seconds) {
    ErrorPoint worst;
    worst.relative_standard_error = kNan;
    for (const std::uint32_t v : step.views) {
      const ErrorPoint point = error_of(sums, v);
      courses_[v].took(point.relative_standard_error);
      saved_.notes.push_back({v, step.points.epoch, step.points.points, point.relative_standard_error});
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
    add_error(worst);
  }

  /// The parts of a step have one error, the largest.
  void add_error(const ErrorPoint& point) {
    ErrorPoint* const last = saved_.errors.empty() ? nullptr : &saved_.errors.back();
    if (slab_ == courses_.size() || last == nullptr || last->phase != point.phase || last->rays != point.rays)
      return saved_.errors.push_back(point);
    last->seconds = point.seconds;
    if (!(last->relative_standard_error >= point.relative_standard_error))
      last->relative_standard_error = point.relative_standard_error;
  }

  bool keep_going(const Step& step, double share, double seconds) {
    if (hooks_.stop != nullptr && hooks_.stop->load()) {
      stopped_by_ = "interrupt";
      return false;
    }
    if (time_left_s_ > 0.0 && traced_s() > time_left_s_) {
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
    out_.seconds = traced_s();
    out_.errors = saved_.errors;
    out_.sums = saver_.hand_over(plan_, saved_.complete);
    out_.target_asked = courses_.front().rules().target_asked;
    out_.target_reached = out_.target_asked;
    for (std::size_t v = 0; v < courses_.size(); ++v) {
      const CourseState& state = courses_[v].state();
      const CourseRules& rules = courses_[v].rules();
      if (state.answer_confirmed) out_.sums.set_view(plan_.layout, v, &saved_.confirmed);
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
  const TraceHooks& hooks_;
  RunSaver& saver_;
  const Checkpoint checkpoint_;
  SavedPass& saved_;
  std::vector<Course> courses_;  // of each view
  const std::size_t slab_;       // views of a step's part
  PointRunner* runner_ = nullptr;
  double start_ = 0.0, time_left_s_;
  const char* stopped_by_ = "";
  bool finished_a_step_ = false;
  PassOutcome out_;
};

}  // namespace

PassOutcome drive_pass(const Geometry& geometry, const PassPlan& plan, const std::function<PointRunner&()>& runner,
                       const TraceOptions& options, const TraceHooks& hooks, RunSaver& saver, double time_left_s) {
  PassDriver driver(geometry, plan, options, hooks, saver, time_left_s);
  return saver.has_one_of_several() ? driver.run_share(runner) : driver.run(runner);
}

}  // namespace clray
