// SPDX-License-Identifier: Apache-2.0
// The spectrometer against closed forms: the Lambert sphere's phase curve and its magnitudes, a spinning plate, and
// spectral reflectance band by band.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"

using namespace clray_test;

namespace {

constexpr double kBound = 1e-3;

clray::Scene sunlit(const std::string& shape, const std::map<std::string, double>& keys, const clray::Material& m) {
  clray::Scene scene = scene_of(shape, keys, m);
  detect(scene, "spectrometer");
  scene.source.kind = clray::Source::Kind::sun;
  scene.source.spectrum = clray::Spectrum{{300.0, 1100.0}, {1.5, 1.5}};  // W/m²/nm
  scene.source.bands = {{"550-551", 550.0, 551.0}};
  scene.station.emplace();
  scene.station->range_m = 2.0e6;
  return many_rays(scene, 20);
}

}  // namespace

TEST_CASE("Lambert sphere's light curve: phase function and AB magnitude at ten phase angles") {
  const double rho = 0.3, radius = 2.0;
  for (double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 80.0, 100.0, 120.0, 140.0, 160.0}) {
    CAPTURE(degrees);
    const double alpha = radians(degrees);
    clray::Scene scene = sunlit("sphere", {{"radius", radius}}, lambert(rho));
    bistatic(scene, toward(0.4), toward(0.4 + alpha));
    if (degrees > 130.0) many_rays(scene, 23);  // only a thin crescent of the beam counts
    const clray::SpectrometerResult found = run(scene).spectrometer.at(0);
    const double exact = 2.0 * rho * radius * radius / 3.0 * lambert_phase(alpha);
    check_estimate(found.intensity_m2_per_sr, exact, degrees > 150.0 ? 5e-3 : kBound, "sphere");
    CHECK(std::fabs(found.phase_angle_rad - alpha) <= 1e-7);
    CHECK(found.source_W_m2 == relative(1.5).epsilon(1e-6));
    const double received = exact * 1.5 / 4.0e12;
    check_component(found.received_W_m2, found.received_W_m2_standard_error, received, received,
                    degrees > 150.0 ? 5e-3 : kBound, "received");
    // 1 nm at 550.5 nm: per hertz it is lambda²/c of what it is per metre; 3631 Jy is magnitude 0.
    const double lambda = 550.5e-9, per_hertz = received / 1e-9 * lambda * lambda / kLightSpeed;
    const double magnitude = -2.5 * std::log10(per_hertz / 3631e-26);
    CHECK(std::fabs(found.magnitude_AB - magnitude) <= 4.0 * found.magnitude_standard_error + 1e-4);
    CHECK(found.magnitude_standard_error ==
          relative(2.5 / std::log(10.0) * found.intensity_m2_per_sr.standard_error / found.intensity_m2_per_sr.value)
              .epsilon(1e-3));
  }
}

TEST_CASE("spinning Lambert plate: cos^2 of its turn, orientation by orientation") {
  clray::Scene scene = sunlit("rectangle", {{"size_x", 2.0}, {"size_y", 1.0}}, lambert(0.5));
  monostatic(scene, {0, 0, 1});
  scene.motion.emplace();
  scene.motion->axis = {0, 1, 0};
  scene.motion->period_s = 360.0;
  scene.motion->stop_s = 85.0;
  scene.motion->step_rad = radians(10.0);
  rays(scene, 14);
  const clray::Result result = run(scene);
  REQUIRE(result.orientations.size() == 9);
  REQUIRE(result.spectrometer.size() == 9);
  for (const clray::SpectrometerResult& found : result.spectrometer) {
    const double turn = radians(10.0 * static_cast<double>(found.key.orientation));
    const clray::Orientation& at = result.orientations.at(found.key.orientation);
    // The body turns by +turn about y, so the light turns by -turn in the body.
    CHECK(std::fabs(at.source.x + std::sin(turn)) <= 1e-12);
    CHECK(at.source.z == relative(std::cos(turn)).epsilon(1e-12));
    const double mu = std::cos(turn);
    check_estimate(found.intensity_m2_per_sr, 0.5 / kPi * 2.0 * mu * mu, kBound, "plate", 1.0 / mu);
  }
}

TEST_CASE("received power goes with the range of its own time, also where that comes from a table") {
  clray::Scene scene = sunlit("rectangle", {{"size_x", 2.0}, {"size_y", 1.0}}, lambert(0.5));
  monostatic(scene, {0, 0, 1});
  scene.motion.emplace();
  scene.motion->period_s = 40.0;
  scene.motion->start_s = 1.7e9;
  scene.motion->stop_s = 1.7e9 + 35.0;
  scene.motion->step_rad = radians(45.0);  // 5 s, between the rows of the table
  // A parabola, which a cubic through four rows has exactly and a line through two has not.
  const auto range = [](double t) { return 2e6 - 1e5 * t + 4e3 * t * t; };
  for (const double t : {0.0, 11.0, 22.0, 33.0, 44.0}) scene.station->ranges.emplace_back(1.7e9 + t, range(t));
  rays(scene, 14);
  const clray::Result result = run(scene);
  REQUIRE(result.spectrometer.size() == 8);
  for (const clray::SpectrometerResult& found : result.spectrometer) {
    const double r = range(5.0 * static_cast<double>(found.key.orientation));
    CHECK(found.received_W_m2 == relative(found.intensity_m2_per_sr.value * 1.5 / (r * r)).epsilon(1e-9));
  }
}

TEST_CASE("spectral reflectance: each band sees its own") {
  clray::Material m = lambert(1.0);
  m.spectra["rho"] = clray::Spectrum{{400.0, 800.0}, {0.2, 0.6}};
  clray::Scene scene = sunlit("rectangle", {{"size_x", 1.0}, {"size_y", 1.0}}, m);
  scene.source.bands = {{"blue", 440.0, 460.0}, {"green", 540.0, 560.0}, {"red", 640.0, 660.0}};
  rays(scene, 14);
  const clray::Result result = run(scene);
  REQUIRE(result.spectrometer.size() == 3);
  const double rho[] = {0.25, 0.35, 0.45};
  for (std::size_t i = 0; i < 3; ++i) {
    check_estimate(result.spectrometer[i].intensity_m2_per_sr, rho[i] / kPi, kBound, "band");
    CHECK(result.spectrometer[i].source_W_m2 == relative(30.0).epsilon(1e-6));
  }
}
