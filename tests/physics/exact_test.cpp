// SPDX-License-Identifier: Apache-2.0
// The exact pulse against closed forms, against another method in long double, and against points. Numbers are
// integers of a unit near 2^-61 of the beam times the largest weight; coordinates carry the rounding of fp64. So closed
// forms must hold to 1e-12, unless a test says otherwise.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "reference/visible_area.hpp"
#include "support/checks.hpp"

using namespace clray_test;

namespace {

constexpr double kExact = 1e-12;

clray::Result solve(clray::Scene scene) {
  scene.trace.method = clray::Method::exact;
  scene.trace.rays = 0;
  return run(scene);
}

clray::Scene lambert_scene(const MeshPtr& mesh, clray::Vec3 s, double rho = 0.5) {
  clray::Scene scene = scene_of(mesh, lambert(rho));
  monostatic(scene, s);
  return scene;
}

const clray::Estimate& total(const clray::Result& result) {
  return result.delay.at(0).intensity_m2_per_sr;
}

/// A is as it must be, to 1e-12 or the bound that it claims, and its parts add up.
void check_exact(const clray::Result& result, double expected) {
  const clray::DelayResult& d = result.delay.at(0);
  CHECK(total(result).value == relative(expected).epsilon(kExact));
  CHECK(total(result).standard_error == 0.0);
  CHECK(total(result).low == total(result).high);
  CHECK(total(result).rounding_bound >= std::fabs(total(result).value - expected) * (1.0 - 1e-3));
  CHECK(total(result).rounding_bound < 1e-10 * expected);
  double sum = d.below_m2_per_sr + d.above_m2_per_sr;
  for (const double bin : d.bin_m2_per_sr) sum += bin;
  CHECK(sum == relative(total(result).value).epsilon(kExact));
  CHECK(d.hits.empty());
  CHECK(result.rays == 0);
}

void check_exact_bins(const clray::Result& result, const Pulse& exact) {
  const clray::DelayResult& d = result.delay.at(0);
  for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
    const double start = d.first_bin_start_s + static_cast<double>(b) * d.bin_width_s;
    const double expected = exact.total_m2_per_sr * (exact.share(start + d.bin_width_s) - exact.share(start));
    CAPTURE(b);
    // A border is placed to some 1e-16 of the path over the width of a bin.
    CHECK(std::fabs(d.bin_m2_per_sr[b] - expected) <= 1e-11 * exact.total_m2_per_sr);
  }
}

MeshPtr mesh_of(const std::vector<std::array<clray::Vec3, 3>>& triangles) {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  for (const auto& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), t.begin(), t.end());
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangle_slot.push_back(0);
  }
  return mesh;
}

std::vector<std::array<clray::Vec3, 3>> soup(std::uint64_t seed, int count, double size) {
  std::mt19937_64 random(seed);
  const auto number = [&] { return 2.0 * std::ldexp(static_cast<double>(random() >> 11), -53) - 1.0; };
  std::vector<std::array<clray::Vec3, 3>> triangles;
  for (int k = 0; k < count; ++k) {
    const clray::Vec3 p(number(), number(), number());
    std::array<clray::Vec3, 3> t;
    for (auto& corner : t) corner = p + size * clray::Vec3(number(), number(), number());
    triangles.push_back(t);
  }
  return triangles;
}

/// A of a soup of Lambert faces from +z, by the reference.
long double reference_total(const std::vector<std::array<clray::Vec3, 3>>& triangles, double rho) {
  std::vector<clray_reference::SoupTriangle> soup;
  for (const auto& t : triangles) {
    clray_reference::SoupTriangle r;
    for (int k = 0; k < 3; ++k) r.corners[k] = {t[k].x, t[k].y, t[k].z};
    soup.push_back(r);
  }
  const std::vector<long double> areas = clray_reference::visible_areas(soup);
  long double sum = 0.0L;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const auto& c = soup[k].corners;
    const long double ax = static_cast<long double>(c[1][0]) - c[0][0],
                      ay = static_cast<long double>(c[1][1]) - c[0][1],
                      az = static_cast<long double>(c[1][2]) - c[0][2];
    const long double bx = static_cast<long double>(c[2][0]) - c[0][0],
                      by = static_cast<long double>(c[2][1]) - c[0][1],
                      bz = static_cast<long double>(c[2][2]) - c[0][2];
    const long double nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
    sum += areas[k] * std::fabs(nz) / std::sqrt(nx * nx + ny * ny + nz * nz);
  }
  return sum * rho / std::acos(-1.0L);
}

}  // namespace

TEST_CASE("exact plates, boxes and prisms against closed forms, with their bins") {
  for (const double degrees : {0.0, 20.0, 60.0, 89.0}) {
    CAPTURE(degrees);
    const double tilt = radians(degrees);
    const clray::Result result = solve(lambert_scene(plate_mesh(2.0, 1.0), toward(tilt)));
    const Pulse exact = lambert_plate(0.5, 2.0, 1.0, tilt);
    check_exact(result, exact.total_m2_per_sr);
    if (degrees == 0.0) continue;
    check_exact_bins(result, exact);
    const double length_s = 4.0 * std::sin(tilt) / kLightSpeed;
    CHECK(std::fabs(result.delay.at(0).mean_delay_s.value) <= kExact * length_s);
    CHECK(result.delay.at(0).rms_width_s.value == relative(length_s / std::sqrt(12.0)).epsilon(1e-11));
  }
  for (const MeshPtr& mesh : {box_mesh(1.0, 2.0, 3.0), prism_mesh(6, 1.0, 1.0), sphere_mesh(24, 12, 1.0)}) {
    for (const clray::Vec3& s : {toward(0.0), toward(0.9, 0.5), toward(2.5, -2.0)}) {
      const Pulse exact = convex_lambert(*mesh, 0.6, s, s);
      const clray::Result result = solve(lambert_scene(mesh, s, 0.6));
      check_exact(result, exact.total_m2_per_sr);
    }
  }
}

TEST_CASE("a plate that faces the light lies in one bin") {
  const clray::Result result = solve(lambert_scene(plate_mesh(2.0, 1.0), toward(0.0)));
  int lit = 0;
  for (const double bin : result.delay.at(0).bin_m2_per_sr) lit += bin != 0.0;
  CHECK(lit == 1);
}

TEST_CASE("box, rectangle and hinged shapes count as polygons, curved shapes do not") {
  clray::Scene box = scene_of("box", {{"size_x", 1.0}, {"size_y", 2.0}, {"size_z", 3.0}}, lambert(0.6));
  monostatic(box, toward(0.9, 0.5));
  check_exact(solve(box),
              convex_lambert(*box_mesh(1.0, 2.0, 3.0), 0.6, toward(0.9, 0.5), toward(0.9, 0.5)).total_m2_per_sr);
  clray::Scene sphere = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  CHECK_THROWS_WITH_AS(solve(sphere), doctest::Contains("curved shape"), clray::Error);
  clray::Scene bounces = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  bounces.trace.max_bounces = 2;
  CHECK_THROWS_WITH_AS(solve(bounces), doctest::Contains("several bounces"), clray::Error);
  clray::Scene two = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  bistatic(two, toward(0.4), toward(0.5));
  CHECK_THROWS_WITH_AS(solve(two), doctest::Contains("not at the source"), clray::Error);
  clray::Scene rayed = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  rayed.trace.method = clray::Method::exact;
  CHECK_THROWS_WITH_AS(run(rayed), doctest::Contains("rays"), clray::Error);
}

TEST_CASE("plates behind plates, and plates that cross, against closed forms") {
  // A plate of 1 x 1 before one of 2 x 2: what is seen of the second is 3 m².
  const MeshPtr behind = merged({plate_mesh(2.0, 2.0), moved(plate_mesh(1.0, 1.0), {0.25, -0.125, 1.0})});
  check_exact(solve(lambert_scene(behind, toward(0.0))), 0.5 / kPi * 4.0);
  // Two plates at +-45 degrees that cross along y: of each, the half that is nearer is seen.
  const double h = 1.0;
  std::vector<std::array<clray::Vec3, 3>> cross;
  for (const double sign : {1.0, -1.0}) {
    const clray::Vec3 a(-h, -1, -sign * h), b(h, -1, sign * h), c(h, 1, sign * h), d(-h, 1, -sign * h);
    cross.push_back({a, b, c});
    cross.push_back({a, c, d});
  }
  const clray::Result result = solve(lambert_scene(mesh_of(cross), toward(0.0)));
  // 4 m² across the beam, cosine sqrt(1/2) everywhere; depth |x| uniform from 0 to 1.
  const double a = 0.5 / kPi * 4.0 * std::sqrt(0.5);
  check_exact(result, a);
  const Cdf depth = two_way([](double d) { return std::min(1.0, std::max(0.0, d + 1.0)); });
  check_exact_bins(result, {a, depth});
}

TEST_CASE("soups against scanlines in long double, and the claimed bound of rounding") {
  // The reference is quadratic and more; scripts/test --long takes larger soups.
  const int count = std::getenv("CLRAY_LONG_TESTS") != nullptr ? 120 : 40;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const double size : {0.6, 1.5}) {
      CAPTURE(seed);
      const auto triangles = soup(seed, count, size);
      const long double expected = reference_total(triangles, 0.5);
      const clray::Result result = solve(lambert_scene(mesh_of(triangles), toward(0.0)));
      const double off = static_cast<double>(std::fabs(total(result).value - expected));
      CHECK(off <= 1e-11 * static_cast<double>(expected));
      CHECK(off <= total(result).rounding_bound);
    }
  }
}

TEST_CASE("many small soups, sparse and dense: the claimed bound of rounding holds") {
  const std::uint64_t soups = std::getenv("CLRAY_LONG_TESTS") != nullptr ? 1000 : 100;
  double closest = 0.0;
  for (std::uint64_t seed = 1; seed <= soups; ++seed) {
    const auto triangles = soup(100 + seed, 12, seed % 2 == 0 ? 0.5 : 2.0);
    const long double expected = reference_total(triangles, 0.5);
    const clray::Estimate a = total(solve(lambert_scene(mesh_of(triangles), toward(0.0))));
    closest = std::max(closest, static_cast<double>(std::fabs(a.value - expected)) / a.rounding_bound);
  }
  CHECK(closest > 0.0);
  CHECK(closest <= 1.0);
}

TEST_CASE("faces given twice, turned and shuffled change no bit of an exact pulse") {
  auto triangles = soup(7, 60, 0.8);
  const clray::Result once = solve(lambert_scene(mesh_of(triangles), toward(0.4, 0.3)));
  for (std::size_t k = 0; k < 42; ++k) triangles.push_back({triangles[k][1], triangles[k][2], triangles[k][0]});
  std::reverse(triangles.begin(), triangles.end());
  const clray::Result twice = solve(lambert_scene(mesh_of(triangles), toward(0.4, 0.3)));
  CHECK(twice.digest == once.digest);
}

TEST_CASE("points agree with the exact pulse within their errors") {
  const MeshPtr bodies[] = {merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})}),
                            bowl_mesh(24, 12, 1.0, 0.3, 2.0), mesh_of(soup(11, 100, 0.7))};
  for (const MeshPtr& mesh : bodies) {
    clray::Scene scene = lambert_scene(mesh, toward(0.7, 0.4));
    const clray::Result exact = solve(scene);
    rays(scene, 20);
    scene.trace.method = clray::Method::points;
    const clray::Result points = run(scene);
    check_estimate(total(points), total(exact).value, 5e-3, "points");
    CHECK(points.delay.at(0).bin_width_s == exact.delay.at(0).bin_width_s);
  }
}

TEST_CASE("variants, bands and several windows are those of runs alone") {
  clray::Scene scene = lambert_scene(mesh_of(soup(3, 50, 0.8)), toward(0.2, 0.1));
  clray::Variant dull{"dull", {scene.materials.front()}};
  dull.materials.front().parameters["rho"] = 0.25;
  scene.variants = {{"as is", {}}, dull};
  scene.detectors.push_back({"delay", "fine", {{"bins", 64.0}, {"start_ns", -2.0}, {"stop_ns", 1.0}}});
  const clray::Result both = solve(scene);
  REQUIRE(both.delay.size() == 4);
  for (const clray::DelayResult& d : both.delay) {
    const double rho = d.key.variant == "dull" ? 0.25 : 0.5;
    clray::Scene alone = lambert_scene(mesh_of(soup(3, 50, 0.8)), toward(0.2, 0.1), rho);
    if (d.key.detector == "fine") alone.detectors = {scene.detectors.back()};
    const clray::DelayResult single = solve(alone).delay.at(0);
    CHECK(d.intensity_m2_per_sr.value == relative(single.intensity_m2_per_sr.value).epsilon(1e-15));
    for (std::size_t b = 0; b < single.bin_m2_per_sr.size(); ++b)
      CHECK(std::fabs(d.bin_m2_per_sr[b] - single.bin_m2_per_sr[b]) <= 1e-15 * single.intensity_m2_per_sr.value);
  }
}

TEST_CASE("automatic takes the exact method where it can, and rays where they are asked for") {
  clray::Scene scene = lambert_scene(box_mesh(1, 1, 1), toward(0.4));
  scene.trace.method = clray::Method::automatic;
  scene.trace.rays = 0;
  CHECK(total(run(scene)).exact());
  scene.trace.target_error_percent = 0.5;
  const clray::Result reached = run(scene);
  CHECK(total(reached).exact());
  CHECK(reached.target_reached);
  CHECK(reached.stopped_by == "exact");
  rays(scene, 14);
  CHECK(!total(run(scene)).exact());
}

TEST_CASE("force and torque on plates and boxes against closed forms, even and mirroring") {
  const clray::Vec3 s = toward(0.7, 0.4), n(0.0, 0.0, 1.0);
  const double mu = s.z, area = 2.0 * mu, rho = 0.6;
  for (const bool shiny : {false, true}) {
    CAPTURE(shiny);
    clray::Scene scene = scene_of(moved(plate_mesh(2.0, 1.0), {0.5, -0.25, 0.125}), shiny ? mirror(rho) : lambert(rho));
    monostatic(scene, s);
    detect(scene, "pressure");
    const clray::Result result = solve(scene);
    const clray::PressureResult& p = result.pressure.at(0);
    const clray::Vec3 sent = shiny ? rho * (2.0 * mu * n - s) : 2.0 / 3.0 * rho * n;
    const clray::Vec3 force = area * (-s - sent), r(0.5, -0.25, 0.125);
    const clray::Vec3 torque(r.y * force.z - r.z * force.y, r.z * force.x - r.x * force.z,
                             r.x * force.y - r.y * force.x);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::fabs(p.coefficient_m2.value[k] - force[k]) <= kExact * area);
      CHECK(std::fabs(p.torque_coefficient_m3.value[k] - torque[k]) <= kExact * area);
      CHECK(p.coefficient_m2.standard_error[k] == 0.0);
    }
    CHECK(p.coefficient_m2.rounding_bound < 1e-11 * area);
    CHECK(p.absorbed_m2.value == relative((1.0 - rho) * area).epsilon(kExact));
    const clray::EnergyBooks& books = result.energy.at(0);
    CHECK(books.incident_m2.value == relative(area).epsilon(kExact));
    CHECK(std::isnan(books.truncated_m2.value));
  }
}

TEST_CASE("a grid of Sun directions on a body that hides parts of itself agrees with points") {
  clray::Scene scene =
      scene_of(merged({box_mesh(1.0, 1.0, 2.0), moved(plate_mesh(3.0, 1.0), {2.25, 0.0, 0.125})}), lambert(0.4));
  scene.reference_point = {0.1, 0.2, 0.3};
  detect(scene, "pressure", {{"azimuth_steps", 6.0}, {"elevation_steps", 5.0}, {"thermal", 1.0}});
  const clray::Result exact = solve(scene);
  rays(scene, 16);
  const clray::Result points = run(scene);
  REQUIRE(points.pressure.size() == exact.pressure.size());
  for (std::size_t k = 0; k < exact.pressure.size(); ++k) {
    const clray::PressureResult &e = exact.pressure[k], &p = points.pressure[k];
    CHECK(e.sun == p.sun);
    for (int axis = 0; axis < 3; ++axis) {
      check_component(p.coefficient_m2.value[axis], p.coefficient_m2.standard_error[axis], e.coefficient_m2.value[axis],
                      1.0, 0.02, "force");
      check_component(p.torque_coefficient_m3.value[axis], p.torque_coefficient_m3.standard_error[axis],
                      e.torque_coefficient_m3.value[axis], 1.0, 0.05, "torque");
    }
  }
}
