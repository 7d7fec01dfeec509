// SPDX-License-Identifier: Apache-2.0
// Filters by name, the Sun and Vega: magnitudes of the Sun against published ones and against an integration of the
// sources' own tables in another language, how scene files name filters, and extinction's rules.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/constants.hpp"
#include "scene/spectrum.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::check_of;
using clray::test::SceneFolder;

namespace {

constexpr const char* kBody = "[[component]]\nshape = \"sphere\"\n[source]\nkind = \"sun\"\n";

Source sun() {
  Source s;
  s.kind = Source::Kind::sun;
  s.spectrum = solar_spectrum();
  return s;
}

double magnitude(const Band& band, double zero) {
  return -2.5 * std::log10(source_band_W_m2(sun(), band) / zero);
}

struct Published {
  const char* band;
  double AB, Vega;            // apparent, at 1 au
  double photons, over_vega;  // by photons: AB, and against Vega's own light
};

constexpr double kNone = 0.0;

// Published: absolute magnitudes less 31.572 (1 au at 10 pc), Willmer (2018), table 3; G of Casagrande & VandenBerg
// (2018). The last two columns are sums of photon responses, the Sun and Vega as the sources tabulate them, by a
// Python script on a four times finer grid.
constexpr Published kPublished[] = {
    {"B", -26.26, -26.13, -26.2484, -26.1322}, {"V", -26.77, -26.76, -26.7728, -26.7789},
    {"R", -26.97, -27.14, -26.9657, -27.1656}, {"I", -27.06, -27.47, -27.0550, -27.5036},
    {"G", kNone, -26.90, -26.7901, -26.9176},  {"g", -26.46, kNone, -26.4529, -26.3460},
    {"r", -26.92, kNone, -26.9322, -27.0755},  {"i", -27.04, kNone, -27.0387, -27.4023},
    {"z", -27.07, kNone, -27.0586, -27.5871}};

}  // namespace

TEST_CASE("magnitudes of the Sun: within 0.03 of the published ones, and those of the sources' tables") {
  REQUIRE(photometric_bands().size() == std::size(kPublished));
  for (const Published& p : kPublished) {
    CAPTURE(p.band);
    const Band band = photometric_band(p.band);
    const double AB = magnitude(band, ab_zero_W_m2(band)), vega = magnitude(band, vega_zero_W_m2(band));
    if (p.AB != kNone) CHECK(std::fabs(AB - p.AB) <= 0.03);
    if (p.Vega != kNone) CHECK(std::fabs(vega - p.Vega) <= 0.03);
    // Responses are linear in energy here and in photons there, 10 nm apart at most: (10 nm/300 nm)² / 8 = 1e-4.
    CHECK(std::fabs(AB - p.photons) <= 5e-4);
    // Vega stands in cells of 1 nm.
    CHECK(std::fabs(vega - band.vega_magnitude - p.over_vega) <= 1e-3);
    CHECK(is_photometric(band));
  }
  CHECK_THROWS_WITH(photometric_band("W"), doctest::Contains("expected one of B, V, R, I, G, g, r, i, z"));
}

TEST_CASE("the Sun's table holds 1361 W/m2 to half a percent, and Vega 3.56e-11 W/m2/nm at 548 nm") {
  double sum = 0.0;
  const Spectrum& s = solar_spectrum();
  for (std::size_t i = 1; i < s.value.size(); ++i)
    sum += 0.5 * (s.value[i] + s.value[i - 1]) * (s.wavelength_nm[i] - s.wavelength_nm[i - 1]);
  CHECK(sum == doctest::Approx(constants::kSolarConstant_W_m2).epsilon(0.005));
  // Megessier (1995): 3.46e-9 erg/s/cm²/Å at 555.6 nm, to 0.7 %; Bohlin (2014) 3.44e-9.
  CHECK(spectrum_mean(vega_spectrum(), 554.6, 556.6) == doctest::Approx(3.45e-11).epsilon(0.01));
}

TEST_CASE("scene files name filters; a sun of which they say nothing else is the Sun") {
  const SceneFolder folder;
  folder.write("v.csv", "500,0\n550,1\n600,0\n");
  folder.write("V.csv", "500,0\n550,1\n600,0\n");
  const auto source = [&](const std::string& keys) { return folder.load(kBody + keys + "\n").source; };
  const Source named = source(R"(bands = ["V", "v.csv", "G", "g", [500, 600]])");
  REQUIRE(named.bands.size() == 5);
  CHECK(named.bands[0].response == photometric_band("V").response);
  CHECK(named.bands[1].name == "v");
  CHECK(named.bands[2].name == "G");
  CHECK(named.bands[3].name == "g");
  CHECK(named.bands[2].response != named.bands[3].response);
  REQUIRE(named.spectrum);
  CHECK(named.spectrum->value == solar_spectrum().value);
  const Source called = source(R"(bands = [{ filter = "V", name = "Johnson V" }, "V.csv"])");
  CHECK(called.bands[0].name == "Johnson V");
  CHECK(called.spectrum);
  CHECK_FALSE(is_photometric(called.bands[1]));
  CHECK_FALSE(source(R"(bands = ["V.csv"])").spectrum);
  CHECK_FALSE(source(R"(bands = ["V"]
blackbody_K = 5772)")
                  .spectrum);
  CHECK(source("spectrum = \"solar\"").spectrum->value == solar_spectrum().value);
}

TEST_CASE("what is wrong with a filter or an extinction is said where it stands") {
  const SceneFolder folder;
  const auto says = [&](const std::string& more) { return folder.complaint(kBody + more); };
  const auto holds = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  holds(says("bands = [\"U\"]\n"), "s.toml:5:10: source.bands: there is no file \"U\"");
  holds(says("bands = [\"U\"]\n"), "and no filter of the name; expected one of B, V, R, I, G, g, r, i, z");
  folder.write("curve", "500,0\n550,1\n600,0\n");
  CHECK(says("bands = [\"curve\"]\n") == "fine");
  holds(says("bands = [\"V\", \"V\"]\n"), "a second band of the name \"V\"");
  holds(says("bands = [{ filter = \"v\" }]\n"), "source.bands.filter: expected one of B, V");
  holds(says("bands = [{ filter = \"V\", low_nm = 3 }]\n"), "given beside filter");
  holds(says("bands = [\"V\"]\n[observer]\nextinction_mag = 0.2\n"),
        "s.toml:7:18: observer.extinction_mag: needs the elevation of the body");
  const std::string pass =
      "bands = [\"V\", \"g\"]\n[pass]\nstart = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:01:00Z\nstep_s = 60\n"
      "ephemeris = \"o.oem\"\n[observer]\necef_m = [6.4e6, 0, 0]\nextinction_mag = ";
  folder.write("o.oem", "");
  holds(says(pass + "{ V = 0.2 }\n"), "observer.extinction_mag: a number for the band \"g\" is missing");
  holds(says(pass + "{ V = 0.2, G = 0.1, g = 0.3 }\n"), "there is no band \"G\"; expected V, g");
  holds(says(pass + "-0.1\n"), "observer.extinction_mag: expected a number in [0,100], found -0.1");
  holds(says(pass + "{ V = nan, g = 0.1 }\n"), "observer.extinction_mag.V: expected a number in [0,100], found nan");
}
