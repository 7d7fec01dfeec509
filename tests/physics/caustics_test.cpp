// SPDX-License-Identifier: Apache-2.0
// Light that reaches a picture by way of mirrors: where it falls, how much it is, what stays unseen. Expected values
// are closed forms (plane mirrors light a wall twice, a mirror sphere is R²/4 in every direction, form factors of
// squares at a right angle), or the beam's own detectors, which trace no pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/checks.hpp"

using namespace clray_test;
using clray::Vec3;

namespace {

double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct Total {
  double value = 0.0, error = 0.0;
};

Total total_of(const clray::ImageResult& image) {
  Total t;
  const double area = image.pixel_m * image.pixel_m;
  for (std::size_t p = 0; p < image.coverage.size(); ++p) {
    t.value += image.radiance_per_sr[p] * area;
    t.error = std::hypot(t.error, image.standard_error_per_sr[p] * area);
  }
  return t;
}

/// A mirror floor of 2 x 2 m in z = 0 and a Lambert wall of 2 x 2 m on its edge x = -1, looking to +x.
clray::Scene floor_and_wall(double reflectance, double rho, Vec3 s, Vec3 o) {
  clray::Scene scene = scene_of(plate_mesh(2, 2), mirror(reflectance));
  add(scene, plate_mesh(2, 2), lambert(rho)).transform = {{-1, 0, 1}, {0, 1, 0}, kPi / 2.0, 1.0};
  bistatic(scene, s, o);
  scene.trace.max_bounces = 3;
  detect(scene, "hyperspectral", {{"width", 48.0}, {"height", 48.0}, {"samples", 256.0}});
  return scene;
}

}  // namespace

TEST_CASE("a mirror floor lights the wall up to where its reflection reaches, in the pixels that show it") {
  const Vec3 s = toward(0.9), o(0.8, -0.6, 0.0);
  clray::Scene scene = floor_and_wall(0.8, 0.5, s, o);
  scene.reference_point = {0.3, -0.2, 0.5};
  const clray::ImageResult image = run(scene).image.at(0);
  const double reach = 2.0 * s.z / s.x, once = 0.5 / kPi * s.x, twice = once * 1.8;
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      // The wall's point behind the pixel's middle.
      const double right = image.centre_right_m + (column + 0.5 - 0.5 * image.width) * image.pixel_m;
      const double up = image.centre_up_m + (0.5 * image.height - row - 0.5) * image.pixel_m;
      const Vec3 across = scene.reference_point + right * image.right + up * image.up;
      const Vec3 p = across + ((-1.0 - across.x) / o.x) * o;
      const double margin = 1.5 * image.pixel_m / o.x;
      if (std::fabs(p.y) > 1.0 - margin || p.z < margin || p.z > 2.0 - margin) continue;
      if (std::fabs(p.z - reach) < margin) continue;
      const std::size_t pixel = static_cast<std::size_t>(row * image.width + column);
      const int lit = p.z < reach;
      CAPTURE(p.z);
      // Some 200 rays of the light fall into a pixel, spread evenly.
      CHECK(image.radiance_per_sr[pixel] == relative(lit ? twice : once).epsilon(lit ? 0.25 : 1e-9));
      sums[lit] += image.radiance_per_sr[pixel];
      ++counts[lit];
    }
  }
  REQUIRE(counts[0] > 50);
  REQUIRE(counts[1] > 200);
  CHECK(sums[1] / counts[1] == relative(twice).epsilon(3e-3));
}

TEST_CASE("what mirrors show of what mirrors lit is not in a picture: its power is measured and said") {
  // All light on the floor, 4 cos 45°, goes to the wall, which sends of it the form factor of two squares with a common
  // edge back to the floor: (1/π)·{2 atan 1 − √2 atan(1/√2) + ¼ ln[(4/3)·(3/4)·(3/4)]}.
  const double factor =
      (2.0 * std::atan(1.0) - std::sqrt(2.0) * std::atan(std::sqrt(0.5)) + 0.25 * std::log(4.0 / 3.0 * 9.0 / 16.0)) /
      kPi;
  clray::Scene scene = floor_and_wall(1.0, 1.0, toward(kPi / 4.0), toward(1.43, -kPi / 4.0));
  const clray::Result result = run(scene);
  CHECK(result.image.at(0).unseen_caustics_m2 == relative(4.0 / std::sqrt(2.0) * factor).epsilon(3e-3));
  CHECK(warns(result, "not in the picture"));
  // With two surfaces no such path is asked for; what the floor sends to nobody is that of the wall and its own.
  scene.trace.max_bounces = 2;
  const clray::Result two = run(scene);
  CHECK(two.image.at(0).unseen_caustics_m2 == 0.0);
  CHECK_FALSE(warns(two, "not in the picture"));
}

TEST_CASE("with a cone, a picture has all that the beam's detectors have, and what surfaces look like in mirrors") {
  clray::Scene scene = floor_and_wall(0.9, 0.7, toward(kPi / 4.0), toward(1.43, -kPi / 4.0));
  scene.observers[0].acceptance_rad = 0.05;
  scene.detectors.push_back({"spectrometer", "spectrometer", {}});
  const clray::Result result = run(rays(scene, 20));
  const Total picture = total_of(result.image.at(0));
  const clray::Estimate& beam = result.spectrometer.at(0).intensity_m2_per_sr;
  const double error = std::hypot(picture.error, beam.standard_error);
  INFO("picture ", picture.value, ", beam ", beam.value, " +- ", error);
  // The cone blurs what the beam's detector sees in the mirror, a twentieth of all: by its second order, 0.05²/4.
  CHECK(std::fabs(picture.value - beam.value) <= 4.0 * error + 1e-3 * beam.value);
  CHECK(result.image[0].unseen_caustics_m2 == 0.0);
  scene.observers[0].acceptance_rad = 0.0;
  CHECK(total_of(run(scene).image.at(0)).value < 0.97 * picture.value);
}

TEST_CASE("a mirror sphere in a picture with a cone: R²/4, where its normal halves the angle") {
  const Vec3 o = toward(1.2, 0.7);
  clray::Scene scene = scene_of("sphere", {{"radius", 2.0}}, mirror(0.5));
  bistatic(scene, {0, 0, 1}, o);
  scene.observers[0].acceptance_rad = 0.2;
  detect(scene, "hyperspectral", {{"width", 64.0}, {"height", 64.0}, {"samples", 256.0}});
  const clray::ImageResult image = run(scene).image.at(0);
  const Total t = total_of(image);
  INFO(t.value, " +- ", t.error);
  CHECK(std::fabs(t.value - 0.5) <= 4.0 * t.error);
  CHECK(t.error <= 0.01);
  const double half = std::sqrt(2.0 + 2.0 * o.z);
  const Vec3 glint = 2.0 * Vec3(o.x / half, o.y / half, (o.z + 1.0) / half);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const double right = image.centre_right_m + (column + 0.5 - 0.5 * image.width) * image.pixel_m;
      const double up = image.centre_up_m + (0.5 * image.height - row - 0.5) * image.pixel_m;
      // The normal turns by half of the cone's 0.2 rad; out of the plane of reflection by that over cos 0.6.
      const double distance = std::hypot(right - dot(glint, image.right), up - dot(glint, image.up));
      if (distance > 2.0 * 0.1 / std::cos(0.6) + image.pixel_m)
        CHECK(image.radiance_per_sr[static_cast<std::size_t>(row * image.width + column)] == 0.0);
    }
  }
}

TEST_CASE("a dish lights a ball in its focus from below: picture and beam agree, in every orientation") {
  clray::Scene scene = scene_of("paraboloid", {{"radius", 1.0}, {"depth", 0.2}}, mirror(0.9));
  add(scene, "sphere", {{"radius", 0.2}}, lambert(0.8)).transform.translate = {0.0, 0.0, 1.25};
  bistatic(scene, {0, 0, 1}, {1, 0, 0});
  scene.trace.max_bounces = 4;
  // Spin about the light: seen from the side, the dish's outside shows nothing that is lit.
  scene.motion = clray::Motion{{0, 0, 1}, 10.0, 0.0, 0.0, 5.0, kPi / 2.0, {}};
  detect(scene, "hyperspectral", {{"width", 32.0}, {"height", 32.0}, {"samples", 256.0}});
  scene.detectors.push_back({"spectrometer", "spectrometer", {}});
  const clray::Result result = run(rays(scene, 18));
  REQUIRE(result.image.size() == result.spectrometer.size());
  REQUIRE(result.image.size() >= 2);
  for (std::size_t v = 0; v < result.image.size(); ++v) {
    const Total picture = total_of(result.image[v]);
    const clray::Estimate& beam = result.spectrometer[v].intensity_m2_per_sr;
    const double error = std::hypot(picture.error, beam.standard_error);
    INFO("orientation ", v, ": picture ", picture.value, ", beam ", beam.value, " +- ", error);
    CHECK(std::fabs(picture.value - beam.value) <= 4.0 * error + 1e-9);
    CHECK(error <= 0.01 * beam.value);
    // A ball alone sends a tenth of it.
    CHECK(beam.value > 0.1);
  }
}
