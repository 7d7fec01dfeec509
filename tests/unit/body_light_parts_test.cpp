// SPDX-License-Identifier: Apache-2.0
// A wide band in parts: where they are cut, their shares, and what variance of a surface's key is left within them.
#include <doctest/doctest.h>

#include <cmath>

#include "body/light_parts.hpp"

using namespace clray;

namespace {

/// Flat light from 1000 to 2000 nm on surfaces of these reflectances.
Scene flat_light(const std::vector<Spectrum>& rho) {
  Scene scene;
  scene.source.kind = Source::Kind::sun;
  scene.source.spectrum = Spectrum{{1000, 2000}, {1, 1}};
  for (const Spectrum& s : rho) {
    scene.materials.emplace_back();
    scene.materials.back().spectra["rho"] = s;
  }
  return scene;
}

LightParts parts(const std::vector<Spectrum>& rho) {
  return parts_of(flat_light(rho), {"", 1000, 2000});
}

}  // namespace

TEST_CASE("one part where no key changes within the band") {
  for (const auto& rho : {std::vector<Spectrum>{}, {{{1500}, {0.3}}}, {{{100, 900}, {0.1, 0.9}}}}) {
    const LightParts p = parts(rho);
    REQUIRE(p.bands.size() == 1);
    CHECK(p.bands[0].low_nm == 1000.0);
    CHECK(p.bands[0].high_nm == 2000.0);
    CHECK(p.shares[0] == 1.0);
  }
}

TEST_CASE("a step is a cut, and steps of several surfaces all are") {
  // Steps of zero width but for a hair.
  const auto step = [](double at) { return Spectrum{{at, at + 1e-6}, {0.1, 0.9}}; };
  const LightParts one = parts({step(1250)});
  REQUIRE(one.bands.size() == 2);
  CHECK(one.bands[0].high_nm == 1250.0);
  CHECK(one.shares[0] == doctest::Approx(0.25).epsilon(1e-12));
  const LightParts three = parts({step(1800), step(1250), step(1400)});
  REQUIRE(three.bands.size() == 4);
  CHECK(three.bands[1].low_nm == 1250.0);
  CHECK(three.bands[2].low_nm == 1400.0);
  CHECK(three.bands[3].low_nm == 1800.0);
  CHECK(three.shares[3] == doctest::Approx(0.2).epsilon(1e-12));
}

TEST_CASE("a slope is cut evenly in light, side by side from end to end") {
  const LightParts p = parts({{{1000, 2000}, {0, 1}}});
  REQUIRE(p.bands.size() == kMostLightParts);
  CHECK(p.bands.front().low_nm == 1000.0);
  CHECK(p.bands.back().high_nm == 2000.0);
  double sum = 0.0, variance = 0.0;
  for (std::size_t k = 0; k < p.bands.size(); ++k) {
    if (k > 0) CHECK(p.bands[k].low_nm == p.bands[k - 1].high_nm);
    const double width = (p.bands[k].high_nm - p.bands[k].low_nm) / 1000.0;
    CHECK(p.shares[k] == doctest::Approx(width).epsilon(1e-9));
    sum += p.shares[k];
    variance += p.shares[k] * width * width / 12.0;  // of x over a piece of the slope
  }
  CHECK(sum == doctest::Approx(1.0).epsilon(1e-12));
  // Eighths would leave 1/(12·64); cells are 0.5 % wide.
  CHECK(variance <= 1.1 / (12.0 * 64.0));
}
