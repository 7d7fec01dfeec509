// SPDX-License-Identifier: Apache-2.0
// Numbers at their limits: points numbered up to 2³², accumulators filled to the brim and beyond, and long runs. Where
// no scene gets there in reasonable time, a pass is run from a plan with its scale or its first point moved there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "body/geometry.hpp"
#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "pipeline/pass_runner.hpp"
#include "pipeline/plan.hpp"
#include "reference/sobol.hpp"
#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;
using clray::Sum;
using clray::Sums;

namespace {

/// The first pass of a scene, which may be changed before it runs.
struct Pass {
  Scene scene;
  clray::Geometry geometry = clray::build_geometry(scene);
  clray::PassPlan plan = clray::plan_passes(scene, geometry).at(0);

  explicit Pass(Scene s) : scene(std::move(s)) {}
  Sums run(std::uint64_t points) const { return run(points, Sums(plan.layout)); }
  Sums run(std::uint64_t points, Sums sums) const {
    clray::KeptPass kept;
    clray::PassPlan own = plan;  // a runner may take another program
    clray::PassRunner runner(device(), own, geometry, scene.trace, &kept);
    clray::OpenStep step;
    step.from = sums.points.front();
    step.points = points;
    step.views = {0};
    runner.run(&sums, &step, [](double) { return true; }, {});
    return sums;
  }
  const clray::SumBlock& block(const char* detector, std::uint32_t sum) const {
    return plan.layout.blocks.at(clray::find_detector(plan, detector)->first_block + sum);
  }
  /// The sum of weights of one replicate, of the only view, lane and observer.
  Sum total(const Sums& sums, std::uint32_t replicate) const {
    return sums.values[block("intensity", 0).offset + 3ull * replicate];
  }
};

/// Lambert sphere over the last points that a 32-bit number has, against the reference's points.
Outcome last_points(bool sobol) {
  constexpr std::uint64_t kEnd = 1ull << 32, kCount = 1u << 14;
  constexpr std::uint32_t kReplicates = 4;
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(1.0));
  scene.trace.replicates = kReplicates;
  scene.trace.sampler = sobol ? clray::SamplerKind::sobol : clray::SamplerKind::random;
  const Pass pass(scene);
  const std::uint64_t key = clray_reference::view_key({{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}});
  Sums sums(pass.plan.layout);
  sums.points[0] = kEnd - kCount;
  sums = pass.run(kEnd, sums);
  Outcome outcome{true, ""};
  double worst = 0.0;
  std::uint64_t expected_hits = 0;
  for (std::uint32_t r = 0; r < kReplicates; ++r) {
    long double exact = 0.0L;
    for (std::uint64_t i = kEnd - kCount; i < kEnd; ++i) {
      const auto p = clray_reference::beam_point({1 ^ key, 0, sobol}, r, static_cast<std::uint32_t>(i));
      const long double x = 2.0L * p[0] - 1.0L, y = 2.0L * p[1] - 1.0L, square = 1.0L - x * x - y * y;
      if (square <= 0.0L) continue;
      exact += std::sqrt(square) / static_cast<long double>(kPi);
      ++expected_hits;
    }
    const long double found = static_cast<long double>(pass.total(sums, r)) / pass.plan.beams.views[0].weight_scale;
    worst = std::max(worst, static_cast<double>(std::fabs(found - exact) / exact));
  }
  const clray::SumBlock& counts = pass.block("delay", 2);  // of bins from below to above the window
  std::uint64_t hits = 0;
  for (std::uint64_t k = 0; k < counts.size(); ++k) hits += sums.counts[counts.offset + k];
  outcome.pass = worst <= kQuantumOfTotal && hits == expected_hits && sums.events[0][CLRAY_COUNT_NON_FINITE] == 0;
  outcome.measured = fmt::format("sums off by up to {:.1e}; {} hits of {}", worst, hits, expected_hits);
  return outcome;
}

Outcome too_many() {
  Scene scene = scene_of(plate_mesh(1, 1), lambert(1.0));
  scene.trace.rays = (16ull << 32) + 1;
  try {
    run(scene);
  } catch (const clray::Error& e) {
    const std::string what = e.what();
    return {e.code() == clray::ErrorCode::usage && what.find("at most 68719476736 rays") != std::string::npos, what};
  }
  return {false, "traced"};
}

/// A unit plate in which all weights are w = mu_o/π.
Scene plate(bool wide) {
  Scene scene = scene_of(plate_mesh(1, 1), lambert(1.0));
  if (wide) bistatic(scene, {0, 0, 1}, toward(0.5));
  detect(scene, "spectrometer");
  scene.trace.replicates = 2;
  scene.trace.sampler = clray::SamplerKind::random;
  return scene;
}

double plate_weight(const Pass& pass) {
  return pass.plan.beams.connections.at(0).direction[2] / kPi;
}

/// Two drains of 2^22 points (a path may enter four times, pass_runner.cpp), each filling the accumulators to the 2^62
/// that plans allow, on top of the largest 64-bit sum.
Outcome full() {
  constexpr std::uint64_t kPoints = 1ull << 23;
  Pass pass(plate(false));
  pass.plan.beams.views[0].weight_limit = 2.0 * plate_weight(pass);
  pass.plan.beams.views[0].weight_scale = 0x1p40 / plate_weight(pass);
  Sums before(pass.plan.layout);
  for (std::size_t k = 0; k < before.values.size(); ++k) before.values.set(k, INT64_MAX);
  const Sums sums = pass.run(kPoints, before);
  const Sum exact = static_cast<Sum>(INT64_MAX) + (static_cast<Sum>(kPoints) << 40);
  Outcome outcome{true, ""};
  for (std::uint32_t r = 0; r < 2; ++r) outcome.pass = outcome.pass && pass.total(sums, r) == exact;
  outcome.measured =
      fmt::format("off by {:g} of {:g}", static_cast<double>(pass.total(sums, 0) - exact), static_cast<double>(exact));
  return outcome;
}

/// Weights that need the second accumulator, with parts that its coarser unit does not hold; then weights above both.
Outcome beyond(double units, bool counted) {
  constexpr std::uint64_t kPoints = 1ull << 16;
  Pass pass(plate(true));
  const double w = plate_weight(pass);
  pass.plan.beams.views[0].weight_limit = 0.5 * w;
  pass.plan.beams.views[0].weight_scale = units / w;
  const Sums sums = pass.run(kPoints);
  const Sum found = pass.total(sums, 0) + pass.total(sums, 1);
  const std::uint64_t overflows = sums.events[0][CLRAY_COUNT_OVERFLOW];
  const double each = static_cast<double>(found) / (2.0 * kPoints);
  const bool kept = std::fabs(each - units) <= 4.0 * 0x1p-53 * units && overflows == 0;
  return {counted ? found == 0 && overflows == 2 * kPoints : kept,
          fmt::format("mean weight {:.17g} of {:.17g} units, {} of {} counted", each, units, overflows, 2 * kPoints)};
}

/// A mirror all but along the light turns it by twice the slope onto a glossy wall that it grazes, seen from where the
/// wall reflects it: weights (n+1)/(16π·slope), while their first-bounce bound stays at (n+1)/(8π)·1000.
Scene grazing_gloss(double slope) {
  auto sheet = std::make_shared<clray::Mesh>(*plate_mesh(1, 1));
  sheet->vertices = {{0, 0, 1}, {slope, 0, 0}, {slope, 1, 0}, {0, 1, 1}};
  Scene scene = scene_of(sheet, mirror());
  auto wall = std::make_shared<clray::Mesh>(*sheet);
  wall->vertices = {{2 * slope, 0, 1}, {2 * slope, 0, -1}, {2 * slope, 1, -1}, {2 * slope, 1, 1}};
  add(scene, wall, ashikhmin_shirley(0.5, 0.0, 10.0));
  bistatic(scene, {0, 0, 1}, {-2 * slope, 0, -1});
  scene.trace.max_bounces = 2;
  scene.trace.sampler = clray::SamplerKind::random;
  return rays(detect(scene, "spectrometer"), 16);
}

Outcome second_accumulator() {
  const clray::Result result = run(grazing_gloss(0x1p-40));
  const clray::Estimate& a = result.spectrometer.at(0).intensity_m2_per_sr;
  // The mirror fills 1 × slope m² of the beam.
  Outcome outcome = near(a.value, a.standard_error, 11.0 / (16.0 * kPi), 1e-10);
  outcome.pass = sound(result, &outcome.measured) && outcome.pass;
  return outcome;
}

Outcome refused() {
  Scene scene = grazing_gloss(0x1p-44);
  std::string what = "no error";
  bool thrown = false;
  try {
    run(scene);
  } catch (const clray::Error& e) {
    what = e.what();
    thrown = e.code() == clray::ErrorCode::bug && what.find("accumulator overflows") != std::string::npos;
  }
  scene.trace.allow_failures = true;
  const clray::Result result = run(scene);
  const std::uint64_t counted = result.diagnostics.accumulator_overflow;
  // Half of the rays meet the mirror: binomial.
  const double n = static_cast<double>(result.rays), off = std::fabs(static_cast<double>(counted) - 0.5 * n);
  const double left = result.spectrometer.at(0).intensity_m2_per_sr.value;
  return {thrown && off <= 2.0 * std::sqrt(n) && left == 0.0, fmt::format("{}; allowed: {} counted", what, counted)};
}

/// Largest weights times the most contributions between two drains, in the plans of unlike scenes.
Outcome headroom() {
  double most = 0.0;
  int plans = 0;
  for (const auto& material :
       {lambert(1.0), lambert(1e-9), ashikhmin_shirley(1.0, 0.0, 1e6), ashikhmin_shirley(0.5, 1.0, 1)})
    for (double phase : {0.0, 1.0, 3.1, kPi})
      for (int bounces : {1, 64}) {
        Scene scene = scene_of(box_mesh(1, 2, 3), material);
        bistatic(scene, {0, 0, 1}, toward(phase));
        scene.trace.max_bounces = bounces;
        const Pass pass(scene);
        const ClrayPass& k = pass.plan.constants;
        const ClrayView& view = pass.plan.beams.views[0];
        const double weights = view.weight_limit * view.weight_scale, units = CLRAY_UNIT_LIMIT * k.unit_scale;
        most = std::max({most, weights * 0x1p24, units * 0x1p24});
        ++plans;
      }
  return {most <= 0x1p62, fmt::format("{} plans: at most 2^{:g}", plans, std::log2(most))};
}

/// A square of two halves of unlike reflectance: every ray hits, weights are 1/π or 1/2π, at random.
Outcome drift(int log2_points) {
  constexpr int kReplicates = 20;
  Scene scene = scene_of(moved(plate_mesh(0.5, 1), {-0.25, 0, 0}), lambert(1.0));
  add(scene, moved(plate_mesh(0.5, 1), {0.25, 0, 0}), lambert(0.5));
  scene.trace.replicates = kReplicates;
  scene.trace.sampler = clray::SamplerKind::random;
  scene.trace.rays = static_cast<std::uint64_t>(kReplicates) << log2_points;
  window(scene, -1e-9, 1e-9, 3);
  const clray::Result result = run(scene);
  const clray::DelayResult& d = result.delay.at(0);
  const double n = static_cast<double>(scene.trace.rays), exact = 0.75 / kPi, sigma = 0.25 / kPi / std::sqrt(n);
  Outcome outcome = near(d.intensity_m2_per_sr.value, d.intensity_m2_per_sr.standard_error, exact, 0.0);
  const double ratio = d.intensity_m2_per_sr.standard_error / sigma;
  const double spread = std::sqrt(0.5 / (kReplicates - 1));
  const std::uint64_t hits = std::accumulate(d.hits.begin(), d.hits.end(), std::uint64_t{0});
  outcome.measured += fmt::format(" = {:.2f} of σ/√N; {} hits of {} rays", ratio, hits, result.rays);
  const bool counted = result.paths.started == hits && result.paths.capped == hits && result.paths.escaped == 0;
  outcome.pass = sound(result, &outcome.measured) && outcome.pass && counted &&
                 std::fabs(ratio - 1.0) <= 4.0 * spread &&
                 std::fabs(d.intensity_m2_per_sr.value - exact) <= 4.0 * sigma && hits == scene.trace.rays &&
                 result.rays == scene.trace.rays && d.hits.at(1) == hits;
  return outcome;
}

}  // namespace

std::vector<Case> statistics_cases() {
  const char* const kPoints = "hits exact; sums 1e-11: half a unit of the sums each";
  const char* const kDrift =
      "4 standard errors, claimed and predicted; 16 % of one of 20 replicates, four times; exact";
  return {
      {"statistics", "points numbered 2³² − 2¹⁴ to 2³², Sobol", "the reference's points", kPoints, true,
       [] { return last_points(true); }},
      {"statistics", "points numbered 2³² − 2¹⁴ to 2³², random", "the reference's points", kPoints, true,
       [] { return last_points(false); }},
      {"statistics", "points beyond 2³²", "refused before anything is traced", "exact", true, too_many},
      {"statistics", "accumulators: largest weights, most contributions", "at most 2^62 between drains", "exact", true,
       headroom},
      {"statistics", "accumulators: twice filled to 2⁶² on top of 2⁶³ − 1", "carried on in 128 bits", "exact", true,
       full},
      {"statistics", "accumulators: weights of 2^40 + 5 units", "the second takes them, with what it rounds away",
       "4 eps: a weight and its scale are rounded", true, [] { return beyond(0x1p40 + 5.0, false); }},
      {"statistics", "accumulators: weights of 2^71 units", "counted as overflow, nothing added", "exact", true,
       [] { return beyond(0x1p71, true); }},
      {"statistics", "gloss grazed at 2^-39 rad: weights of 10¹¹", "(n+1)/16π", "4 standard errors + 1e-10: rounding",
       true, second_accumulator},
      {"statistics", "gloss grazed at 2^-43 rad: weights above both accumulators", "an error, or counted if allowed",
       "4 standard errors of the rays that meet the mirror; total 0: exact", true, refused},
      {"statistics", "2·10⁷ rays in one run", "no drift, honest error, exact counters", kDrift, false,
       [] { return drift(20); }},
      {"statistics", "10^10 rays in one run", "no drift, honest error, exact counters", kDrift, false,
       [] { return drift(29); }, true},
  };
}

}  // namespace clray_test
