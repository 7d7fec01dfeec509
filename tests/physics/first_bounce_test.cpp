// SPDX-License-Identifier: Apache-2.0
// The first bounce solved and the rest from rays. Closed forms: two Lambert plates at a right angle
// (support/corner.hpp) and a mirror wall beside a Lambert floor.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "support/checks.hpp"
#include "support/corner.hpp"
#include "support/coverage.hpp"

using namespace clray_test;

namespace {

double sum_of(const clray::DelayResult& d) {
  double sum = d.below_m2_per_sr + d.above_m2_per_sr;
  for (const double bin : d.bin_m2_per_sr) sum += bin;
  return sum;
}

const clray::Estimate& total(const clray::Result& result) {
  return result.delay.at(0).intensity_m2_per_sr;
}

/// Median over the bins of a pulse of the standard error over that in another.
double median_error_ratio(const clray::DelayResult& a, const clray::DelayResult& b) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < a.bin_m2_per_sr.size(); ++k) {
    if (b.bin_standard_error[k] > 0.0) ratios.push_back(a.bin_standard_error[k] / b.bin_standard_error[k]);
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios.at(ratios.size() / 2);
}

}  // namespace

TEST_CASE("a corner of two Lambert plates: the first bounce is exact, the second is claimed with its error") {
  for (const clray::Vec3& s : {toward(0.5), toward(1.2, 0.2), toward(0.8, -1.1)}) {
    for (const auto& [floor, wall] : {std::pair(0.8, 0.8), std::pair(0.9, 0.2)}) {
      CAPTURE(s.x);
      const CornerLight light = corner_light(floor, wall, s, s);
      clray::Scene scene = corner(lambert(floor), lambert(wall), s, 2, 16);
      scene.detectors.push_back({"spectrometer", "spectrometer", {}});
      const clray::Result result = run(scene);
      const clray::DelayResult& d = result.delay.at(0);
      const clray::Estimate& a = d.intensity_m2_per_sr;
      CHECK(a.exact_part == relative(light.first).epsilon(1e-12));
      CHECK(a.rounding_bound < 1e-12 * light.first);
      CHECK(a.partly_exact());
      CHECK(!a.exact());
      // A sixteenth of 2^16 rays a replicate, of which one in four finds a second plate: some 1 % of that light.
      check_estimate(a, light.first + light.second, 0.01 * light.second / light.first, "two bounces");
      CHECK(a.standard_error > 0.0);
      CHECK(sum_of(d) == relative(a.value).epsilon(1e-12));
      const clray::Estimate& same = result.spectrometer.at(0).intensity_m2_per_sr;
      CHECK(same.value == a.value);
      CHECK(same.exact_part == a.exact_part);
    }
  }
}

TEST_CASE("a corner seen from elsewhere, and by two observers at once") {
  const clray::Vec3 s = toward(0.5), o = toward(1.1, 0.4);
  const CornerLight light = corner_light(0.8, 0.5, s, o), back = corner_light(0.8, 0.5, s, s);
  clray::Scene scene = corner(lambert(0.8), lambert(0.5), s, 2, 16);
  clray::Observer elsewhere;
  elsewhere.name = "elsewhere";
  elsewhere.monostatic = false;
  elsewhere.direction = o;
  scene.observers.push_back(elsewhere);
  scene.observers.front().name = "station";
  const clray::Result result = run(scene);
  for (const clray::DelayResult& d : result.delay) {
    CAPTURE(d.key.observer);
    const CornerLight& expected = d.key.observer == "station" ? back : light;
    CHECK(d.intensity_m2_per_sr.exact_part == relative(expected.first).epsilon(1e-12));
    check_estimate(d.intensity_m2_per_sr, expected.first + expected.second, 0.01 * expected.second / expected.first,
                   "two bounces");
    CHECK(sum_of(d) == relative(d.intensity_m2_per_sr.value).epsilon(1e-12));
  }
}

TEST_CASE("the digest covers what is solved: a plate moved along the light, which rays cannot tell") {
  std::vector<std::uint64_t> digests;
  for (const double depth : {0.25, 0.5}) {
    clray::Scene scene =
        scene_of(merged({plate_mesh(1.0, 1.0), moved(plate_mesh(1.0, 1.0), {3.0, 0.0, depth})}), lambert(0.5));
    scene.trace.max_bounces = 2;
    scene.trace.method = clray::Method::exact;
    digests.push_back(run(rays(scene, 10)).digest);
  }
  CHECK(digests[0] != digests[1]);
}

TEST_CASE("bins of a corner hold the first bounce's closed form and what rays found beside it") {
  const clray::Vec3 s = toward(1.0, 0.3);
  const MeshPtr both = merged({floor_mesh(), wall_mesh()});
  const double rho = 0.7;
  // A per m² of a Lambert plate.
  const Pulse first = monostatic_facets(*both, s, [&](double mu) { return rho / kPi * mu * mu; });
  clray::Scene scene = corner(lambert(rho), lambert(rho), s, 2);
  const clray::DelayResult few = run(rays(scene, 10)).delay.at(0), many = run(rays(scene, 18, 2)).delay.at(0);
  int empty = 0;
  double unlike = 0.0, count = 0.0;
  for (std::size_t b = 0; b < few.bin_m2_per_sr.size(); ++b) {
    const double start = few.first_bin_start_s + static_cast<double>(b) * few.bin_width_s;
    const double solved = first.total_m2_per_sr * (first.share(start + few.bin_width_s) - first.share(start));
    CAPTURE(b);
    CHECK(few.bin_m2_per_sr[b] >= solved - 1e-11 * first.total_m2_per_sr);
    if (few.hits[b] == 0) {
      ++empty;
      CHECK(std::fabs(few.bin_m2_per_sr[b] - solved) <= 1e-11 * first.total_m2_per_sr);
      CHECK(few.bin_standard_error[b] > 0.0);  // rays that missed the bin are no proof of darkness
    }
    if (!few.resolved[b]) CHECK(few.bin_upper_bound[b] >= solved);
    if (!few.resolved[b] || !many.resolved[b]) continue;
    const double error = std::hypot(few.bin_standard_error[b], many.bin_standard_error[b]);
    unlike += std::pow((few.bin_m2_per_sr[b] - many.bin_m2_per_sr[b]) / error, 2);
    count += 1.0;
  }
  CHECK(empty > 10);
  CHECK(count > 100.0);
  // Student's t² of 15 degrees of freedom is 15/13 on average; bins with few hits claim more.
  CHECK(unlike / count < 1.5);
}

TEST_CASE("a mirror wall lights a Lambert floor again: no connection of the first bounce is the mirror's") {
  const double rho = 0.6, reflectance = 0.9;
  for (const double tilt : {0.3, 0.6}) {
    const clray::Vec3 s = toward(tilt);
    const double reach = std::min(kFloor, kWall * s.x / s.z) * kEdge;  // of the floor that the wall lights
    const double first = rho / kPi * s.z * s.z * kFloor * kEdge, second = reflectance * rho / kPi * s.z * s.z * reach;
    const clray::Estimate a = total(run(corner(lambert(rho), mirror(reflectance), s, 2, 16)));
    CHECK(a.exact_part == relative(first).epsilon(1e-12));
    check_estimate(a, first + second, 1e-3, "floor lit twice");
    // One bounce: mirrors reach nobody without a cone.
    const clray::Result one = run(corner(lambert(rho), mirror(reflectance), s, 1));
    CHECK(total(one).value == relative(first).epsilon(1e-12));
    CHECK(total(one).exact_part == total(one).value);
    // All that the mirror sends on meets the floor, and a part of what the floor does meets the mirror.
    const double again = reflectance * s.x * kWall + rho * s.z * kFloor * form_factor();
    check_estimate(one.energy.at(0).truncated_m2, again * kEdge, 0.02, "cut off");
  }
}

TEST_CASE("four bounces agree with points, whose errors in bins are larger at equal rays") {
  const clray::Vec3 s = toward(0.9, 0.4);
  const MeshPtr box_wing = merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})});
  clray::Scene scenes[] = {corner(lambert(0.8), ashikhmin_shirley(0.5, 0.3, 20.0), s, 4),
                           scene_of(box_wing, ashikhmin_shirley(0.5, 0.8, 20.0))};
  monostatic(scenes[1], s).trace.max_bounces = 4;
  for (clray::Scene& scene : scenes) {
    double variance[2] = {}, ratios = 0.0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      rays(scene, 16, seed);
      scene.trace.method = clray::Method::exact;
      const clray::Result mixed = run(scene);
      scene.trace.method = clray::Method::points;
      const clray::Result points = run(scene);
      const clray::Estimate &a = total(mixed), &b = total(points);
      CHECK(std::fabs(a.value - b.value) <= 4.0 * std::hypot(a.standard_error, b.standard_error));
      const clray::DelayResult &first = mixed.delay.at(0), &second = points.delay.at(0);
      for (const auto moment : {&clray::DelayResult::mean_delay_s, &clray::DelayResult::rms_width_s}) {
        const clray::Estimate &x = first.*moment, &y = second.*moment;
        CHECK(std::fabs(x.value - y.value) <= 4.0 * std::hypot(x.standard_error, y.standard_error));
      }
      variance[0] += a.standard_error * a.standard_error;
      variance[1] += b.standard_error * b.standard_error;
      ratios += 0.25 * median_error_ratio(mixed.delay.at(0), points.delay.at(0));
      const clray::EnergyBooks &x = mixed.energy.at(0), &y = points.energy.at(0);
      CHECK(std::fabs(x.reflected_m2.value - y.reflected_m2.value) <=
            4.0 * std::hypot(x.reflected_m2.standard_error, y.reflected_m2.standard_error));
      CHECK(std::fabs(x.absorbed_m2.value - y.absorbed_m2.value) <=
            4.0 * std::hypot(x.absorbed_m2.standard_error, y.absorbed_m2.standard_error));
    }
    INFO("standard errors ", std::sqrt(variance[0]), " and ", std::sqrt(variance[1]), "; of bins ", ratios);
    // Four variances of 15 degrees of freedom each: known to 18 %.
    CHECK(variance[0] < 1.4 * variance[1]);
    CHECK(ratios < 0.5);
  }
}

TEST_CASE("intervals of totals and bins hold the truth 95 % of the time") {
  const clray::Vec3 s = toward(0.8, 0.5);
  const CornerLight light = corner_light(0.8, 0.6, s, s);
  clray::Scene scene = corner(lambert(0.8), lambert(0.6), s, 2);
  window(scene, -14e-9, 12e-9, 16);
  const std::uint64_t seeds = long_tests() ? 400 : 48;
  const clray::DelayResult truth = run(rays(scene, long_tests() ? 22 : 19, 1000)).delay.at(0);
  Coverage totals, bins;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const clray::DelayResult d = run(rays(scene, 12, seed)).delay.at(0);
    totals.add(d.intensity_m2_per_sr, light.first + light.second);
    for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
      if (!d.resolved[b] || d.hits[b] == 0) continue;
      const double half = 2.1314495 * d.bin_standard_error[b], value = d.bin_m2_per_sr[b];
      bins.add({value, d.bin_standard_error[b], value - half, value + half, 0.0}, truth.bin_m2_per_sr[b]);
    }
  }
  INFO("totals ", totals.text(), ", bins ", bins.text());
  CHECK(totals.no_error == 0);
  // 40 of 48 or fewer: one in 10^4 at 95 %.
  if (long_tests()) {
    CHECK(totals.fair());
  } else {
    CHECK(totals.held > 40);
  }
  CHECK(bins.intervals > 100);
  CHECK(bins.share() > 0.90);
  CHECK(bins.share() < 0.99);
}

TEST_CASE("where rays find nothing beside the first bounce, the claim is that of one ray that they may have missed") {
  // Two plates side by side do not see one another.
  clray::Scene scene =
      scene_of(merged({plate_mesh(1.0, 1.0), moved(plate_mesh(1.0, 1.0), {3.0, 0.0, 0.5})}), lambert(0.5));
  monostatic(scene, toward(0.6)).trace.max_bounces = 3;
  scene.trace.method = clray::Method::exact;
  const clray::DelayResult d = run(rays(scene, 14)).delay.at(0);
  const double mu = std::cos(0.6), exact = 0.5 / kPi * mu * mu * 2.0;
  CHECK(d.intensity_m2_per_sr.value == relative(exact).epsilon(1e-12));
  // 3/16 of a ray of 2^10 at 95 %: over t95 of 15 degrees of freedom.
  CHECK(d.intensity_m2_per_sr.standard_error == relative(exact * 3.0 / 16.0 / 2.1314495 / 1024.0).epsilon(1e-6));
  CHECK(d.mean_delay_s.standard_error > 0.0);
  CHECK(d.rms_width_s.standard_error > 0.0);
  for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
    CHECK(d.bin_standard_error[b] == relative(exact * 3.0 / 2.1314495 / 16384.0).epsilon(1e-6));
    CHECK(static_cast<bool>(d.resolved[b]) == (d.bin_standard_error[b] <= std::sqrt(0.1) * d.bin_m2_per_sr[b]));
  }
}

TEST_CASE("which runs have their first bounce solved") {
  clray::Scene scene = corner(lambert(0.5), lambert(0.5), toward(0.7), 3);
  scene.trace.method = clray::Method::automatic;
  CHECK(!total(run(rays(scene, 12))).partly_exact());  // rays ask for points
  scene.trace.rays = 0;
  scene.trace.target_error_percent = 1.0;
  const clray::Result reached = run(scene);
  CHECK(total(reached).partly_exact());
  CHECK(reached.target_reached);
  CHECK(reached.stopped_by == "target");
  CHECK(reached.rays > 0);
  CHECK(0.5 * (total(reached).high - total(reached).low) <= 0.01 * total(reached).value);
  scene.trace.method = clray::Method::points;
  CHECK(!total(run(scene)).partly_exact());
  scene.trace.method = clray::Method::exact;
  detect(scene, "pressure");
  CHECK(run(scene).pressure.at(0).coefficient_m2.partly_exact());
  scene.materials.front() = ashikhmin_shirley(0.5, 0.5, 10.0);
  CHECK_THROWS_WITH_AS(run(scene), doctest::Contains("neither evenly nor as a mirror"), clray::Error);
  clray::Scene mirrors = corner(mirror(0.9), mirror(0.9), toward(0.7), 3);
  CHECK_THROWS_WITH_AS(run(mirrors), doctest::Contains("every material is a mirror"), clray::Error);
}

TEST_CASE("variants, parts in another order and other detectors change nothing of a run whose first bounce is solved") {
  const clray::Vec3 s = toward(0.7, 0.3);
  clray::Scene scene = corner(lambert(0.5), lambert(0.7), s, 3, 14);
  const clray::DelayResult alone = run(scene).delay.at(0);
  const std::uint64_t digest = run(scene).digest;
  clray::Scene turned = scene;
  std::swap(turned.components[0], turned.components[1]);
  CHECK(run(turned).digest == digest);
  clray::Scene generic = scene;
  generic.trace.specialise = false;
  CHECK(run(generic).digest == digest);
  clray::Variant dull{"dull", {scene.materials.front()}};
  dull.materials.front().parameters["rho"] = 0.25;
  scene.variants = {{"as is", {}}, dull};
  scene.trace.method = clray::Method::automatic;
  scene.trace.rays = 0;
  scene.trace.max_rays = 1u << 14;
  scene.trace.target_error_percent = 1e-3;
  detect(scene, "delay");
  scene.detectors.push_back({"pressure", "pressure", {}});
  const clray::Result both = run(scene);
  REQUIRE(both.delay.size() == 2);
  CHECK(both.pressure.size() == 2);
  const clray::Estimate &as_is = both.delay[0].intensity_m2_per_sr, &other = both.delay[1].intensity_m2_per_sr;
  CHECK(as_is.exact_part == alone.intensity_m2_per_sr.exact_part);
  CHECK(as_is.value == alone.intensity_m2_per_sr.value);  // the same rays
  CHECK(other.exact_part == relative(corner_light(0.25, 0.7, s, s).first).epsilon(1e-12));
}
