// SPDX-License-Identifier: Apache-2.0
// Views are independent: each has the bits that it has alone, whatever stands beside it; it stops by its own error; and
// two views share no random numbers.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "clray/trace.hpp"
#include "support/checks.hpp"

using namespace clray_test;
using clray::Result;
using clray::Scene;

namespace {

/// One turn about y in so many steps.
clray::Motion full_turn(int steps) {
  clray::Motion motion;
  motion.axis = {0.0, 1.0, 0.0};
  motion.period_s = 360.0;
  motion.step_rad = 2.0 * kPi / steps;
  motion.stop_s = 360.0 * (steps - 0.5) / steps;
  return motion;
}

/// A box and a wing that spin between a source and an observer that stand 40 degrees apart.
Scene spinning(int steps) {
  Scene scene = scene_of(box_mesh(1.0, 2.0, 1.5), ashikhmin_shirley(0.6, 0.5, 20.0));
  add(scene, moved(plate_mesh(3.0, 1.0), {2.5, 0.0, 0.1}), lambert(0.3));
  bistatic(scene, toward(1.1), toward(1.8));
  scene.motion = full_turn(steps);
  detect(scene, "spectrometer");
  scene.detectors.push_back({"delay", "delay", {{"bins", 32}, {"start_ns", -30.0}, {"stop_ns", 30.0}}});
  scene.detectors.push_back({"pressure", "pressure", {}});
  scene.trace.max_bounces = 2;
  return scene;
}

/// The scene as it stands in one view, without a motion.
Scene alone(Scene scene, const clray::Orientation& view) {
  scene.motion.reset();
  scene.source.direction = view.source;
  scene.observers[0].direction = view.observers[0];
  return scene;
}

void same(const clray::Estimate& a, const clray::Estimate& b) {
  CHECK(a.value == b.value);
  CHECK(a.standard_error == b.standard_error);
}

void same(const clray::VectorEstimate& a, const clray::VectorEstimate& b) {
  CHECK(a.value == b.value);
  CHECK(a.standard_error == b.standard_error);
}

/// Every record of view v of `all` has the bits of `one`.
void same_records(const Result& all, std::size_t v, const Result& one) {
  CAPTURE(v);
  REQUIRE(one.delay.size() == 1);
  same(all.spectrometer.at(v).intensity_m2_per_sr, one.spectrometer.at(0).intensity_m2_per_sr);
  const clray::DelayResult &a = all.delay.at(v), &b = one.delay.at(0);
  same(a.intensity_m2_per_sr, b.intensity_m2_per_sr);
  same(a.mean_delay_s, b.mean_delay_s);
  same(a.rms_width_s, b.rms_width_s);
  CHECK(a.bin_m2_per_sr == b.bin_m2_per_sr);
  CHECK(a.bin_standard_error == b.bin_standard_error);
  CHECK(a.hits == b.hits);
  same(all.pressure.at(v).coefficient_m2, one.pressure.at(0).coefficient_m2);
  same(all.pressure.at(v).torque_coefficient_m3, one.pressure.at(0).torque_coefficient_m3);
  same(all.pressure.at(v).absorbed_m2, one.pressure.at(0).absorbed_m2);
}

}  // namespace

TEST_CASE("a view has the same bits alone and among others, with given rays") {
  Scene scene = spinning(9);
  rays(scene, 14);
  const Result all = run(scene);
  REQUIRE(all.orientations.size() == 9);
  std::uint64_t traced = 0;
  for (std::size_t v = 0; v < 9; ++v) {
    const Result one = run(alone(scene, all.orientations[v]));
    same_records(all, v, one);
    traced += one.rays_total;
  }
  CHECK(all.rays_total == traced);
}

TEST_CASE("each view stops by its own error, where it stops alone") {
  Scene scene = spinning(8);
  scene.trace.target_error_percent = 0.3;
  const Result all = run(scene);
  CHECK(all.target_reached);
  std::set<std::uint64_t> rays;
  std::uint64_t traced = 0;
  double worst = 0.0;
  for (std::size_t v = 0; v < 8; ++v) {
    const Result one = run(alone(scene, all.orientations[v]));
    same_records(all, v, one);
    rays.insert(one.rays);
    traced += one.rays_total;
    worst = std::max(worst, one.reached_percent);
  }
  CHECK(rays.size() > 1);  // else the scene shows nothing
  CHECK(all.rays == *rays.rbegin());
  CHECK(all.rays_total == traced);
  CHECK(all.reached_percent == worst);
}

TEST_CASE("views share no random numbers") {
  // A Lambert sphere looks alike from everywhere. If views shared their points, their errors would be one error; as
  // they do not, the mean over the views is off by at most 4 of its standard errors.
  constexpr int kSteps = 90;
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(1.0));
  monostatic(scene, {0.0, 0.0, 1.0});
  scene.motion = full_turn(kSteps);
  scene.trace.sampler = clray::SamplerKind::random;
  const Result result = run(rays(detect(scene, "spectrometer"), 12));
  REQUIRE(result.spectrometer.size() == kSteps);
  const double exact = 2.0 / 3.0;  // πR²·2/(3π)
  double sum = 0.0, variance = 0.0, squares = 0.0;
  for (const clray::SpectrometerResult& s : result.spectrometer) {
    const double error = s.intensity_m2_per_sr.value - exact;
    sum += error;
    squares += error * error;
    variance += s.intensity_m2_per_sr.standard_error * s.intensity_m2_per_sr.standard_error;
  }
  CHECK(std::fabs(sum) < 4.0 * std::sqrt(variance));
  CHECK(squares > 0.5 * variance);  // errors are real: chi square of 90 is below 45 once in 10^4
  CHECK(squares < 1.6 * variance);
}
