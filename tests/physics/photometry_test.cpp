// SPDX-License-Identifier: Apache-2.0
// Magnitudes of a Lambert sphere under the Sun in filters by name: at a range, and in a pass behind the atmosphere of
// a site.
#include <doctest/doctest.h>

#include <cmath>

#include "support/checks.hpp"
#include "unit/pass_support.hpp"

using namespace clray_test;
using clray::test::Circle;
using clray::test::SceneFolder;

namespace {

/// Of the Sun, of sums over the sources' tables (tests/unit/scene_photometry_test.cpp), with Vega at 0.03 in V.
constexpr double kSunV_AB = -26.7728, kSunV_Vega = -26.7489, kSunG_AB = -26.7901, kSunSloanG_AB = -26.4529;

double sphere(double rho, double radius_m, double phase_rad) {
  return 2.0 * rho * radius_m * radius_m / 3.0 * lambert_phase(phase_rad);
}

}  // namespace

TEST_CASE("Lambert sphere in V, G and g: the Sun's magnitude less 2.5 log10(A/range^2), at three phases") {
  const double rho = 0.2, radius = 0.5, range = 7e5;
  for (const double degrees : {10.0, 60.0, 110.0}) {
    CAPTURE(degrees);
    clray::Scene scene = scene_of("sphere", {{"radius", radius}}, lambert(rho));
    detect(scene, "spectrometer");
    bistatic(scene, toward(0.2), toward(0.2 + radians(degrees)));
    scene.source.kind = clray::Source::Kind::sun;
    scene.source.spectrum = clray::solar_spectrum();
    scene.source.bands = {clray::photometric_band("V"), clray::photometric_band("G"), clray::photometric_band("g")};
    scene.observers[0].range_m = range;
    const auto found = run(rays(scene, 20)).spectrometer;
    REQUIRE(found.size() == 3);
    const double less = -2.5 * std::log10(sphere(rho, radius, radians(degrees)) / (range * range));
    // The sums are good to 5e-4 mag, that of Vega to 1e-3.
    const double error = 4.0 * found[0].magnitude_standard_error;
    CHECK(std::fabs(found[0].magnitude_AB - (kSunV_AB + less)) <= error + 5e-4);
    CHECK(std::fabs(found[0].magnitude_Vega - (kSunV_Vega + less)) <= error + 1e-3);
    CHECK(std::fabs(found[1].magnitude_AB - (kSunG_AB + less)) <= error + 5e-4);
    CHECK(std::fabs(found[2].magnitude_AB - (kSunSloanG_AB + less)) <= error + 5e-4);
    CHECK(std::isnan(found[0].air_mass));
  }
}

TEST_CASE("pass: extinction is that of the air mass; magnitudes and received power both have it") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", clray::test::circle_oem(orbit, -60, 660, 30, "ITRF2014"));
  const clray::Vec3 below_orbit = orbit.at(240.0) * (6.375e6 / orbit.radius_m);
  // One site below the orbit, and one on the other side of the Earth.
  const auto scene = [&](const std::string& extinction) {
    return "component = [{ shape = \"sphere\" }]\ndetector = [{ kind = \"spectrometer\" }]\n[trace]\nrays = "
           "4096\n[pass]\nstart = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:10:00Z\nstep_s = 60\nephemeris = "
           "\"o.oem\"\nmin_elevation_deg = -90\n[source]\nkind = \"sun\"\ndirection = [1, 0, 0]\nbands = [\"B\", "
           "\"V\"]\n[[observer]]\nname = \"near\"\necef_m = " +
           clray::test::vector_text(below_orbit) + "\n" + extinction +
           "[[observer]]\nname = \"far\"\necef_m = " + clray::test::vector_text(-below_orbit) + "\n" + extinction;
  };
  const clray::Result clear = clray::trace(f.load(scene("")), device());
  const clray::Result dim = clray::trace(f.load(scene("extinction_mag = { B = 0.3, V = 0.15 }\n")), device());
  REQUIRE(clear.spectrometer.size() == dim.spectrometer.size());
  int high = 0, below = 0;
  for (std::size_t i = 0; i < dim.spectrometer.size(); ++i) {
    const clray::SpectrometerResult &a = clear.spectrometer[i], &b = dim.spectrometer[i];
    CHECK(a.extinction_mag == 0.0);
    const double elevation_deg =
        clear.instants.at(a.key.orientation).sites.at(a.key.observer == "near" ? 0 : 1).elevation_rad / kPi * 180.0;
    if (elevation_deg < 0.0) {
      ++below;
      CHECK(std::isnan(b.air_mass));
      CHECK(b.received_W_m2 == 0.0);
      CHECK(std::isnan(b.magnitude_AB));
      continue;
    }
    const double k = b.key.band == "B" ? 0.3 : 0.15;
    CHECK(b.extinction_mag == relative(k * b.air_mass).epsilon(1e-14));
    if (a.received_W_m2 == 0.0) continue;
    CHECK(b.magnitude_AB - a.magnitude_AB == relative(b.extinction_mag).epsilon(1e-9));
    CHECK(b.magnitude_Vega - a.magnitude_Vega == relative(b.extinction_mag).epsilon(1e-9));
    CHECK(b.received_W_m2 == relative(a.received_W_m2 * std::pow(10.0, -0.4 * b.extinction_mag)).epsilon(1e-12));
    if (elevation_deg < 10.0) continue;
    ++high;
    // Kasten & Young (1989), by another author's fit of the apparent elevation: refraction is 0.09 deg at 10 deg.
    const double fit =
        1.0 / (std::sin(elevation_deg * kPi / 180.0) + 0.50572 * std::pow(elevation_deg + 6.07995, -1.6364));
    CHECK(b.air_mass == relative(fit).epsilon(0.01));
  }
  CHECK(high > 10);
  CHECK(below == 22);
}
