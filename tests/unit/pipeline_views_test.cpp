// SPDX-License-Identifier: Apache-2.0
// Where rays start: the beam rectangle in closed form, and the grid of Sun directions. Expected values are worked out
// here in long double.
#include <doctest/doctest.h>

#include <algorithm>

#include "beam/beams.hpp"
#include "beam/illumination.hpp"
#include "body/geometry.hpp"
#include "clray/error.hpp"
#include "clray/sizes.hpp"
#include "pipeline/plan.hpp"
#include "unit/pipeline_support.hpp"

using namespace clray;
using namespace pipeline_test;

namespace {

PassPlan beam_of(Scene scene, const Vec3& source) {
  scene.source.direction = source;
  scene.trace.sampler = clray::SamplerKind::random;  // plain sampling covers the whole rectangle
  return plan_passes(scene, build_geometry(scene)).front();
}

LPoint load(const double* p) {
  return {p[0], p[1], p[2]};
}

/// CHECKs the rectangle of a body with these vertices: spans their projection exactly and starts outside.
void check_rectangle(const PassPlan& plan, const std::vector<LPoint>& vertices, double size) {
  const ClrayView& view = plan.beams.views.front();
  const LPoint s = load(view.toward), corner = load(view.corner);
  const LPoint u = load(view.edge_u), v = load(view.edge_v);
  const long double lu = std::sqrt(dot(u, u)), lv = std::sqrt(dot(v, v));
  CHECK(std::fabs(static_cast<double>(dot(u, v) / (lu * lv))) < 8 * kEps);
  CHECK(std::fabs(static_cast<double>(dot(u, s) / lu)) < 8 * kEps);
  CHECK(std::fabs(static_cast<double>(dot(v, s) / lv)) < 8 * kEps);
  long double low[3] = {1e300L, 1e300L, 1e300L}, high[3] = {-1e300L, -1e300L, -1e300L};
  for (const LPoint& x : vertices) {
    const long double h[3] = {dot(x, u) / lu, dot(x, v) / lv, dot(x, s)};
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], h[k]);
      high[k] = std::max(high[k], h[k]);
    }
  }
  const double tolerance = 32 * kEps * size;  // a dozen products of fp64 each
  CHECK(std::fabs(static_cast<double>(dot(corner, u) / lu - low[0])) < tolerance);
  CHECK(std::fabs(static_cast<double>(dot(corner, v) / lv - low[1])) < tolerance);
  CHECK(std::fabs(static_cast<double>(lu - (high[0] - low[0]))) < tolerance);
  CHECK(std::fabs(static_cast<double>(lv - (high[1] - low[1]))) < tolerance);
  CHECK(static_cast<double>(dot(corner, s) - high[2]) > 1e-3 * size);
  CHECK(plan.beams.area_m2.front() ==
        doctest::Approx(static_cast<double>((high[0] - low[0]) * (high[1] - low[1]))).epsilon(64 * kEps * size));
}

}  // namespace

TEST_CASE("the beam rectangle of a turned box is the bound of its eight corners, as a shape and as a mesh") {
  std::mt19937_64 random(3);
  const double half[3] = {0.5, 1.1, 0.2};
  for (int k = 0; k < 40; ++k) {
    CAPTURE(k);
    const Transform t = k == 0 ? Transform() : random_transform(random);
    const Vec3 s = k % 4 == 1 ? Vec3(0, 0, 1) : k % 4 == 2 ? Vec3(0, 0, -1) : random_direction(random);
    std::vector<LPoint> corners;
    Mesh mesh;
    for (int c = 0; c < 8; ++c) {
      const Vec3 v((c & 1 ? 1 : -1) * half[0], (c & 2 ? 1 : -1) * half[1], (c & 4 ? 1 : -1) * half[2]);
      mesh.vertices.push_back(v);
      corners.push_back(placed(t, point_of(v)));
    }
    for (const auto& f : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                          {4, 5, 7, 6},
                          {0, 1, 5, 4},
                          {2, 6, 7, 3},
                          {0, 4, 6, 2},
                          {1, 3, 7, 5}}) {
      mesh.triangles.push_back({f[0], f[1], f[2]});
      mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    mesh.triangle_slot.assign(12, 0);
    mesh.material_slots = {""};
    const double size = 4.0 + 2.5 * t.scale;
    Scene scene = empty_scene();
    add_shape(scene, "box", {{"size_x", 1.0}, {"size_y", 2.2}, {"size_z", 0.4}}).transform = t;
    check_rectangle(beam_of(scene, s), corners, size);
    Scene meshed = empty_scene();
    add_mesh(meshed, mesh).transform = t;
    check_rectangle(beam_of(meshed, s), corners, size);
    // The closed form of the area: for axes a and b across s, each width is twice the sum of half_i |R^T a|_i.
    const PassPlan plan = beam_of(scene, s);
    long double area = 1.0L;
    for (const double* edge : {plan.beams.views[0].edge_u, plan.beams.views[0].edge_v}) {
      LPoint a = load(edge);
      const long double l = std::sqrt(dot(a, a));
      a = turn(point_of(t.axis), -static_cast<long double>(t.angle_rad), {a[0] / l, a[1] / l, a[2] / l});
      area *= 2 * t.scale * (half[0] * std::fabs(a[0]) + half[1] * std::fabs(a[1]) + half[2] * std::fabs(a[2]));
    }
    CHECK(plan.beams.area_m2[0] == doctest::Approx(static_cast<double>(area)).epsilon(64 * kEps * size));
  }
}

TEST_CASE("for a source at +z or -z the beam's axes are x and y exactly") {
  Scene scene = empty_scene();
  add_shape(scene, "box", {{"size_x", 1.0}, {"size_y", 2.0}, {"size_z", 3.0}});
  for (const double z : {1.0, -1.0}) {
    const PassPlan plan = beam_of(scene, {0, 0, z});
    const ClrayView& view = plan.beams.views[0];
    CHECK(std::fabs(view.edge_u[0]) == 1.0);
    CHECK(view.edge_u[1] == 0.0);
    CHECK(view.edge_u[2] == 0.0);
    CHECK(view.edge_v[0] == 0.0);
    CHECK(std::fabs(view.edge_v[1]) == 2.0);
    CHECK(view.edge_v[2] == 0.0);
    CHECK(plan.beams.area_m2[0] == 2.0);
  }
}

TEST_CASE("Sun directions: poles once, every other elevation all around, exact at right angles") {
  Scene scene = empty_scene();
  add_shape(scene, "box", {});
  scene.detectors[0].kind = "pressure";
  scene.detectors[0].parameters = {{"azimuth_steps", 8}, {"elevation_steps", 5}};
  const std::vector<PassPlan> passes = plan_passes(scene, build_geometry(scene));
  REQUIRE(passes.size() == 1);
  REQUIRE(passes[0].request.grid);
  REQUIRE(passes[0].request.orientations.size() == 2 + 3 * 8);
  REQUIRE(passes[0].beams.views.size() == 2 + 3 * 8);
  std::size_t at = 0;
  for (int e = 0; e < 5; ++e)
    for (int a = 0; a < (e == 0 || e == 4 ? 1 : 8); ++a, ++at) {
      const long double elevation = (-90 + 45 * e) * 3.14159265358979323846264L / 180;
      const long double azimuth = 45 * a * 3.14159265358979323846264L / 180;
      const LPoint expected{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation)};
      const Vec3 found = passes[0].request.orientations[at].source;
      for (int k = 0; k < 3; ++k) {
        CHECK(std::fabs(static_cast<double>(found[k] - expected[k])) < 4 * kEps);
        CHECK(passes[0].beams.views[at].toward[k] == found[k]);
        if (std::fabs(expected[k]) < 1e-15L) CHECK(found[k] == 0.0);
        if (std::fabs(std::fabs(expected[k]) - 1) < 1e-15L) CHECK(std::fabs(found[k]) == 1.0);
      }
    }
  for (int degrees = 0; degrees <= 360; ++degrees) {  // whole circle, against long double
    const long double r = degrees * 3.14159265358979323846264L / 180;
    const Vec3 v = direction_from_degrees(degrees, 0.0);
    CHECK(std::fabs(static_cast<double>(v.x - std::cos(r))) < 4 * kEps);
    CHECK(std::fabs(static_cast<double>(v.y - std::sin(r))) < 4 * kEps);
    CHECK(v.z == 0.0);
  }
}

TEST_CASE("views know the range of each observer at their time, and 0 where nothing says it") {
  Scene scene = empty_scene();
  add_shape(scene, "box", {});
  scene.observers = {Observer{}, Observer{}, Observer{}};
  scene.observers[1].monostatic = scene.observers[2].monostatic = false;
  scene.observers[1].direction = scene.observers[2].direction = {1, 0, 0};
  scene.observers[2].range_m = 5e5;
  scene.motion = Motion{};
  scene.motion->period_s = 8.0;
  scene.motion->step_rad = 3.14159265358979323846;
  scene.motion->stop_s = 8.0;
  CHECK(views_of_motion(scene)[0].ranges_m == std::vector<double>{0.0, 0.0, 5e5});
  scene.station = Station{};
  scene.station->ranges = {{0.0, 1e6}, {4.0, 3e6}};
  const std::vector<Orientation> views = views_of_motion(scene);
  REQUIRE(views.size() == 3);
  CHECK(views[0].ranges_m == std::vector<double>{1e6, 1e6, 5e5});
  CHECK(views[1].ranges_m == std::vector<double>{3e6, 3e6, 5e5});
  CHECK(views[2].ranges_m == std::vector<double>{0.0, 0.0, 5e5});  // beyond the table
  CHECK(views_of_grid(scene, 4, 3)[1].ranges_m == views[0].ranges_m);
}

TEST_CASE("bins of an automatic window are judged before anything is traced, with their number and the detector") {
  Scene scene = empty_scene();
  add_shape(scene, "sphere", {{"radius", 1.0}});
  const auto said = [&] {
    try {
      check_windows(scene);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  // Paths by way of a sphere of 1 m go over 4 m, which light takes 13343 ps for.
  scene.detectors = {{"delay", "camera", {{"bin_ps", 1e-2}}}};
  CHECK(said().empty());
  scene.detectors[0].parameters["bin_ps"] = 1e-3;
  CHECK(said() == "detectors[0].bin_ps: 0.001 ps makes 1.34e+07 bins, at most 1e7 expected");
  scene.detectors[0].parameters = {{"bin_ps", 1e-3}, {"start_ns", 0.0}, {"stop_ns", 1.0}};
  CHECK(said().empty());
  // 8e6 bins of 500 orientations take 1.7 TB.
  scene.detectors[0].parameters = {{"bin_ps", 1.7e-3}, {"start_ns", -7.0}};
  scene.motion = Motion{};
  scene.motion->period_s = scene.motion->stop_s = 1.0;
  scene.motion->step_rad = 0.0126;
  CHECK(said().find("detectors[0].bin_ps: the results need about ") == 0);
}
