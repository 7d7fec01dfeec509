// SPDX-License-Identifier: Apache-2.0
// The call that traces a scene: geometry, passes, when each stops, and the result (PHYSICS section 6, "Stopping").
#include "clray/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "clray/error.hpp"
#include "clray/result.hpp"
#include "pipeline/estimate.hpp"
#include "pipeline/geometry.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/warnings.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kFirstPoints = 1u << 10;   // of a search, per replicate
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

/// One pass from its first ray to its last: search, confirm, or a fixed number of rays.
class PassDriver {
 public:
  PassDriver(const Scene& scene, const Geometry& geometry, const PassPlan& plan, PassRunner& runner,
             const TraceHooks& hooks, double time_left_s)
      : options_(scene.trace),
        geometry_(geometry),
        plan_(plan),
        runner_(runner),
        hooks_(hooks),
        start_(now()),
        time_left_s_(time_left_s),
        // A picture's error is a mean over its pixels: each half-difference has one degree of freedom, all have many.
        t95_(plan.pixels ? 1.96 : student_t95(static_cast<int>(plan.replicates) - 1)) {}

  PassOutcome run() {
    if (plan_.pixels) {
      run_fixed(picture_points());
    } else if (options_.rays != 0) {
      run_fixed(power_of_two_above((options_.rays + plan_.replicates - 1) / plan_.replicates));
    } else if (options_.target_error_percent > 0.0 || options_.time_limit_s <= 0.0) {
      run_to_target();
    } else {
      run_fixed(kMostPoints);
      out_.partial = stopped_;  // running out of the time asked for is no early end
    }
    out_.ending.half_width = t95_ * last_error_;
    out_.ending.rays = static_cast<std::uint64_t>(static_cast<double>(out_.sums.points) * rays_per_point());
    return std::move(out_);
  }

 private:
  std::uint64_t picture_points() const {
    const double pixels = static_cast<double>(plan_.width) * plan_.height;
    double samples = 8.0;
    if (plan_.picture_samples > 0) {
      samples = plan_.picture_samples;
    } else if (options_.rays != 0) {
      samples = static_cast<double>(options_.rays) / pixels;
    } else if (options_.target_error_percent > 0.0) {
      samples = 64.0;  // where a picture's search for a target gives up; `samples` or --rays go on
    }
    return power_of_two_above(static_cast<std::uint64_t>(std::max(1.0, std::ceil(samples / plan_.replicates))));
  }

  bool keep_going(const char* phase, double share, std::uint64_t from, std::uint64_t to) {
    if (hooks_.stop != nullptr && hooks_.stop->load()) {
      stopped_ = true;
      out_.ending.by = "interrupt";
      return false;
    }
    if (time_left_s_ > 0.0 && now() - start_ > time_left_s_) {
      out_.ending.by = "time limit";
      return false;
    }
    if (hooks_.progress) {
      Progress p;
      p.phase = phase;
      const double seconds = now() - phase_start_;
      const double points = static_cast<double>(from) + share * static_cast<double>(to - from);
      p.rays = static_cast<std::uint64_t>(points * rays_per_point());
      p.rays_per_s = static_cast<double>(p.rays) * static_cast<double>(plan_.views.size()) / std::max(seconds, 1e-9);
      p.relative_error = t95_ * last_error_;
      const double goal = goal_points(to);
      p.fraction = std::min(1.0, points / goal);
      p.seconds_left = points > 0.0 ? seconds * (goal / points - 1.0) : kNan;
      hooks_.progress(p);
    }
    return true;
  }

  /// Points at which this phase is likely to end: the error falls at least as N^-1/2.
  double goal_points(std::uint64_t to) const {
    double goal = static_cast<double>(std::max(to, phase_goal_));
    if (phase_goal_ == 0 && last_error_ > 0.0 && target_ > 0.0) {
      const double ratio = t95_ * last_error_ / target_;
      goal = std::max(goal, static_cast<double>(to) / 2.0 * ratio * ratio);
    }
    return goal;
  }

  double rays_per_point() const {
    return plan_.pixels ? 2.0 * plan_.width * plan_.height : static_cast<double>(plan_.replicates);
  }

  /// Doubles *sums up to `points`; false when cut short, with *sums at the last doubling complete.
  bool advance(const char* phase, Sums* sums, std::uint64_t points, std::uint32_t epoch) {
    const std::uint64_t from = sums->points;
    const auto ask = [&](double share) { return keep_going(phase, share, from, points); };
    if (!runner_.run(sums, points, epoch, ask)) return false;
    note(phase, *sums);
    return true;
  }

  void note(const char* phase, const Sums& sums) {
    ErrorPoint point;
    point.phase = phase;
    point.rays = static_cast<std::uint64_t>(static_cast<double>(sums.points) * rays_per_point());
    point.seconds = now() - phase_start_;
    if (plan_.pixels) {
      point.relative_standard_error = picture_error(sums);
    } else {
      largest_error(targets_of(plan_, geometry_, sums), &point);
    }
    last_error_ = point.relative_standard_error;
    out_.errors.push_back(point);
  }

  /// Root mean square over covered pixels of the standard error, over their mean radiance.
  double picture_error(const Sums& sums) const {
    const std::uint64_t pixels = static_cast<std::uint64_t>(plan_.width) * plan_.height;
    double squares = 0.0, mean = 0.0, count = 0.0;
    for (std::size_t row = 0; row < plan_.views.size() * plan_.lanes.size(); ++row) {
      const std::uint64_t view = row / plan_.lanes.size();
      for (std::uint64_t p = 0; p < pixels; ++p) {
        if (sums.hits[view * pixels + p] == 0) continue;
        const std::uint64_t at = plan_.constants.pixels + 2 * row * pixels + p;
        const double a = static_cast<double>(sums.values[at]), b = static_cast<double>(sums.values[at + pixels]);
        mean += 0.5 * (a + b);
        squares += 0.25 * (a - b) * (a - b);
        count += 1.0;
      }
    }
    return mean > 0.0 ? std::sqrt(squares / count) / (mean / count) : kNan;
  }

  void run_fixed(std::uint64_t points) {
    begin_phase(points);
    if (points > kMostPoints)
      throw Error(ErrorCode::usage, fmt::format("at most {} rays per orientation can be traced with {} replicates",
                                                kMostPoints * plan_.replicates, plan_.replicates));
    target_ = options_.target_error_percent / 100.0;
    out_.ending.by = options_.rays != 0 || target_ <= 0.0 ? "rays" : "samples";
    // Large cubes take longer to read than to trace: with no target to meet, three doublings tell the error's course.
    const std::uint64_t first = !plan_.pixels   ? kFirstPoints
                                : target_ > 0.0 ? 1
                                                : std::max<std::uint64_t>(1, points / 4);
    for (std::uint64_t n = std::min(points, first); n <= points; n *= 2) {
      if (!advance("trace", &out_.sums, n, 0)) {
        out_.partial = true;
        break;
      }
      if (target_ > 0.0 && passes() && (!plan_.pixels || n >= 4)) break;
    }
    finish_target(target_ > 0.0);
  }

  bool passes() const { return std::isnan(last_error_) ? zero_enough() : t95_ * last_error_ <= target_; }
  bool zero_enough() const { return out_.errors.back().rays >= kZeroRays || plan_.pixels; }

  void finish_target(bool asked) {
    out_.target_asked = asked;
    out_.target_reached = asked && !out_.errors.empty() && !std::isnan(last_error_) && passes();
    if (out_.target_reached) out_.ending.by = "target";
    if (asked && !out_.errors.empty() && std::isnan(last_error_) && passes() && !out_.partial) out_.ending.by = "zero";
    for (const ErrorPoint& point : out_.errors) out_.rays_total = std::max(out_.rays_total, point.rays);
  }

  void begin_phase(std::uint64_t goal) {
    phase_start_ = now();
    phase_goal_ = goal;
  }

  /// Doubles until the target is met, then confirms once on fresh scrambles at equal size (at least `least` points);
  /// the confirmation alone is the result. A confirmation that misses sends the search on; where the cap on rays does
  /// not let it, that confirmation is the result: the search had met the target by luck.
  void run_to_target() {
    const bool asked = options_.target_error_percent > 0.0;
    target_ = asked ? options_.target_error_percent / 100.0 : kDefaultTarget;
    const std::uint64_t most = std::clamp<std::uint64_t>(options_.max_rays / plan_.replicates, 1, kMostPoints);
    std::uint64_t least = 0;
    if (!asked) least = power_of_two_above(kLeastRays / plan_.replicates / plan_.views.size());
    Sums search, confirmed;
    std::uint64_t spent = 0;
    begin_phase(0);
    double search_error = kNan;
    bool done = false;
    for (std::uint64_t n = std::min(kFirstPoints, power_of_two_above(most / 2 + 1)); !done; n *= 2) {
      if (n > most) {
        out_.ending.by = "max_rays";
        break;
      }
      if (!advance("search", &search, n, 0)) break;
      confirmed = Sums();
      search_error = last_error_;
      if (!passes()) continue;
      const double search_seconds = now() - phase_start_;
      const std::uint64_t size = std::max(n, least);
      if (!confirm(size, &confirmed)) {
        confirmed = Sums();
        break;
      }
      spent += size;
      done = passes();
      begin_phase(0);
      phase_start_ -= search_seconds;
    }
    if (done) out_.ending.by = std::isnan(last_error_) ? "zero" : "target";
    const bool early = !done && std::string(out_.ending.by) != "max_rays";
    out_.partial = early;
    out_.target_asked = asked;
    out_.target_reached = done && !std::isnan(last_error_);
    out_.rays_total = (spent + search.points) * plan_.replicates;
    // What ends early equals a run with `rays` of the search's count, so it is the search's.
    const bool fresh = confirmed.points != 0 && !early;
    if (!fresh) last_error_ = search_error;
    out_.sums = fresh ? std::move(confirmed) : std::move(search);
  }

  /// Traces `size` points on the next scrambles; false where cut short.
  bool confirm(std::uint64_t size, Sums* confirmed) {
    begin_phase(size);
    ++epoch_;
    for (std::uint64_t m = std::min(kFirstPoints, size); m <= size; m *= 2) {
      if (!advance("confirm", confirmed, m, epoch_)) return false;
    }
    return true;
  }

  const TraceOptions& options_;
  const Geometry& geometry_;
  const PassPlan& plan_;
  PassRunner& runner_;
  const TraceHooks& hooks_;
  double start_, time_left_s_, t95_;
  double phase_start_ = 0.0, target_ = 0.0, last_error_ = kNan;
  std::uint64_t phase_goal_ = 0;
  std::uint32_t epoch_ = 0;
  bool stopped_ = false;
  PassOutcome out_;
};

void check_diagnostics(const Result& result, bool allowed) {
  const Diagnostics& d = result.diagnostics;
  if (d.non_finite + d.stack_overflow + d.accumulator_overflow == 0 || allowed) return;
  throw Error(
      ErrorCode::bug,
      fmt::format("the result is not sound: {} weights not finite, {} stack overflows, {} accumulator overflows",
                  d.non_finite, d.stack_overflow, d.accumulator_overflow));
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
  for (const PassPlan& plan : plans) {
    PassRunner runner(device, plan, geometry, scene.trace);
    result.seconds.compile += runner.compile_seconds();
    const double begin = now();
    const double left = scene.trace.time_limit_s > 0.0 ? std::max(1e-6, scene.trace.time_limit_s - spent) : 0.0;
    const PassOutcome outcome = PassDriver(scene, geometry, plan, runner, hooks, left).run();
    spent += now() - begin;
    if (outcome.sums.points == 0) {
      result.partial = true;
      result.warnings.push_back("stopped before the first result");
      continue;
    }
    result.partial = result.partial || outcome.partial;
    result.target_asked = result.target_asked || outcome.target_asked;
    if (outcome.target_asked) {
      // The first pass without the target speaks for the result, else the one with the largest error.
      if (target_reached && (!outcome.target_reached || !(outcome.ending.half_width <= ending.half_width)))
        ending = outcome.ending;
      target_reached = target_reached && outcome.target_reached;
    } else if (!result.target_asked) {
      ending = outcome.ending;
    }
    const std::uint64_t rays = outcome.sums.points * plan.replicates *
                               (plan.pixels ? static_cast<std::uint64_t>(plan.width) * plan.height : 1);
    if (result.rays == 0) result.rays = rays;
    result.rays_total += std::max(outcome.rays_total, rays) * plan.views.size();
    result.digest = digest_of(result.digest, plan, outcome.sums);
    result.errors.insert(result.errors.end(), outcome.errors.begin(), outcome.errors.end());
    add_unique(plan.kept, &result.kept);
    add_unique(plan.left_out, &result.left_out);
    add_results(scene, plan, outcome, &result);
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
    result.warnings.push_back(
        fmt::format("{} pairs of faces of different materials overlap in one plane and look the same way: the first in "
                    "canonical order is hit; remove one of each",
                    geometry.conflicts));
  std::vector<std::string> early = std::move(result.warnings);
  add_warnings(scene, ending, &result);
  result.warnings.insert(result.warnings.end(), early.begin(), early.end());
  return result;
}

std::string kernel_source(const Scene& scene, Device& device) {
  check_scene(scene);
  const DeviceUse use(device);
  const Geometry geometry = build_geometry(scene);
  const std::vector<PassPlan> plans = plan_passes(scene, geometry);
  return program_source(device.impl().devices.front(), "trace.cl", plans.front().options);
}

}  // namespace clray
