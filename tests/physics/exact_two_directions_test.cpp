// SPDX-License-Identifier: Apache-2.0
// Exact numbers of observers off the beam: what is lit and seen. Against closed forms, against another method in long
// double, against points, and against itself where a law says that it must agree. Coordinates carry the rounding of
// fp64, so closed forms must hold to 1e-12.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "reference/lit_and_seen.hpp"
#include "support/exact_checks.hpp"

using namespace clray_test;

namespace {

clray::Scene seen(const MeshPtr& mesh, clray::Vec3 s, clray::Vec3 o, double rho = 0.5) {
  clray::Scene scene = scene_of(mesh, lambert(rho));
  return bistatic(scene, s, o);
}

clray::Vec3 unit(clray::Vec3 v) {
  const double length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / length, v.y / length, v.z / length};
}

std::array<double, 3> array_of(clray::Vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace

TEST_CASE("two directions: convex bodies against the sum over facets") {
  for (const MeshPtr& mesh :
       {plate_mesh(2.0, 1.0), box_mesh(1.0, 2.0, 3.0), prism_mesh(6, 1.0, 1.0), sphere_mesh(24, 12, 1.0)}) {
    for (const double phase : {0.001, 0.4, 1.2, 2.4}) {
      CAPTURE(phase);
      const clray::Vec3 s = toward(0.3, 0.2), o = toward(0.3 + phase, 0.25);
      const Pulse exact = convex_lambert(*mesh, 0.6, s, o);
      if (exact.total_m2_per_sr > 0.0) check_exact(solve(seen(mesh, s, o, 0.6)), exact.total_m2_per_sr);
    }
  }
}

TEST_CASE("two directions: bins and moments of a plate") {
  const clray::Vec3 s = unit({0.6, 0.3, 0.7}), o = unit({0.1, -0.8, 0.5});
  const double x = s.x + o.x, y = s.y + o.y;  // path length is -(x, y)·place
  const clray::Result result = solve(seen(plate_mesh(2.0, 1.0), s, o));
  const double a = 0.5 / kPi * 2.0 * s.z * o.z;
  check_exact(result, a);
  // The sum of two even spreads, of half widths |x| and |y|/2 about 0: mean 0, variance (x² + y²/4)/3.
  const double rms = std::sqrt((x * x + 0.25 * y * y) / 3.0) / kLightSpeed;
  const clray::DelayResult& d = result.delay.at(0);
  CHECK(std::fabs(d.mean_delay_s.value) <= kExact * rms);
  CHECK(d.rms_width_s.value == relative(rms).epsilon(1e-11));
  const double p = std::fabs(x), q = 0.5 * std::fabs(y);
  const auto share = [&](double path) {  // of the sum of two even spreads: a trapezium, integrated
    const auto ramp = [](double v) { return v > 0.0 ? v * v : 0.0; };
    return (ramp(path + p + q) - ramp(path + p - q) - ramp(path - p + q) + ramp(path - p - q)) / (8.0 * p * q);
  };
  for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
    const double start = kLightSpeed * (d.first_bin_start_s + static_cast<double>(b) * d.bin_width_s);
    const double expected = a * (share(start + kLightSpeed * d.bin_width_s) - share(start));
    CAPTURE(b);
    // A border is placed to some 1e-16 of the path over the width of a bin.
    CHECK(std::fabs(d.bin_m2_per_sr[b] - expected) <= 1e-11 * a);
  }
}

TEST_CASE("two directions: a plate's shadow and what it hides, apart and overlapping") {
  // A plate of 1 x 1, 1 m before one of 8 x 8. Its shadow is moved by s.xy/s.z, what it hides by o.xy/o.z.
  const MeshPtr both = merged({plate_mesh(8.0, 8.0), moved(plate_mesh(1.0, 1.0), {0.25, -0.125, 1.0})});
  struct Case {
    clray::Vec3 s, o;
    double covered_m2;  // of the large plate
  };
  for (const Case& c : {Case{{0.25, 0.25, 1}, {-0.25, 0.125, 1}, 2.0 - 0.5 * 0.875},
                        Case{{0.75, 0.0, 1}, {-0.75, 0.0, 1}, 2.0}, Case{{0.5, 0.0, 1}, {0.5, 1e-3, 1}, 2.0 - 0.999}}) {
    const clray::Vec3 s = unit(c.s), o = unit(c.o);
    check_exact(solve(seen(both, s, o)), 0.5 / kPi * s.z * o.z * (64.0 + 1.0 - c.covered_m2));
    check_exact(solve(seen(both, o, s)), 0.5 / kPi * s.z * o.z * (64.0 + 1.0 - c.covered_m2));
  }
}

TEST_CASE("two directions: soups against shadows on each face's plane, in long double") {
  const int soups = long_tests() ? 40 : 8;
  for (int seed = 1; seed <= soups; ++seed) {
    for (const double size : {0.6, 1.5}) {
      CAPTURE(seed);
      const Triangles triangles = soup(static_cast<std::uint64_t>(seed), 24, size);
      const clray::Vec3 s = toward(0.1 * seed, 0.3), o = toward(0.5 + 0.05 * seed, 2.0 * seed);
      std::vector<clray_reference::SoupTriangle> judged;
      for (const auto& t : triangles) judged.push_back({{array_of(t[0]), array_of(t[1]), array_of(t[2])}});
      const auto areas = clray_reference::lit_and_seen_areas(judged, array_of(s), array_of(o));
      const auto mu_s = clray_reference::cosines(judged, array_of(s)),
                 mu_o = clray_reference::cosines(judged, array_of(o));
      long double expected = 0.0L;
      for (std::size_t k = 0; k < areas.size(); ++k) expected += areas[k] * mu_s[k] * mu_o[k];
      expected *= 0.5L / std::acos(-1.0L);
      const clray::Result result = solve(seen(mesh_of(triangles), s, o));
      const double off = static_cast<double>(std::fabs(total(result).value - expected));
      CHECK(off <= 1e-11 * static_cast<double>(expected));
      CHECK(off <= total(result).rounding_bound);
    }
  }
}

TEST_CASE("two directions: source and observer may change places") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const MeshPtr mesh = mesh_of(soup(seed, 120, 0.7));
    const clray::Vec3 s = toward(0.7, 0.4), o = toward(0.4, 3.0);
    const clray::Estimate there = total(solve(seen(mesh, s, o))), back = total(solve(seen(mesh, o, s)));
    CHECK(there.value == relative(back.value).epsilon(kExact));
    CHECK(std::fabs(there.value - back.value) <= there.rounding_bound + back.rounding_bound);
  }
}

TEST_CASE("two directions: faces given twice, turned and shuffled change no bit") {
  Triangles triangles = soup(7, 60, 0.8);
  const clray::Result once = solve(seen(mesh_of(triangles), toward(0.4, 0.3), toward(1.3, 2.0)));
  for (std::size_t k = 0; k < 42; ++k) triangles.push_back({triangles[k][1], triangles[k][2], triangles[k][0]});
  std::reverse(triangles.begin(), triangles.end());
  const clray::Result twice = solve(seen(mesh_of(triangles), toward(0.4, 0.3), toward(1.3, 2.0)));
  CHECK(twice.digest == once.digest);
}

TEST_CASE("two directions: an observer who is at the source after all sees the monostatic pulse") {
  const MeshPtr mesh = mesh_of(soup(5, 80, 0.8));
  clray::Scene scene = scene_of(mesh, lambert(0.5));
  monostatic(scene, toward(0.6, 0.1));
  const clray::Estimate one = total(solve(scene));
  scene.trace.force_bistatic = true;
  const clray::Estimate two = total(solve(scene));
  CHECK(two.value == relative(one.value).epsilon(kExact));
  CHECK(two.rounding_bound > one.rounding_bound);
}

TEST_CASE("two directions: points agree within their errors, bin by bin") {
  const MeshPtr bodies[] = {merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})}),
                            bowl_mesh(24, 12, 1.0, 0.3, 2.0), mesh_of(soup(11, 100, 0.7))};
  for (const MeshPtr& mesh : bodies) {
    clray::Scene scene = seen(mesh, toward(0.7, 0.4), toward(0.2, -1.0));
    const clray::Result exact = solve(scene);
    many_rays(scene, 20);
    const clray::Result points = run(scene);
    const clray::DelayResult &e = exact.delay.at(0), &p = points.delay.at(0);
    check_estimate(p.intensity_m2_per_sr, e.intensity_m2_per_sr.value, 5e-3, "points");
    check_estimate(p.mean_delay_s, e.mean_delay_s.value, 5e-3, "mean delay");
    check_estimate(p.rms_width_s, e.rms_width_s.value, 5e-3, "rms width");
    double chi2 = 0.0;
    int bins = 0;
    for (std::size_t b = 0; b < e.bin_m2_per_sr.size(); ++b) {
      if (!p.resolved[b] || p.hits[b] < 1000) continue;
      const double t = (p.bin_m2_per_sr[b] - e.bin_m2_per_sr[b]) / p.bin_standard_error[b];
      chi2 += t * t;
      ++bins;
    }
    REQUIRE(bins > 20);
    // t² of 15 degrees of freedom has mean 15/13 and standard deviation 2.0; bins are nearly independent.
    CHECK(chi2 <= bins * 15.0 / 13.0 + 5.0 * 2.0 * std::sqrt(bins));
  }
}

TEST_CASE("two directions: several observers, detectors and variants are those of runs alone") {
  const MeshPtr mesh = mesh_of(soup(3, 50, 0.8));
  const clray::Vec3 s = toward(0.2, 0.1), places[] = {toward(0.9, 2.0), s, toward(1.4, -1.0)};
  clray::Scene scene = scene_of(mesh, lambert(0.5));
  bistatic(scene, s, places[0]);
  const clray::Observer like = scene.observers.front();
  scene.observers.clear();
  for (int k = 0; k < 3; ++k) {
    scene.observers.push_back(like);
    scene.observers.back().direction = places[k];
    scene.observers.back().monostatic = k == 1;
    scene.observers.back().name = "o" + std::to_string(k);
  }
  clray::Variant dull{"dull", {scene.materials.front()}};
  dull.materials.front().parameters["rho"] = 0.25;
  scene.variants = {{"as is", {}}, dull};
  scene.detectors.push_back({"pressure", "push", {}});
  const clray::Result all = solve(scene);
  REQUIRE(all.delay.size() == 6);
  for (const clray::DelayResult& d : all.delay) {
    const double rho = d.key.variant == "dull" ? 0.25 : 0.5;
    const auto k = static_cast<std::size_t>(d.key.observer.back() - '0');
    const clray::DelayResult single = solve(seen(mesh, s, places[k], rho)).delay.at(0);
    CHECK(d.intensity_m2_per_sr.value == relative(single.intensity_m2_per_sr.value).epsilon(1e-15));
    CHECK(d.bin_width_s == relative(single.bin_width_s).epsilon(1e-15));
    for (std::size_t b = 0; b < single.bin_m2_per_sr.size(); ++b)
      CHECK(std::fabs(d.bin_m2_per_sr[b] - single.bin_m2_per_sr[b]) <= 1e-12 * single.intensity_m2_per_sr.value);
  }
  clray::Scene pushed = seen(mesh, s, s);
  detect(pushed, "pressure");
  const clray::Result by_itself = solve(pushed);
  const clray::PressureResult &alone = by_itself.pressure.at(0), &beside = all.pressure.at(0);
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(alone.coefficient_m2.value[k] - beside.coefficient_m2.value[k]) <= 1e-15);
}
