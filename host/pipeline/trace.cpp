// SPDX-License-Identifier: Apache-2.0
// The call that traces a scene: what is prepared, passes, and the result.
#include "clray/trace.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "clray/detector.hpp"
#include "clray/error.hpp"
#include "clray/pass.hpp"
#include "clray/prepared.hpp"
#include "clray/ranks.hpp"
#include "clray/result.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/crew.hpp"
#include "pipeline/crew_member.hpp"
#include "pipeline/exact_pass.hpp"
#include "pipeline/method.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/pass_driver.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/preparation.hpp"
#include "pipeline/run_saver.hpp"
#include "pipeline/shared_views.hpp"
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

/// Traces the passes of a scene one by one and makes their result.
class Tracer {
 public:
  Tracer(Preparation& kept, const Scene& scene, const TraceHooks& hooks, const Saving& saving, Ranks* ranks)
      : kept_(kept), device_(kept.device()), scene_(scene), hooks_(hooks), saver_(saving), ranks_(ranks) {}

  Result run() {
    result_.instants = pass_instants(scene_);
    const DeviceUse use(device_);
    const double start = now();
    result_.seed = scene_.trace.seed;
    result_.replicates = scene_.trace.replicates;
    Planned planned = plan_scene(kept_, scene_);
    const Geometry& geometry = planned.geometry;
    result_.mesh = geometry.report;
    result_.extent_m = geometry.extent;
    result_.seconds.bvh = now() - start;
    result_.digest = kFnvStart;
    passes_ = passes_of(planned.plans);
    if (ranks_ != nullptr) {  // they build programs once
      for (PassPlan& plan : planned.plans) take_lasting_program(&plan);
    }
    if (ranks_ != nullptr && ranks_->number() != 0) {
      help_with_run(*ranks_, device_, passes_, geometry, scene_.trace);
      return {};
    }
    saver_.begin(planned.plans, geometry);
    if (ranks_ != nullptr) crew_ = std::make_unique<Crew>(*ranks_, fingerprints(geometry));
    try {
      take_passes(planned);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::device) throw;
      keep_before(error);
    }
    end(geometry, start);
    return std::move(result_);
  }

 private:
  std::vector<std::uint64_t> fingerprints(const Geometry& geometry) const {
    std::vector<std::uint64_t> all;
    for (const PassPlan* plan : passes_) all.push_back(fingerprint_of(*plan, geometry));
    return all;
  }

  SharedPass shared(const PassPlan& plan) const {
    const auto at = std::find(passes_.begin(), passes_.end(), &plan);
    return {crew_.get(), static_cast<std::uint32_t>(at - passes_.begin())};
  }

  /// Shares the views of a pass that takes them as a whole.
  std::unique_ptr<PointRunner> by_views(std::unique_ptr<PointRunner> own, const PassPlan& plan) const {
    if (crew_ == nullptr) return own;
    return std::make_unique<SharedViews>(std::move(own), plan, shared(plan));
  }

  void take_passes(Planned& planned) {
    const Geometry& geometry = planned.geometry;
    for (std::size_t k = 0; k < planned.plans.size(); ++k) {
      const double left = scene_.trace.time_limit_s > 0.0 ? std::max(1e-6, scene_.trace.time_limit_s - spent_) : 0.0;
      // After an interrupt no other program is built.
      const bool go = k == 0 || !stopped();
      PassOutcome outcome = go ? outcome_of(planned.plans[k], geometry, kept_.pass(k), left) : cut();
      if (!kept_.used_again()) kept_.pass(k)->clear();  // results need memory, too
      take(planned.plans[k], geometry, &outcome);
    }
  }

  /// Saves what was found before the last device failed, and throws its error.
  [[noreturn]] void keep_before(const Error& error) {
    if (!saver_.writes() || !saver_.has_anything()) throw error;
    saver_.save();
    throw Error(error.code(), error.message() + "; what was found before is saved: --resume goes on from it",
                error.context());
  }

  /// Traces or solves a pass, or solves its first bounce and traces the rest.
  PassOutcome outcome_of(PassPlan& plan, const Geometry& geometry, KeptPass* kept, double time_left_s) {
    if (plan.request.exact()) return solved(plan, geometry, time_left_s);
    if (plan.request.tiles()) {
      const auto make = [&] { return by_views(std::make_unique<TilesRunner>(device_, plan, geometry), plan); };
      return driven(plan, geometry, make, time_left_s);
    }
    const double before = spent_;
    if (plan.first) {
      PassOutcome first = solved(plan.first->plan, geometry, time_left_s);
      if (first.partial) return first;
      plan.first->sums = std::move(first.sums);
    }
    const double solving = spent_ - before;
    if (time_left_s > 0.0) time_left_s = std::max(1e-6, time_left_s - solving);
    const auto make = [&] {
      return std::make_unique<PassRunner>(device_, plan, geometry, scene_.trace, kept, shared(plan));
    };
    PassOutcome outcome = driven(plan, geometry, make, time_left_s);
    for (ErrorPoint& point : outcome.errors) point.seconds += solving;
    return outcome;
  }

  PassOutcome solved(const PassPlan& plan, const Geometry& geometry, double time_left_s) {
    std::unique_ptr<PointRunner> pass;
    const auto make = [&]() -> PointRunner& {
      pass = by_views(std::make_unique<ExactPass>(device_, plan, geometry), plan);
      result_.seconds.compile += pass->compile_seconds();
      return *pass;
    };
    PassOutcome outcome = solve_pass(plan, make, scene_.trace, hooks_, saver_, time_left_s);
    spent_ += outcome.seconds;
    return outcome;
  }

  template <class Make>
  PassOutcome driven(const PassPlan& plan, const Geometry& geometry, const Make& make, double time_left_s) {
    std::unique_ptr<PointRunner> runner;
    const auto made = [&]() -> PointRunner& {
      runner = make();
      return *runner;
    };
    PassOutcome outcome = drive_pass(geometry, plan, made, scene_.trace, hooks_, saver_, time_left_s);
    if (runner != nullptr) result_.seconds.compile += runner->compile_seconds();
    spent_ += outcome.seconds;
    return outcome;
  }

  PassOutcome cut() {
    if (!result_.partial) saver_.save();  // else the pass that was cut has done so
    PassOutcome outcome;
    outcome.partial = true;
    return outcome;
  }

  bool stopped() const { return hooks_.stop != nullptr && hooks_.stop->load(); }

  /// Adds what a pass found to the result.
  void take(const PassPlan& plan, const Geometry& geometry, PassOutcome* found) {
    const PassOutcome& outcome = *found;
    if (saver_.has_one_of_several()) {
      result_.partial = result_.partial || outcome.partial;
      return;
    }
    result_.partial = result_.partial || outcome.partial || outcome.sums.empty();
    if (outcome.sums.empty()) {
      result_.warnings.push_back("stopped before the first result of " + records_of(plan));
      return;
    }
    result_.target_asked = result_.target_asked || outcome.target_asked;
    if (outcome.target_asked) {
      // The result's ending is that of the first pass that missed the target, else of the one with the largest error.
      if (target_reached_ && (!outcome.target_reached || !(outcome.ending.half_width <= ending_.half_width)))
        ending_ = outcome.ending;
      target_reached_ = target_reached_ && outcome.target_reached;
    } else if (!result_.target_asked) {
      ending_ = outcome.ending;
    }
    const PictureSize& size = plan.request.picture;
    const std::uint64_t per_point =
        plan.request.replicates * (plan.request.pixels ? static_cast<std::uint64_t>(size.width) * size.height : 1);
    const std::vector<std::uint64_t>& points = outcome.sums.points;
    if (result_.rays == 0 && !plan.request.exact())
      result_.rays = *std::max_element(points.begin(), points.end()) * per_point;
    result_.rays_total += outcome.rays_total;
    result_.digest = digest_of(result_.digest, plan, outcome.sums);
    result_.errors.insert(result_.errors.end(), outcome.errors.begin(), outcome.errors.end());
    add_unique(plan.program.kept, &result_.kept);
    add_unique(plan.program.left_out, &result_.left_out);
    add_unique(doubtful_claims(plan, geometry, outcome.sums), &result_.warnings);
    add_results(scene_, plan, found, &result_, &lit_);
  }

  /// The detectors of a pass, and the variants and bands, where there are several, that it is about.
  std::string records_of(const PassPlan& plan) const {
    std::string text;
    const auto add = [&](const std::string& what, const std::vector<std::string>& names) {
      if (!names.empty()) text += (text.empty() ? what : ", " + what) + fmt::format("{}", fmt::join(names, ", "));
    };
    std::vector<std::string> detectors, variants, bands;
    for (const PassDetector& d : plan.detectors) {
      if (d.index >= 0) add_unique({shown_name(scene_.detectors[static_cast<std::size_t>(d.index)])}, &detectors);
    }
    for (const Lane& lane : plan.request.lanes) {
      if (!lane.variant.empty()) add_unique({lane.variant}, &variants);
      if (!lane.band_name.empty()) add_unique({lane.band_name}, &bands);
    }
    add("", detectors);
    add("variant ", variants);
    add("band ", bands);
    return text;
  }

  void end(const Geometry& geometry, double start) {
    result_.target_reached = result_.target_asked && target_reached_ && !result_.partial;
    if (result_.target_asked) result_.target_percent = scene_.trace.target_error_percent;
    result_.reached_percent = 100.0 * ending_.half_width;
    // Whatever ended the passes that are whole, others are missing.
    if (result_.partial) ending_.by = stopped() ? "interrupt" : "time limit";
    result_.stopped_by = ending_.by;
    result_.seconds.trace = spent_;
    result_.seconds.total = now() - start;
    result_.device = device_.info();  // now it is known which have failed
    check_diagnostics(result_, scene_.trace.allow_failures);
    order_results(scene_, &result_);
    if (geometry.conflicts != 0)
      result_.warnings.push_back(fmt::format(
          "faces of different materials overlap in one plane and look the same way ({}): the first in canonical "
          "order is hit; remove the others",
          text::counted(geometry.conflicts, "face")));
    std::vector<std::string> early = device_.impl().notes;
    if (crew_ != nullptr) add_unique(crew_->notes(), &early);
    add_unique(result_.warnings, &early);
    add_warnings(scene_, ending_, lit_, &result_);
    result_.warnings.insert(result_.warnings.end(), early.begin(), early.end());
    add_unique(pass_warnings(scene_), &result_.warnings);
  }

  Preparation& kept_;
  Device& device_;
  const Scene& scene_;
  const TraceHooks& hooks_;
  Result result_;
  bool target_reached_ = true;
  double spent_ = 0.0;  // s of tracing
  Ending ending_;
  LitRecords lit_;
  RunSaver saver_;
  Ranks* ranks_;
  std::vector<const PassPlan*> passes_;
  std::unique_ptr<Crew> crew_;
};

Result trace_with(Preparation& kept, const Scene& scene, const TraceHooks& hooks, const Saving& saving = {},
                  Ranks* ranks = nullptr) {
  check_scene(scene);
  try {
    return Tracer(kept, scene, hooks, saving, ranks).run();
  } catch (...) {
    kept.drop_passes();  // their sums may be anything
    throw;
  }
}

/// Builds the programs of a scene and copies what they read to the devices.
void prepare(Preparation& kept, const Scene& scene) {
  check_scene(scene);
  const DeviceUse use(kept.device());
  Planned planned = plan_scene(kept, scene);
  for (std::size_t k = 0; k < planned.plans.size(); ++k) {
    PassPlan& plan = planned.plans[k];
    if (plan.request.exact()) ExactPass(kept.device(), plan, planned.geometry);
    if (plan.request.tiles()) TilesRunner(kept.device(), plan, planned.geometry);
    if (plan.request.without_rays()) continue;
    if (plan.first) ExactPass(kept.device(), plan.first->plan, planned.geometry);
    PassRunner(kept.device(), plan, planned.geometry, scene.trace, kept.pass(k));
  }
}

}  // namespace

struct Prepared::Impl {
  Impl(const Scene& s, Device& device) : scene(s), kept(device, true) {}
  Scene scene;
  Preparation kept;
};

Prepared::Prepared(const Scene& scene, Device& device) : impl_(std::make_unique<Impl>(scene, device)) {
  prepare(impl_->kept, scene);
}
Prepared::~Prepared() = default;
Prepared::Prepared(Prepared&&) noexcept = default;
Prepared& Prepared::operator=(Prepared&&) noexcept = default;

const Scene& Prepared::scene() const {
  if (!impl_) throw Error(ErrorCode::usage, "this Prepared was moved from");
  return impl_->scene;
}

Result Prepared::trace(const TraceHooks& hooks) {
  return trace(scene(), hooks);
}

Result Prepared::trace(const std::vector<Orientation>& views, const TraceHooks& hooks) {
  Scene scene = this->scene();
  scene.motion.reset();
  scene.pass.reset();
  scene.views = views;
  return trace(scene, hooks);
}

Result Prepared::trace(const Scene& scene, const TraceHooks& hooks) {
  if (!impl_) throw Error(ErrorCode::usage, "this Prepared was moved from");
  return trace_with(impl_->kept, scene, hooks);
}

Result trace(const Scene& scene, Device& device, const TraceHooks& hooks) {
  Preparation kept(device);
  return trace_with(kept, scene, hooks);
}

Result trace(const Scene& scene, Device& device, const TraceHooks& hooks, const Saving& saving) {
  Preparation kept(device);
  return trace_with(kept, scene, hooks, saving);
}

Result trace(const Scene& scene, Device& device, const TraceHooks& hooks, const Saving& saving, Ranks& ranks) {
  Preparation kept(device);
  try {
    return trace_with(kept, scene, hooks, saving, ranks.count() > 1 ? &ranks : nullptr);
  } catch (const Error& error) {
    leave_run(ranks, error.what());
    throw;
  } catch (...) {
    leave_run(ranks, "what a callback threw");
    throw;
  }
}

std::string kernel_source(const Scene& scene, Device& device) {
  check_scene(scene);
  const DeviceUse use(device);
  Preparation kept(device);
  Planned planned = plan_scene(kept, scene);
  take_lasting_program(&planned.plans.front());
  const Specialised& program = planned.plans.front().program;
  return program_source(device.impl().devices.front(), program.entry, program.options);
}

}  // namespace clray
