// SPDX-License-Identifier: Apache-2.0
// Spectra and sources: exact means of tables; Planck's band integral against its series and against plain quadrature.
#include <doctest/doctest.h>

#include <cmath>

#include "scene/file/scene_csv.hpp"
#include "scene/spectrum.hpp"
#include "unit/scene_files.hpp"

using namespace clray;

namespace {

constexpr long double kPi = 3.14159265358979323846264338327950288L;
constexpr long double kC2 = 6.62607015e-34L * 299792458.0L / 1.380649e-23L;  // hc/k, m K

/// Share of a black body's light below a wavelength: 15/π⁴ Σ e^(−kx)(x³/k + 3x²/k² + 6x/k³ + 6/k⁴).
long double share_below(long double nm, long double kelvin) {
  const long double x = kC2 / (nm * 1e-9L * kelvin);
  long double sum = 0.0L;
  for (int k = 4000; k >= 1; --k) {
    const long double n = k;
    sum += std::exp(-n * x) * (x * x * x / n + 3 * x * x / (n * n) + 6 * x / (n * n * n) + 6 / (n * n * n * n));
  }
  return 15.0L / (kPi * kPi * kPi * kPi) * sum;
}

Source sun() {
  Source s;
  s.kind = Source::Kind::sun;
  return s;
}

std::string complaint(const std::string& file) {
  try {
    read_spectrum(file, {{"value"}, ""}, 0.0, 1.0);
  } catch (const Error& e) {
    return e.what();
  }
  return "fine";
}

}  // namespace

TEST_CASE("spectrum: linear inside, constant beyond") {
  const Spectrum s{{400, 500, 700}, {0.2, 0.4, 0.1}};
  CHECK(spectrum_at(s, 300) == 0.2);
  CHECK(spectrum_at(s, 450) == doctest::Approx(0.3).epsilon(1e-15));
  CHECK(spectrum_at(s, 500) == 0.4);
  CHECK(spectrum_at(s, 600) == doctest::Approx(0.25).epsilon(1e-15));
  CHECK(spectrum_at(s, 900) == 0.1);
  const Spectrum one{{500}, {0.7}};
  CHECK(spectrum_at(one, 1) == 0.7);
  CHECK(spectrum_mean(one, 100, 1000) == doctest::Approx(0.7).epsilon(1e-15));
}

TEST_CASE("spectrum: beyond its table a surface is constant, a source and a filter are zero") {
  const Spectrum s{{400, 500}, {0.2, 0.4}};
  CHECK(spectrum_inside(s, 399.9) == 0.0);
  CHECK(spectrum_inside(s, 400) == 0.2);
  CHECK(spectrum_inside(s, 500) == 0.4);
  CHECK(spectrum_inside(s, 500.1) == 0.0);
  Source light;
  light.kind = Source::Kind::sun;
  light.spectrum = Spectrum{{300, 900}, {1, 1}};
  // A band that claims more than its curve has: a light meter behind it sees the curve alone, 30 over 400-500 nm.
  const Band band{"b", 350, 800, std::make_shared<const Spectrum>(s)};
  CHECK(response_at(band, 390) == 0.0);
  CHECK(response_at(band, 510) == 0.0);
  CHECK(source_band_W_m2(light, band) == doctest::Approx(30.0).epsilon(1e-14));
  CHECK(ab_zero_W_m2(band) == doctest::Approx(ab_zero_W_m2(make_band("c", s))).epsilon(1e-14));
  // Light over 450-550 nm only: the reflectance there is 0.3 to 0.4, then 0.4.
  light.spectrum = Spectrum{{450, 550}, {1, 1}};
  CHECK(spectrum_mean(s, {"wide", 300, 900}, light) == doctest::Approx((0.35 * 50 + 0.4 * 50) / 100).epsilon(1e-14));
  // Of w over light and curve: 450-500 nm with weights 0.3 to 0.4, mean 475 + 50²/12·0.002/0.35 (moments of a line).
  const auto wavelength = [](double w) { return w; };
  const double mean = 475.0 + 2500.0 / 12.0 * 0.002 / 0.35;
  CHECK(band_mean(wavelength, 7.0, band, light) == doctest::Approx(mean).epsilon(1e-14));
  CHECK(band_mean(wavelength, 7.0, make_band(600, 700), light) == 0.0);
  Source laser;
  laser.wavelength_nm = 450;
  CHECK(band_mean(wavelength, 7.0, band, laser) == 450.0);
  laser.wavelength_nm = 600;
  CHECK(band_mean(wavelength, 7.0, band, laser) == 0.0);
}

TEST_CASE("spectrum: means are exact integrals") {
  const Spectrum s{{400, 500, 700}, {0.2, 0.4, 0.1}};
  CHECK(spectrum_mean(s, 400, 700) == doctest::Approx((0.3 * 100 + 0.25 * 200) / 300).epsilon(1e-15));
  CHECK(spectrum_mean(s, 450, 600) == doctest::Approx((0.35 * 50 + 0.325 * 100) / 150).epsilon(1e-15));
  CHECK(spectrum_mean(s, 300, 800) == doctest::Approx((0.2 * 100 + 30 + 50 + 0.1 * 100) / 500).epsilon(1e-15));
  CHECK(spectrum_mean(s, 100, 200) == doctest::Approx(0.2).epsilon(1e-15));
  CHECK(spectrum_mean(s, 800, 900) == doctest::Approx(0.1).epsilon(1e-15));
  CHECK(spectrum_mean(s, 450, 450) == spectrum_at(s, 450));
}

TEST_CASE("spectrum: Planck's bands agree with the series") {
  for (const double kelvin : {300.0, 2856.0, 5772.0, 30000.0}) {
    Source s = sun();
    s.blackbody_K = kelvin;
    for (const auto& [low, high] :
         {std::pair<double, double>{400, 700}, {100, 200}, {550, 551}, {700, 2500}, {8000, 14000}}) {
      const long double series = 1361.0L * (share_below(high, kelvin) - share_below(low, kelvin));
      if (!(series > 1e-300L)) continue;
      // Rounding x moves e^(-x) by x ulp and the band's width by high/(high - low) ulp; four roundings each. The
      // series cancels: its own error is that of long double times the share below `high`.
      const double x = static_cast<double>(kC2) / (low * 1e-9 * kelvin);
      const double own = static_cast<double>(1361.0L * 1e-18L * share_below(high, kelvin) / series);
      const double tolerance = 0x1p-52 * (4.0 * x + 4.0 * high / (high - low) + 4.0) + own;
      CHECK(std::fabs(static_cast<double>(source_band_W_m2(s, {"", low, high}) / series - 1.0L)) <= tolerance);
    }
  }
}

TEST_CASE("spectrum: the Sun's bands agree with plain quadrature, and all of it is 1361 W/m²") {
  // Simpson's rule over wavelength, written apart from x: 2hc²/λ⁵/(e^x−1), normalised by σT⁴/π.
  const long double t = 5772.0L, h = 6.62607015e-34L, c = 299792458.0L;
  const long double sigma = 2 * std::pow(kPi, 5) * std::pow(1.380649e-23L, 4) / (15 * h * h * h * c * c);
  const auto radiance = [&](long double m) { return 2 * h * c * c / std::pow(m, 5) / std::expm1(kC2 / (m * t)); };
  const int n = 2000;
  long double sum = 0.0L;
  for (int i = 0; i <= n; ++i) {
    const long double m = (400.0L + 300.0L * i / n) * 1e-9L;
    sum += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * radiance(m);
  }
  const long double expected = 1361.0L * sum * 300e-9L / n / 3 * kPi / (sigma * t * t * t * t);
  CHECK(source_band_W_m2(sun(), {"", 400, 700}) == doctest::Approx(static_cast<double>(expected)).epsilon(1e-11));
  CHECK(source_band_W_m2(sun(), {"", 1, 1e9}) == doctest::Approx(1361.0).epsilon(1e-12));
  const double narrow = source_band_W_m2(sun(), {"", 549.9995, 550.0005}) / 0.001;
  CHECK(source_spectral_W_m2_nm(sun(), 550) == doctest::Approx(narrow).epsilon(1e-8));
}

TEST_CASE("spectrum: a laser's light is in its line, a table's within its ends") {
  Source laser;
  CHECK(source_band_W_m2(laser, {"", 532, 532}) == 1.0);
  CHECK(source_band_W_m2(laser, {"", 500, 600}) == 1.0);
  CHECK(source_band_W_m2(laser, {"", 533, 600}) == 0.0);
  Source s = sun();
  s.spectrum = Spectrum{{400, 500, 600}, {1.0, 2.0, 2.0}};
  CHECK(source_band_W_m2(s, {"", 400, 600}) == doctest::Approx(350.0).epsilon(1e-15));
  CHECK(source_band_W_m2(s, {"", 100, 900}) == doctest::Approx(350.0).epsilon(1e-15));
  CHECK(source_band_W_m2(s, {"", 700, 800}) == 0.0);
  CHECK(source_spectral_W_m2_nm(s, 450) == 1.5);
  CHECK(source_spectral_W_m2_nm(s, 601) == 0.0);
}

TEST_CASE("spectrum: bands of a scene") {
  Scene scene;
  REQUIRE(bands_of(scene).size() == 1);
  CHECK(bands_of(scene)[0].name == "532");
  CHECK(bands_of(scene)[0].low_nm == bands_of(scene)[0].high_nm);
  scene.source.kind = Source::Kind::sun;
  CHECK(bands_of(scene)[0].name == "400-700");
  scene.source.bands = {make_band(400, 462.5), make_band(500, 600)};
  REQUIRE(bands_of(scene).size() == 2);
  CHECK(bands_of(scene)[0].name == "400-462.5");
}

TEST_CASE("spectrum: CSV tables are read strictly") {
  const test::SceneFolder folder;
  const auto said = [&](const std::string& text) {
    const std::string file = folder.write("t.csv", text);
    const std::string what = complaint(file);
    return what.compare(0, file.size(), file) == 0 ? what.substr(file.size()) : what;
  };
  CHECK(said("# rho\nwavelength_nm,value\n400, 0.1\r\n500,0.5 # end\n\n") == "fine");
  CHECK(said("400,0.1\n400,0.2\n") == ":2: wavelength_nm: must increase from row to row, but 400 follows 400");
  CHECK(said("# c\n400,0.1\n500,1.5\n") == ":3: value: expected a number in [0,1], found 1.5");
  CHECK(said("400,0.1\n500\n") == ":2: expected 2 columns (wavelength_nm,value), found 1");
  CHECK(said("400,0.1x\n") == ":1: value: expected a finite number, found '0.1x'");
  CHECK(said("400,nan\n") == ":1: value: expected a finite number, found 'nan'");
  CHECK(said("400,1e400\n") == ":1: value: expected a finite number, found '1e400'");
  CHECK(said("400,\n") == ":1: value: expected a finite number, found ''");
  CHECK(said("wavelength_nm,value\nc,d\n") == ":2: wavelength_nm: expected a finite number, found 'c'");
  CHECK(said("-400,0.1\n") == ":1: wavelength_nm: expected a number in [0.001,1000000000], found -400");
  CHECK(said("# nothing\n") == ": holds no rows of wavelength_nm,value");
}

TEST_CASE("spectrum: attitude and BRDF tables") {
  const test::SceneFolder folder;
  const std::vector<Attitude> a =
      read_attitudes(folder.write("a.csv", "time_s,qw,qx,qy,qz\n0,1,0,0,0\n2,0,0.6,0.8,0.0001\n"));
  REQUIRE(a.size() == 2);
  CHECK(a[1].time_s == 2.0);
  CHECK(a[1].body_to_space.x == doctest::Approx(0.6).epsilon(1e-8));
  CHECK_THROWS_WITH_AS(read_attitudes(folder.write("b.csv", "time_s,qw,qx,qy,qz\n0,1,1,0,0\n")),
                       doctest::Contains("b.csv:2: qw,qx,qy,qz: expected a quaternion of length 1"), Error);
  const BrdfTable b = read_brdf_table(folder.write("f.csv",
                                                   "theta_i_deg,theta_o_deg,phi_deg,value\n0,0,0,1\n90,0,0,2\n0,90,0,"
                                                   "3\n90,90,0,4\n0,0,180,5\n90,0,180,6\n0,90,180,7\n90,90,180,8\n"));
  CHECK(b.value == std::vector<double>{1, 5, 3, 7, 2, 6, 4, 8});
  CHECK(b.phi_rad[1] == doctest::Approx(static_cast<double>(kPi)).epsilon(1e-15));
  CHECK_THROWS_WITH_AS(
      read_brdf_table(folder.write("g.csv", "0,0,0,1\n90,0,0,2\n0,90,0,3\n")),
      doctest::Contains("the grid of 2 x 2 x 1 angles lacks theta_i_deg 90, theta_o_deg 90, phi_deg 0"), Error);
  CHECK_THROWS_WITH_AS(read_brdf_table(folder.write("h.csv", "0,0,0,1\n0,0,0,2\n")),
                       doctest::Contains("h.csv:2: the same angles as line 1"), Error);
}
