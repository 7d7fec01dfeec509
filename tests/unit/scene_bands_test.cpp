// SPDX-License-Identifier: Apache-2.0
// Bands through filters' curves: integrals of light, reflectance and response against closed forms, the zero point of
// AB magnitudes, and how scene files name curves, rows of even bands and an observer's range.
#include <doctest/doctest.h>

#include <cmath>

#include "scene/spectrum.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

constexpr const char* kBody = "[[component]]\nshape = \"sphere\"\n[source]\nkind = \"sun\"\n";

Source table_sun(Spectrum light) {
  Source s;
  s.kind = Source::Kind::sun;
  s.spectrum = std::move(light);
  return s;
}

/// A triangle from 400 nm over 500 nm to 600 nm, of height 1.
Band triangle() {
  return make_band("V", {{400, 500, 600}, {0, 1, 0}});
}

}  // namespace

// Tolerances of 1e-14: the rule is exact for these polynomials, and a few dozen terms are rounded.
TEST_CASE("a filter's curve weighs the light: a triangle under flat and sloping light") {
  const Source flat = table_sun({{300, 800}, {2, 2}});
  CHECK(source_band_W_m2(flat, triangle()) == doctest::Approx(200.0).epsilon(1e-14));
  // Light w/500 is antisymmetric about the middle but for its mean, 1.
  const Source sloping = table_sun({{250, 750}, {0.5, 1.5}});
  CHECK(source_band_W_m2(sloping, triangle()) == doctest::Approx(100.0).epsilon(1e-14));
  // Half of the triangle has no light: ∫_500^600 (600 − w)/100 dw = 50.
  CHECK(source_band_W_m2(table_sun({{500, 900}, {1, 1}}), triangle()) == doctest::Approx(50.0).epsilon(1e-14));
  CHECK(source_band_W_m2(table_sun({{600, 900}, {1, 1}}), triangle()) == 0.0);
  Source laser;
  laser.wavelength_nm = 450;
  CHECK(source_band_W_m2(laser, triangle()) == 0.5);
}

TEST_CASE("a curve of constant transmission is a top hat, under the Sun too") {
  Source sun;
  sun.kind = Source::Kind::sun;
  for (const double blackbody : {0.0, 300.0, 40000.0}) {
    sun.blackbody_K = blackbody;
    for (const auto& one : {std::pair{400.0, 700.0}, {549.9, 550.1}, {200.0, 20000.0}, {8000.0, 14000.0}}) {
      const auto& low = one.first;
      const auto& high = one.second;
      CAPTURE(low);
      const double hat = source_band_W_m2(sun, {"", low, high});
      const double curve = source_band_W_m2(sun, make_band("c", {{low, high}, {0.25, 0.25}}));
      // Two quadratures of the same integral, one in x and one in λ.
      CHECK(curve == doctest::Approx(0.25 * hat).epsilon(1e-11));
    }
  }
}

TEST_CASE("reflectance is averaged over the light that a band passes") {
  // Light w − 400 over [400, 600]: mean of reflectance (w − 400)/200 is ∫x²/∫x·(1/200) = 2/3.
  const Source ramp = table_sun({{400, 600}, {0, 200}});
  const Spectrum rho{{400, 600}, {0, 1}};
  CHECK(spectrum_mean(rho, {"", 400, 600}, ramp) == doctest::Approx(2.0 / 3.0).epsilon(1e-14));
  // Through the triangle, x = w − 400 in hundreds: ∫x²T/∫xT = (1/4 + 11/12)/(1/3 + 2/3) = 7/6, of 2.
  CHECK(spectrum_mean(rho, triangle(), ramp) == doctest::Approx(7.0 / 12.0).epsilon(1e-14));
  // Flat light through a top hat is the plain mean.
  const Source flat = table_sun({{300, 800}, {3, 3}});
  const Spectrum kinked{{420, 480, 590}, {0.2, 0.9, 0.3}};
  CHECK(spectrum_mean(kinked, {"", 400, 600}, flat) == doctest::Approx(spectrum_mean(kinked, 400, 600)).epsilon(1e-14));
  // A constant stays itself, bit for bit.
  CHECK(spectrum_mean({{400, 500}, {1, 1}}, triangle(), ramp) == 1.0);
  Source laser;
  laser.wavelength_nm = 500;
  CHECK(spectrum_mean(rho, make_band(500, 500), laser) == 0.5);
}

TEST_CASE("AB magnitude 0: 3631 Jy through top hats and curves") {
  // 3631e-26 W/m²/Hz × c (1/500 nm − 1/600 nm).
  const double hat = 3631e-26 * 299792458.0 * (1.0 / 500e-9 - 1.0 / 600e-9);
  CHECK(ab_zero_W_m2(make_band(500, 600)) == doctest::Approx(hat).epsilon(1e-14));
  CHECK(ab_zero_W_m2(make_band("c", {{500, 600}, {0.5, 0.5}})) == doctest::Approx(0.5 * hat).epsilon(1e-13));
  // The triangle: ∫T/w² dw = [ln(5/4) − 400(1/400 − 1/500)]/100 + [600(1/500 − 1/600) − ln(6/5)]/100, per nm.
  const double integral = (std::log(1.25) - 0.2 + 0.2 - std::log(1.2)) / 100.0;
  CHECK(ab_zero_W_m2(triangle()) == doctest::Approx(3631e-26 * 299792458e9 * integral).epsilon(1e-12));
  CHECK(ab_zero_W_m2(make_band(532, 532)) == 0.0);
}

TEST_CASE("scene files name curves by file, with or without a name, and bands in rows") {
  const SceneFolder folder;
  folder.write("curves/V.csv", "wavelength_nm,transmission\n400,0\n500,1\n600,0\n");
  const auto bands = [&](const std::string& value) {
    return folder.load(std::string(kBody) + "bands = " + value + "\n").source.bands;
  };
  const auto mixed = bands(R"(["curves/V.csv", [600, 700], { name = "green", file = "curves/V.csv" }])");
  REQUIRE(mixed.size() == 3);
  CHECK(mixed[0].name == "V");
  CHECK(mixed[0].low_nm == 400.0);
  CHECK(mixed[0].high_nm == 600.0);
  REQUIRE(mixed[0].response);
  CHECK(response_at(mixed[0], 450.0) == doctest::Approx(0.5).epsilon(1e-15));
  CHECK(response_at(mixed[0], 601.0) == 0.0);
  CHECK_FALSE(mixed[1].response);
  CHECK(mixed[2].name == "green");
  const auto row = bands("{ low_nm = 400, high_nm = 720, count = 64 }");
  REQUIRE(row.size() == 64);
  CHECK(row[0].name == "400-405");
  CHECK(row[63].high_nm == 720.0);
  for (std::size_t i = 1; i < row.size(); ++i) CHECK(row[i].low_nm == row[i - 1].high_nm);
  const Scene scene = folder.load(std::string(kBody) + "[observer]\ndirection = [1, 0, 0]\nrange_m = 3.6e7\n");
  CHECK(scene.observers[0].range_m == 3.6e7);
}

TEST_CASE("what is wrong with a band is said where it stands") {
  const SceneFolder folder;
  folder.write("V.csv", "400,0\n500,1\n");
  folder.write("dark.csv", "400,0\n500,0\n");
  folder.write("one.csv", "400,1\n");
  folder.write("bad.csv", "400,1\n300,1\n");
  folder.write("far.csv", "1,1\n2,1\n");
  const auto says = [&](const std::string& bands, const std::string& more = "") {
    return folder.complaint(std::string(kBody) + "bands = " + bands + "\n" + more);
  };
  CHECK(says("[\"V.csv\"]") == "fine");
  CHECK(says("[\"W.csv\"]").find("s.toml:5:10: source.bands: there is no file \"W.csv\"") == 0);
  CHECK(says("[\"../V.csv\"]").find("expected a file inside the scene's folder") != std::string::npos);
  CHECK(says("[\"dark.csv\"]").find("dark.csv: expected a filter's curve") == 0);
  CHECK(says("[\"one.csv\"]").find("one.csv: expected a filter's curve") == 0);
  CHECK(says("[\"bad.csv\"]").find("bad.csv:2:") == 0);
  CHECK(says("[\"V.csv\", \"V.csv\"]").find("a second band of the name \"V\"") != std::string::npos);
  CHECK(says("[{ file = \"V.csv\", low_nm = 3 }]").find("given beside file") != std::string::npos);
  CHECK(says("[\"far.csv\"]").find("the source has no light in the band far") != std::string::npos);
  CHECK(says("{ low_nm = 500, high_nm = 400, count = 3 }").find("expected more than low_nm") != std::string::npos);
  CHECK(says("{ low_nm = 400, high_nm = 500 }").find("count") != std::string::npos);
  CHECK(says("[[400, 500]]", "[observer]\nrange_m = 0\n").find("range_m") != std::string::npos);
}

TEST_CASE("a bare mesh asked only for pictures is lit by the Sun over the viewer's shoulder") {
  const SceneFolder folder;
  const std::string mesh = folder.path("plate.obj");
  SceneOptions options;
  options.detectors = {"rgb"};
  const Scene picture = load_scene(mesh, options);
  CHECK(picture.source.kind == Source::Kind::sun);
  CHECK_FALSE(picture.observers[0].monostatic);
  CHECK(picture.observers[0].direction == Vec3(0, 0, 1));
  // From the upper left, behind the viewer.
  CHECK(picture.source.direction.x < -0.2);
  CHECK(picture.source.direction.y > 0.2);
  CHECK(picture.source.direction.z > 0.5);
  options.observer = Vec3(0, 2, 0);
  const Scene above = load_scene(mesh, options);
  CHECK(above.source.direction.y > 0.5);
  CHECK(std::fabs(above.source.direction.x) > 0.2);
  options.source = Vec3(1, 0, 0);
  CHECK(load_scene(mesh, options).source.kind == Source::Kind::laser);
  options = {};
  options.detectors = {"rgb", "delay"};
  CHECK(load_scene(mesh, options).source.kind == Source::Kind::laser);
  options = {};
  CHECK(load_scene(mesh, options).observers[0].monostatic);
}
