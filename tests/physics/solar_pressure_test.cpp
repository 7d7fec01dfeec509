// SPDX-License-Identifier: Apache-2.0
// Pressure of a Sun without bands: the whole solar spectrum, and surfaces whose reflectance depends on wavelength. What
// is expected comes from a quadrature of Planck's law of the test's own (midpoints in ln λ, good to 1e-9) and closed
// forms of plates and corners.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "support/checks.hpp"

using namespace clray_test;
using clray::Spectrum;
using clray::Vec3;

namespace {

/// Mean of f over low … high nm, weighted by a black body of 5772 K.
double solar_mean(const std::function<double(double)>& f, double low = 200.0, double high = 10000.0) {
  constexpr int kSteps = 200000;
  double sum = 0.0, light = 0.0;
  const double step = std::log(high / low) / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const double w = low * std::exp(step * (k + 0.5));
    const double planck = std::pow(w, -4) / std::expm1(1.438776877e7 / (w * 5772.0));  // dλ = λ d ln λ
    sum += planck * f(w);
    light += planck;
  }
  return sum / light;
}

double linear(const Spectrum& s, double w) {
  if (w <= s.wavelength_nm.front()) return s.value.front();
  for (std::size_t k = 1; k < s.value.size(); ++k) {
    const double a = s.wavelength_nm[k - 1], b = s.wavelength_nm[k];
    if (w <= b) return s.value[k - 1] + (s.value[k] - s.value[k - 1]) * (w - a) / (b - a);
  }
  return s.value.back();
}

clray::Scene lit_by_sun(clray::Scene scene) {
  scene.source.kind = clray::Source::Kind::sun;
  detect(scene, "pressure");
  return rays(scene, 18);
}

clray::Material spectral(clray::Material m, const std::string& key, const Spectrum& s) {
  m.spectra[key] = s;
  return m;
}

/// A solar cell's like: dark to 1100 nm, bright beyond; and a slope over the whole spectrum.
const Spectrum kStep{{1100.0, 1100.5}, {0.1, 0.9}}, kSlope{{300.0, 2500.0}, {0.1, 0.95}};

/// Two plates of 2 x 2 m at a right angle, lit from between them: all light meets both, and leaves to where it came
/// from.
clray::Scene corner(const clray::Material& m) {
  clray::Scene scene = scene_of(plate_mesh(2, 2), m);
  add(scene, plate_mesh(2, 2), m).transform = {{-1, 0, 1}, {0, 1, 0}, kPi / 2.0, 1.0};
  monostatic(scene, toward(kPi / 4.0));
  scene.trace.max_bounces = 2;
  return lit_by_sun(scene);
}

}  // namespace

TEST_CASE("a Sun without bands pushes with its whole spectrum, and the result says so") {
  for (const Spectrum& rho : {kStep, kSlope}) {
    clray::Scene scene = lit_by_sun(scene_of(plate_mesh(1, 1), spectral(lambert(0.5), "rho", rho)));
    const clray::PressureResult p = run(scene).pressure.at(0);
    CHECK(p.key.band.empty());
    CHECK(p.band.low_nm == 200.0);
    CHECK(p.band.high_nm == 10000.0);
    // The share of 5772 K between 200 nm and 10 um is 0.997799 (a table of the black body gives 0.9978).
    CHECK(p.source_W_m2 == relative(1361.0 * 0.997799).epsilon(1e-6));
    const double mean = solar_mean([&](double w) { return linear(rho, w); });
    INFO("C ", p.coefficient_m2.value.z, " +- ", p.coefficient_m2.standard_error.z, ", mean ", mean);
    check_component(p.coefficient_m2.value.z, p.coefficient_m2.standard_error.z, -(1.0 + 2.0 / 3.0 * mean), 1.0, 1e-4,
                    "plate");
    CHECK(p.absorbed_m2.value == relative(1.0 - mean).epsilon(1e-5));
    // In visible light alone it would be another surface.
    CHECK(std::fabs(solar_mean([&](double w) { return linear(rho, w); }, 400.0, 700.0) - mean) > 0.05);
  }
}

TEST_CASE("light that is reflected twice takes the mean of the squared reflectance, not the square of the mean") {
  for (const Spectrum& reflectance : {kStep, kSlope}) {
    clray::Scene scene = corner(spectral(mirror(1.0), "reflectance", reflectance));
    const clray::Result result = run(scene);
    REQUIRE(result.pressure.size() == 1);
    REQUIRE(result.energy.size() == 1);
    const double squares = solar_mean([&](double w) { return std::pow(linear(reflectance, w), 2); });
    const double mean = solar_mean([&](double w) { return linear(reflectance, w); });
    const double beam = 8.0 / std::sqrt(2.0), exact = beam * (1.0 + squares);
    const Vec3 c = result.pressure[0].coefficient_m2.value;
    const double found = -(c.x + c.z) / std::sqrt(2.0);
    INFO("C ", found, ", exact ", exact, ", of the mean reflectance ", beam * (1.0 + mean * mean));
    // A slope in eight parts: what is left of the variance within them is below 1e-3 of 1.
    CHECK(std::fabs(found - exact) <= beam * 1e-3);
    CHECK(std::fabs(mean * mean - squares) > 0.02);
    CHECK(std::fabs(c.y) <= 1e-9);
    CHECK(std::fabs(result.energy[0].reflected_m2.value - beam * squares) <= beam * 1e-3);
    CHECK(result.energy[0].incident_m2.value == relative(beam).epsilon(1e-6));
  }
}

TEST_CASE("a surface that is not linear in its reflectance: the mean over wavelengths of what each gives") {
  // Without the specular lobe the diffuse term of Ashikhmin-Shirley is 28 rho/(23 pi)·(1 − s F0)·g·g: with F0 = rho it
  // is quadratic, so the two halves of the spectrum are traced as materials of one number each, and weighed.
  const auto push = [](double rho) {
    clray::Scene scene = lit_by_sun(scene_of(plate_mesh(1, 1), ashikhmin_shirley(rho, 0.4, 3.0)));
    return run(scene).pressure.at(0).coefficient_m2;
  };
  const clray::VectorEstimate dark = push(0.1), bright = push(0.9);
  const double share = solar_mean([](double w) { return (linear(kStep, w) - 0.1) / 0.8; });
  const double exact = (1.0 - share) * dark.value.z + share * bright.value.z;
  clray::Scene scene = lit_by_sun(scene_of(plate_mesh(1, 1), spectral(ashikhmin_shirley(0.5, 0.4, 3.0), "rho", kStep)));
  const clray::VectorEstimate found = run(scene).pressure.at(0).coefficient_m2;
  const double error = std::hypot(found.standard_error.z, std::hypot(dark.standard_error.z, bright.standard_error.z));
  INFO("C ", found.value.z, " +- ", error, ", exact ", exact);
  // The step's own slope is half a nm wide: 1e-4 of the light.
  CHECK(std::fabs(found.value.z - exact) <= 4.0 * error + 1e-4);
  const double of_the_mean = push(0.1 + 0.8 * share).value.z;
  CHECK(std::fabs(of_the_mean - exact) > 20.0 * error + 1e-3);
}

TEST_CASE("pressure's light is its own: detectors beside it keep theirs, and bands that are given stay") {
  clray::Scene scene = scene_of(plate_mesh(1, 1), spectral(lambert(0.5), "rho", kStep));
  scene = lit_by_sun(scene);
  scene.trace.max_bounces = 2;
  const clray::PressureResult alone = run(scene).pressure.at(0);
  scene.detectors.insert(scene.detectors.begin(), {"spectrometer", "spectrometer", {}});
  scene.detectors.push_back({"hyperspectral", "cube", {{"width", 4.0}, {"height", 4.0}}});
  const clray::Result both = run(scene);
  CHECK(both.pressure.at(0).coefficient_m2.value == alone.coefficient_m2.value);
  CHECK(both.spectrometer.at(0).band.name == "400-700");
  CHECK(both.spectrometer.at(0).intensity_m2_per_sr.value == relative(0.1 / kPi).epsilon(1e-9));
  CHECK(both.image.at(0).bands.at(0).name == "400-700");
  REQUIRE(both.energy.size() == 2);
  CHECK(both.energy[0].key.detector != both.energy[1].key.detector);
  // Where no surface knows wavelengths one pass serves all, under each detector's name for its light.
  scene.materials[0] = lambert(0.5);
  const clray::Result grey = run(scene);
  CHECK(grey.energy.size() == 1);
  CHECK(grey.spectrometer.at(0).band.name == "400-700");
  CHECK(grey.pressure.at(0).band.high_nm == 10000.0);
  scene.source.bands = {{"infrared", 1200.0, 2000.0}};
  scene.materials[0] = spectral(lambert(0.5), "rho", kStep);
  const clray::PressureResult infrared = run(scene).pressure.at(0);
  CHECK(infrared.band.name == "infrared");
  CHECK(infrared.absorbed_m2.value == relative(0.1).epsilon(1e-4));
}

TEST_CASE("the whole light of a table, and of a black body of another temperature") {
  clray::Scene scene = lit_by_sun(scene_of(plate_mesh(1, 1), spectral(lambert(0.5), "rho", {{1000, 2000}, {0, 1}})));
  scene.source.spectrum = Spectrum{{1000, 2000}, {0, 2}};  // weight x: the mean of x over it is 2/3
  const clray::PressureResult table = run(scene).pressure.at(0);
  CHECK(table.band.low_nm == 1000.0);
  CHECK(table.source_W_m2 == relative(1000.0).epsilon(1e-12));
  CHECK(table.absorbed_m2.value == relative(1.0 / 3.0).epsilon(1e-5));
  scene.source.spectrum.reset();
  scene.source.blackbody_K = 288.6;  // a twentieth of the Sun's
  scene.source.irradiance_W_m2 = 240.0;
  const clray::PressureResult earth = run(scene).pressure.at(0);
  CHECK(earth.band.low_nm == relative(4000.0).epsilon(1e-12));
  CHECK(earth.band.high_nm == relative(200000.0).epsilon(1e-12));
  CHECK(earth.source_W_m2 == relative(240.0 * 0.997799).epsilon(1e-6));
}
