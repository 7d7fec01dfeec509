// SPDX-License-Identifier: Apache-2.0
// Pictures and cubes against closed forms: radiance of a Lambert plate, and sums over the picture that must equal
// the intensity and the outline of a sphere.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"

using namespace clray_test;

namespace {

struct Sums {
  double intensity = 0.0, error = 0.0, outline_m2 = 0.0;
};

/// Over one band: intensity I/E = ∫ L dA across the view, its standard error, and the covered area.
Sums sums_of(const clray::ImageResult& image, std::size_t band) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  REQUIRE(image.radiance_per_sr.size() >= (band + 1) * pixels);
  REQUIRE(image.coverage.size() == pixels);
  Sums s;
  const double pixel_m2 = image.pixel_m * image.pixel_m;
  double variance = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    s.intensity += image.radiance_per_sr[band * pixels + i] * pixel_m2;
    variance += std::pow(image.standard_error_per_sr[band * pixels + i] * pixel_m2, 2);
    s.outline_m2 += static_cast<double>(image.coverage[i]) * pixel_m2;
  }
  s.error = std::sqrt(variance);
  return s;
}

}  // namespace

TEST_CASE("picture of a Lambert plate: radiance rho/pi cos(theta) in every covered pixel") {
  const double theta = radians(40.0);
  clray::Scene scene = scene_of(plate_mesh(2.0, 1.0), lambert(0.5));
  bistatic(scene, toward(theta), {0, 0, 1});
  detect(scene, "rgb", {{"width", 64.0}, {"height", 48.0}, {"samples", 16.0}});
  const clray::ImageResult image = run(scene).image.at(0);
  CHECK(image.width == 64);
  CHECK(image.height == 48);
  int full = 0;
  for (std::size_t i = 0; i < image.coverage.size(); ++i)
    if (image.coverage[i] > 0.9999f) {
      ++full;
      CHECK(image.radiance_per_sr[i] == relative(0.5 / kPi * std::cos(theta)).epsilon(1e-6));
    } else if (image.coverage[i] == 0.0f) {
      CHECK(image.radiance_per_sr[i] == 0.0);
    }
  CHECK(full > 100);
}

TEST_CASE("picture of a Lambert sphere: its pixels add up to its intensity and outline, at every phase") {
  for (double degrees : {0.0, 60.0, 110.0}) {
    CAPTURE(degrees);
    clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.8));
    const double alpha = radians(degrees);
    degrees == 0.0 ? monostatic(scene, toward(0.3)) : bistatic(scene, toward(0.3), toward(0.3 + alpha));
    detect(scene, "rgb", {{"width", 96.0}, {"height", 64.0}, {"samples", 64.0}});
    const Sums s = sums_of(run(scene).image.at(0), 0);
    const double exact = 2.0 * 0.8 / 3.0 * lambert_phase(alpha);
    INFO("intensity ", s.intensity, " +- ", s.error, ", exact ", exact);
    CHECK(std::fabs(s.intensity - exact) <= 4.0 * s.error + kQuantum);
    CHECK(std::fabs(s.intensity - exact) <= 5e-3 * exact);
    CHECK(s.outline_m2 == relative(kPi).epsilon(5e-3));
  }
}

TEST_CASE("picture axes are right-handed, up is up, and the first row is on top") {
  // One small plate to the upper right of a large dark one.
  clray::Scene scene = scene_of(plate_mesh(4.0, 4.0), lambert(0.0));
  add(scene, moved(plate_mesh(1.0, 1.0), {1.0, 1.0, 0.1}), lambert(1.0));
  monostatic(scene, {0, 0, 1});
  detect(scene, "rgb", {{"width", 40.0}, {"height", 40.0}, {"samples", 16.0}});
  const clray::ImageResult image = run(scene).image.at(0);
  double sum = 0.0, right = 0.0, up = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double l = image.radiance_per_sr[static_cast<std::size_t>(y * image.width + x)];
      sum += l;
      right += l * (x + 0.5 - 0.5 * image.width) * image.pixel_m;
      up += l * (0.5 * image.height - y - 0.5) * image.pixel_m;
    }
  REQUIRE(sum > 0.0);
  const clray::Vec3 centre = (right / sum) * image.right + (up / sum) * image.up;
  CHECK(centre.x == relative(1.0).epsilon(0.05));
  CHECK(centre.y == relative(1.0).epsilon(0.05));
}

TEST_CASE("a picture says where its centre is, from the reference point along its axes") {
  // Plates of 1 x 1 m at (2, 0) and (0, 2): the frame runs from -0.5 to 2.5 both ways, so its middle is (1, 1).
  clray::Scene scene = scene_of(moved(plate_mesh(1.0, 1.0), {2.0, 0.0, 0.0}), lambert(0.9));
  add(scene, moved(plate_mesh(1.0, 1.0), {0.0, 2.0, 0.0}), lambert(0.9));
  detect(scene, "hyperspectral", {{"width", 50.0}, {"height", 40.0}, {"samples", 16.0}});
  for (const clray::Vec3 reference : {clray::Vec3(0.0), clray::Vec3(0.25, -4.0, 8.0)}) {
    scene.reference_point = reference;
    // Seen along z, right is +x and up +y; along y, up is -z and right +x (to_body of pictures, docs/results.md).
    for (const clray::Vec3 o : {clray::Vec3(0, 0, 1), clray::Vec3(0, 1, 0)}) {
      const clray::ImageResult image = run(monostatic(scene, o)).image.at(0);
      const double up = o.y == 1.0 ? -(0.0 - reference.z) : 1.0 - reference.y;
      CHECK(image.centre_right_m == doctest::Approx(1.0 - reference.x).epsilon(1e-13));
      CHECK(image.centre_up_m == doctest::Approx(up).epsilon(1e-13));
    }
  }
  // The light of each pixel at the place that the axes give it: its mean is the plates' mean, within a pixel.
  scene.reference_point = {0.25, -4.0, 8.0};
  const clray::ImageResult image = run(monostatic(scene, {0, 0, 1})).image.at(0);
  double sum = 0.0, x_sum = 0.0, y_sum = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double l = image.radiance_per_sr[static_cast<std::size_t>(y * image.width + x)];
      sum += l;
      x_sum += l * (image.centre_right_m + (x + 0.5 - 0.5 * image.width) * image.pixel_m);
      y_sum += l * (image.centre_up_m + (0.5 * image.height - y - 0.5) * image.pixel_m);
    }
  CHECK(std::fabs(x_sum / sum - (1.0 - 0.25)) < image.pixel_m);
  CHECK(std::fabs(y_sum / sum - (1.0 + 4.0)) < image.pixel_m);
}

TEST_CASE("hyperspectral cube: each band is the same picture times its own reflectance") {
  clray::Material m = lambert(1.0);
  m.spectra["rho"] = clray::Spectrum{{400.0, 800.0}, {0.2, 0.6}};
  clray::Scene scene = scene_of("sphere", {{"radius", 1.0}}, m);
  scene.source.kind = clray::Source::Kind::sun;
  scene.source.spectrum = clray::Spectrum{{300.0, 1100.0}, {1.0, 1.0}};
  scene.source.bands = {{"blue", 440.0, 460.0}, {"green", 540.0, 560.0}, {"red", 640.0, 660.0}};
  detect(scene, "hyperspectral", {{"width", 32.0}, {"height", 32.0}, {"samples", 64.0}});
  const clray::ImageResult image = run(scene).image.at(0);
  REQUIRE(image.bands.size() == 3);
  const double rho[] = {0.25, 0.35, 0.45};
  for (std::size_t b = 0; b < 3; ++b) {
    const Sums s = sums_of(image, b);
    CHECK(std::fabs(s.intensity - 2.0 * rho[b] / 3.0) <= 4.0 * s.error + kQuantum);
    CHECK(s.intensity == relative(2.0 * rho[b] / 3.0).epsilon(1e-2));
  }
}
