// SPDX-License-Identifier: Apache-2.0
// Radiation pressure against closed forms, per projected area: plates, spheres, cylinders, cones; torque, shadow,
// mirrors that send light twice, and thermal re-radiation. Within 4 standard errors and 0.1 %.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"
#include "support/some.hpp"

using namespace clray_test;
using clray::Vec3;

namespace {

constexpr double kBound = 1e-3;
constexpr double kTwoThirds = 2.0 / 3.0;

double norm(Vec3 v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}
Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

clray::PressureResult pressure_of(clray::Scene& scene, int log2_rays = 20,
                                  const std::map<std::string, double>& keys = {}) {
  detect(scene, "pressure", keys);
  many_rays(scene, log2_rays);
  return run(scene).pressure.at(0);
}

void check_vector(const clray::VectorEstimate& found, Vec3 exact, double scale, const char* what, double dim = 1.0) {
  for (int k = 0; k < 3; ++k)
    check_component(found.value[k], found.standard_error[k], exact[k], scale, kBound, what, dim);
}

}  // namespace

TEST_CASE("plates at 0, 30, 60 and 85 degrees: black, Lambert, mirror") {
  const Vec3 n{0, 0, 1};
  for (double degrees : some(2, {60.0, 85.0, 0.0, 30.0})) {
    CAPTURE(degrees);
    const Vec3 s = toward(radians(degrees));
    const double mu = s.z, lit = 2.0 * mu;  // 2 m² of plate
    struct Case {
      const char* name;
      clray::Material material;
      Vec3 exact;
    };
    for (const Case& c :
         {Case{"black", lambert(0.0), -lit * s}, Case{"Lambert", lambert(1.0), -lit * (s + kTwoThirds * n)},
          Case{"half Lambert", lambert(0.5), -lit * (s + 0.5 * kTwoThirds * n)},
          Case{"mirror", mirror(1.0), -2.0 * lit * mu * n}}) {
      clray::Scene scene = scene_of(plate_mesh(2.0, 1.0), c.material);
      monostatic(scene, s);
      check_vector(pressure_of(scene).coefficient_m2, c.exact, norm(c.exact), c.name, 1.0 / mu);
    }
  }
}

TEST_CASE("spheres: black 1, mirror 1, Lambert 13/9 of the cross-section") {
  struct Case {
    clray::Material material;
    double exact;
  };
  for (const Case& c : {Case{lambert(0.0), 1.0}, Case{mirror(1.0), 1.0}, Case{lambert(1.0), 13.0 / 9.0}}) {
    clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, c.material);
    const Vec3 s = toward(0.7, 0.4);
    monostatic(scene, s);
    const clray::PressureResult found = pressure_of(scene);
    check_vector(found.coefficient_m2, -(kPi * c.exact) * s, kPi * c.exact, "sphere");
    check_vector(found.torque_coefficient_m3, {0, 0, 0}, kPi, "a centred sphere's torque");
  }
}

TEST_CASE("cylinder broadside: mirror 4/3, Lambert 1 + pi/6; cone apex-on: 1 + (2/3) sin(beta), 2 sin^2(beta)") {
  const std::map<std::string, double> tube = {{"radius", 1.0}, {"height", 3.0}, {"capped", 1.0}};
  for (const bool shiny : {true, false}) {
    const clray::Material m = shiny ? mirror(1.0) : lambert(1.0);
    clray::Scene cylinder = scene_of("cylinder", tube, m);
    monostatic(cylinder, {1, 0, 0});
    const double side = 6.0 * (shiny ? 4.0 / 3.0 : 1.0 + kPi / 6.0);
    check_vector(pressure_of(cylinder).coefficient_m2, {-side, 0, 0}, side, "cylinder");
    clray::Scene cone = scene_of("cone", {{"radius", 1.0}, {"height", 2.0}, {"capped", 1.0}}, m);
    const double sine = 1.0 / std::sqrt(5.0);
    const double apex = kPi * (shiny ? 2.0 * sine * sine : 1.0 + kTwoThirds * sine);
    check_vector(pressure_of(cone).coefficient_m2, {0, 0, -apex}, apex, "cone");
  }
}

TEST_CASE("torque of an off-centre plate is lever times force, about any reference point") {
  const Vec3 centre{1.5, -2.0, 0.7}, s = toward(radians(30.0), 0.5);
  clray::Scene scene = scene_of(moved(plate_mesh(2.0, 1.0), centre), lambert(0.0));
  monostatic(scene, s);
  const Vec3 force = (-2.0 * s.z) * s, torque = cross(centre, force);
  const clray::PressureResult found = pressure_of(scene);
  check_vector(found.coefficient_m2, force, norm(force), "force");
  check_vector(found.torque_coefficient_m3, torque, norm(torque), "torque");
  scene.reference_point = {0.5, 0.5, 0.5};
  const Vec3 moved_torque = cross(centre - scene.reference_point, force);
  check_vector(pressure_of(scene).torque_coefficient_m3, moved_torque, norm(moved_torque), "torque elsewhere");
}

TEST_CASE("L-shape: the wall's shadow leaves 1 - tan(theta) of the floor lit, component by component") {
  const double theta = radians(30.0);
  const Vec3 s = toward(theta);
  clray::Scene scene = scene_of(plate_mesh(1, 1), lambert(0.0));
  clray::Component& wall = add(scene, plate_mesh(1, 1), lambert(0.0));
  wall.transform.axis = {0, 1, 0};
  wall.transform.angle_rad = radians(90.0);
  wall.transform.translate = {0.5, 0, 0.5};
  monostatic(scene, s);
  const clray::PressureResult found = pressure_of(scene);
  REQUIRE(found.component_m2.size() == 2);
  const double floor = std::cos(theta) * (1.0 - std::tan(theta)), upright = std::sin(theta);
  check_vector(found.component_m2[0], -floor * s, floor, "floor");
  check_vector(found.component_m2[1], -upright * s, upright, "wall");
  check_vector(found.coefficient_m2, -(floor + upright) * s, floor + upright, "both");
  check_estimate(found.absorbed_m2, floor + upright, kBound, "absorbed");
}

TEST_CASE("all bounces count: a mirror dihedral sends its light back and takes twice its momentum") {
  const double h = std::sqrt(0.5);
  clray::Scene scene = scene_of(plate_mesh(1, 1), mirror(1.0));
  scene.components[0].transform = {{-h / 2, 0, h / 2}, {0, 1, 0}, radians(45.0), 1.0};
  add(scene, plate_mesh(1, 1), mirror(1.0)).transform = {{h / 2, 0, h / 2}, {0, 1, 0}, radians(-45.0), 1.0};
  scene.trace.max_bounces = 4;
  const double exact = 2.0 * 2.0 * h;
  check_vector(pressure_of(scene).coefficient_m2, {0, 0, -exact}, exact, "dihedral");
}

TEST_CASE("thermal re-radiation of absorbed light pushes with 2/3 along the normal") {
  const Vec3 s = toward(radians(30.0)), n{0, 0, 1};
  for (double infrared : {0.0, 0.25}) {
    clray::Material m = lambert(0.4);
    m.infrared_reflectance = infrared;
    clray::Scene scene = scene_of(plate_mesh(2.0, 1.0), m);
    monostatic(scene, s);
    const double heat = 0.6 * (1.0 - infrared);
    const Vec3 exact = (-2.0 * s.z) * (s + kTwoThirds * (0.4 + heat) * n);
    check_vector(pressure_of(scene, 20, {{"thermal", 1.0}}).coefficient_m2, exact, norm(exact), "warm plate");
  }
}

TEST_CASE("a grid of Sun directions: the black sphere's push turns with each") {
  clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.0));
  detect(scene, "pressure", {{"azimuth_steps", 4.0}, {"elevation_steps", 3.0}});
  many_rays(scene, 16);
  const clray::Result result = run(scene);
  // Elevations -90, 0 and 90 degrees; a pole has one azimuth.
  CHECK(result.pressure.size() == 6);
  for (const clray::PressureResult& p : result.pressure) {
    CHECK(norm(p.sun) == relative(1.0).epsilon(1e-12));
    check_vector(p.coefficient_m2, -kPi * p.sun, 10.0 * kPi, "sphere in the grid");
  }
}

TEST_CASE("cannonball: 1367 W/m^2 on 1 m^2 with C_R = 1 is 4.56e-6 N") {
  clray::Scene scene = scene_of("sphere", {{"radius", 1.0 / std::sqrt(kPi)}}, lambert(0.0));
  const double force = norm(pressure_of(scene).coefficient_m2.value) * 1367.0 / kLightSpeed;
  CHECK(force == relative(4.56e-6).epsilon(1.1e-3));  // the last digit given
}
