// SPDX-License-Identifier: Apache-2.0
// Convolution with the transmit pulse, and the link budget, against closed forms.
#include <doctest/doctest.h>

#include <cmath>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/session.hpp"
#include "scene/file/keys.hpp"
#include "slr/link.hpp"
#include "slr/pulse.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

/// Sum, mean and variance of a histogram as a density, in long double.
struct Sums {
  long double mass = 0, mean = 0, variance = 0;
};

Sums sums_of(const Histogram& h) {
  Sums s;
  for (const double m : h.mass) s.mass += m;
  const auto centre = [&](std::size_t i) { return h.first_s + (i + 0.5L) * h.width_s; };
  for (std::size_t i = 0; i < h.mass.size(); ++i) s.mean += h.mass[i] * centre(i) / s.mass;
  for (std::size_t i = 0; i < h.mass.size(); ++i) {
    s.variance += h.mass[i] * (centre(i) - s.mean) * (centre(i) - s.mean) / s.mass;
  }
  s.variance += static_cast<long double>(h.width_s) * h.width_s / 12.0L;
  return s;
}

Histogram body() {
  Histogram h{-3e-9, 0.05e-9, {}};
  for (int i = 0; i < 120; ++i) h.mass.push_back(i % 7 == 3 ? 0.0 : 1.0 / (1 + i % 11));
  return h;
}

/// Cutting bins keeps a density's variance; so the sum of the variances is what is expected.
void check_convolution(const Station& station, double variance_tolerance) {
  const Histogram before = body();
  const Histogram after = convolve(before, pulse_kernel(station, before.width_s));
  const Sums a = sums_of(before), b = sums_of(after);
  const PulseMoments pulse = pulse_moments(station);
  CHECK(std::fabs(static_cast<double>(b.mass / a.mass - 1.0L)) < 1e-14);
  const double scale = std::sqrt(static_cast<double>(b.variance)) + std::fabs(pulse.mean_s);
  CHECK(std::fabs(static_cast<double>(b.mean - a.mean) - pulse.mean_s) < 1e-13 * scale);  // rounding of 10^3 terms
  CHECK(std::fabs(static_cast<double>(b.variance - a.variance) - pulse.variance_s2) < variance_tolerance);
  for (const double m : after.mass) REQUIRE(m >= 0.0);
}

Station lit() {
  Station s;
  s.name = "test";
  return s;
}

DelayResult one_bin(double mass) {
  DelayResult d;
  d.first_bin_start_s = -0.5e-9;
  d.bin_width_s = 1e-9;
  d.bin_m2_per_sr = {mass};
  return d;
}

}  // namespace

TEST_CASE("Gaussian pulses from far below a bin to far above") {
  Station station = lit();
  for (const double fwhm_ps : {1.0, 20.0, 60.0, 117.0, 300.0, 2000.0}) {
    CAPTURE(fwhm_ps);
    station.pulse_fwhm_s = fwhm_ps * 1e-12;
    const double sigma = station.pulse_fwhm_s / 2.3548200450309493;
    CHECK(pulse_moments(station).variance_s2 == doctest::Approx(sigma * sigma).epsilon(1e-14));
    // Rounding of the body's own variance, 3e-18 s^2, and of the pulse's.
    check_convolution(station, 1e-13 * (3e-18 + sigma * sigma));
  }
}

TEST_CASE("a Gaussian pulse on one bin is the Gaussian") {
  Station station = lit();
  station.pulse_fwhm_s = 1e-9;
  Histogram line{0.0, 0.01e-9, {1.0}};
  const Histogram after = convolve(line, pulse_kernel(station, line.width_s));
  const double sigma = 1e-9 / 2.3548200450309493;
  for (std::size_t i = 0; i < after.mass.size(); i += 7) {
    const double t = after.first_s + (static_cast<double>(i) + 0.5) * after.width_s - 0.005e-9;
    const double density = std::exp(-0.5 * (t / sigma) * (t / sigma)) / (sigma * std::sqrt(2.0 * constants::kPi));
    CHECK(after.mass[i] / after.width_s == doctest::Approx(density).epsilon(1e-9));
  }
}

TEST_CASE("a pulse from a table: asymmetric, off centre, with unequal steps") {
  Station station = lit();
  station.pulse = {{0.0, 0.0}, {0.13e-9, 2.0}, {0.2e-9, 1.7}, {0.9e-9, 0.1}, {1.4e-9, 0.0}};
  check_convolution(station, 1e-13 * 3e-18);
  station.pulse = {{-0.08e-9, 1.0}, {0.0, 1.0}};  // a short box, ending at time zero
  const PulseMoments box = pulse_moments(station);
  CHECK(box.mean_s == doctest::Approx(-0.04e-9).epsilon(1e-14));
  CHECK(box.variance_s2 == doctest::Approx(0.08e-9 * 0.08e-9 / 12.0).epsilon(1e-13));
  check_convolution(station, 1e-13 * 3e-18);
  station.pulse = {{0.0, 0.0}, {0.0005e-9, 1.0}, {0.001e-9, 0.0}};  // far below a bin: the grid's limit
  check_convolution(station, std::pow(0.05e-9 / 128.0, 2));
}

TEST_CASE("a delta pulse equals no pulse bit for bit") {
  const Histogram before = body();
  const Histogram after = convolve(before, pulse_kernel(lit(), before.width_s));
  CHECK(after.mass == before.mass);
  CHECK(after.first_s == before.first_s);
  CHECK(after.width_s == before.width_s);
  DelayResult d = one_bin(0.0);
  d.bin_m2_per_sr = before.mass;
  const auto rates = photons_per_ns(d, lit(), 1e6);
  const double photons = 4.0 * constants::kPi * link_budget(lit(), 532.0, 1e6).photons_per_m2 / (d.bin_width_s * 1e9);
  for (std::size_t i = 0; i < rates.size(); ++i) CHECK(rates[i] == before.mass[i] * photons);
}

TEST_CASE("photons per ns keep their bins and all energy that stays in the window") {
  DelayResult d = one_bin(0.0);
  d.bin_width_s = 0.1e-9;
  d.bin_m2_per_sr.assign(400, 0.0);
  d.bin_m2_per_sr[200] = 2.0;
  Station station = lit();
  const double all = 2.0 * 4.0 * constants::kPi * link_budget(station, 532.0, 1e6).photons_per_m2;
  for (const double fwhm_ps : {10.0, 100.0, 800.0}) {
    station.pulse_fwhm_s = fwhm_ps * 1e-12;
    const auto rates = photons_per_ns(d, station, 1e6);
    double sum = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      sum += rates[i] * 0.1;
      mean += rates[i] * 0.1 * static_cast<double>(i);
    }
    CHECK(rates.size() == 400);
    CHECK(sum == doctest::Approx(all).epsilon(1e-13));
    CHECK(mean / sum == doctest::Approx(200.0).epsilon(1e-3));
  }
}

TEST_CASE("a pulse far longer than the bins: bounded work, the same energy and density") {
  // A box of 1 us on bins of 1 fs has 10^9 of them; the histogram is one line among 4000 bins.
  Station station = lit();
  station.pulse = {{-0.5e-6, 1.0}, {0.5e-6, 1.0}};
  DelayResult d = one_bin(0.0);
  d.bin_width_s = 1e-15;
  d.bin_m2_per_sr.assign(4000, 0.0);
  d.bin_m2_per_sr[2000] = 2.0;
  const double all = 2.0 * 4.0 * constants::kPi * link_budget(station, 532.0, 1e6).photons_per_m2;
  const auto rates = photons_per_ns(d, station, 1e6);
  REQUIRE(rates.size() == 4000);
  // 1 us is 1000 ns. Merged bins are 1/16384 of the pulse: so much of it may stand one bin aside.
  for (const double rate : rates) CHECK(rate == doctest::Approx(all / 1000.0).epsilon(1e-3));
  station.pulse.clear();
  station.pulse_fwhm_s = 1e-6;
  const double peak = 2.0 * std::sqrt(std::log(2.0) / constants::kPi) / 1000.0;  // per ns, of a Gaussian
  for (const double rate : photons_per_ns(d, station, 1e6)) CHECK(rate == doctest::Approx(all * peak).epsilon(1e-3));
  const Histogram wide = smear({0.0, 1e-15, {1.0}}, station);
  CHECK(total(wide.mass) == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(wide.mass.size() < 40000);
  // Where nothing needs to be merged, it is the convolution to the last bit.
  const Histogram before = body();
  station.pulse_fwhm_s = 1e-10;
  CHECK(smear(before, station).mass == convolve(before, pulse_kernel(station, before.width_s)).mass);
}

TEST_CASE("the link budget by hand") {
  // The paper's station; 1 m^2 at 1000 km. Each factor worked out apart from the code.
  const LinkBudget b = link_budget(lit(), 532.0, 1e6);
  CHECK(b.photons_sent == doctest::Approx(0.08 / 3.733922e-19).epsilon(1e-5));  // h c / 532 nm
  CHECK(b.gain == doctest::Approx(8.0 / 6.25e-10).epsilon(1e-14));
  CHECK(b.receiver_area_m2 == doctest::Approx(0.19634954084936207).epsilon(1e-14));
  CHECK(b.spread_per_m4 == doctest::Approx(6.332573977646111e-27).epsilon(1e-13));
  CHECK(b.photons_per_m2 == doctest::Approx(3.4099265).epsilon(1e-7));
  Station station = lit();
  station.T_a = 0.5;
  station.eta_q = 0.2;
  station.pointing_rad = station.divergence_rad;
  CHECK(link_budget(station, 532.0, 2e6).photons_per_m2 ==
        doctest::Approx(b.photons_per_m2 * 0.25 * 0.2 * std::exp(-2.0) / 16.0).epsilon(1e-13));
}

TEST_CASE("the table names every factor with unit, default and range") {
  const std::string table = link_text(link_rows(lit(), 532.0, 2.5, {1e6, 1e6}));
  for (const char* key : {"pulse_energy_J",
                          "divergence_urad",
                          "pointing_urad",
                          "aperture_m",
                          "eta_q",
                          "eta_t",
                          "eta_r",
                          "T_a",
                          "T_c",
                          "range_m",
                          "wavelength_nm",
                          "noise_per_ns",
                          "gate_ns",
                          "jitter_fwhm_ps",
                          "dead_time_ns",
                          "dark_per_ns",
                          "rate_Hz",
                          "photoelectrons per pulse",
                          "default",
                          "unit"}) {
    CAPTURE(key);
    CHECK(table.find(key) != std::string::npos);
  }
  for (const KeyRow& row : key_rows("station")) {
    CAPTURE(row.key.name);
    if (row.kind != KeyKind::number || row.key.name == "start_mjd") continue;
    const bool of_crd = row.key.meaning.rfind("CRD: ", 0) == 0;  // weather and the like, on which no photon depends
    CHECK((table.find(row.key.name + " ") == std::string::npos) == of_crd);
  }
  CHECK(table.find("8.52482") != std::string::npos);  // 2.5 m^2 times 3.409927 photons per m^2
}

TEST_CASE("stations that make no sense are refused by key") {
  const auto refused = [](const char* words, auto&& change, double range = 1e6, double wavelength = 532.0) {
    Station s = lit();
    change(s);
    CHECK_THROWS_WITH_AS(link_budget(s, wavelength, range), doctest::Contains(words), Error);
  };
  refused("station.divergence_rad: expected a number in [1e-9,4e6] urad, found 0",
          [](Station& s) { s.divergence_rad = 0.0; });
  refused(
      "station.range_m: expected a number in [1e-3,1e13], found -1", [](Station&) {}, -1.0);
  refused(
      "station.range_m: expected a number in [1e-3,1e13], found nan", [](Station&) {}, std::nan(""));
  refused(
      "source.wavelength_nm: expected a number in (0,1e7], found 0", [](Station&) {}, 1e6, 0.0);
  refused("station.eta_q: expected a number in [0,1], found 1.5", [](Station& s) { s.eta_q = 1.5; });
  refused("station.noise_per_ns: expected a number in [0,1e6], found -0.1", [](Station& s) { s.noise_per_ns = -0.1; });
  refused("station.gate_s: expected a number in (0,1e9] ns, found 0", [](Station& s) { s.gate_s = 0.0; });
  refused("station.aperture_m: expected a number in (0,1e6], found 0", [](Station& s) { s.aperture_m = 0.0; });
  refused("station.rate_Hz: expected a number in [1e-9,1e12], found inf", [](Station& s) { s.rate_Hz = INFINITY; });
  Station s = lit();
  s.pulse = {{0.0, 1.0}, {0.0, 1.0}};
  CHECK_THROWS_WITH_AS(pulse_kernel(s, 1e-9), doctest::Contains("station.pulse: point 2: time does not increase"),
                       Error);
  s.pulse = {{0.0, 1.0}, {1e-9, -1.0}};
  CHECK_THROWS_AS(pulse_kernel(s, 1e-9), Error);
  s.pulse = {{0.0, 0.0}, {1e-9, 0.0}};
  CHECK_THROWS_WITH_AS(pulse_kernel(s, 1e-9), doctest::Contains("no energy"), Error);
}
