// SPDX-License-Identifier: Apache-2.0
// First-photon statistics against closed forms and the exact distribution (docs/physics.md, section 5), at 10^7 shots.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "clray/error.hpp"
#include "shared/photon.h"
#include "slr/gate.hpp"

using namespace clray;
using namespace clray::slr;

namespace {

constexpr std::uint32_t kMany = 10000000;

Shots many(const Gate& gate, double noise_per_ns, std::uint64_t seed, std::uint32_t count = kMany,
           double jitter_ns = 0.0) {
  Shots shots;
  sample_shots(gate, {1.0}, {noise_per_ns, jitter_ns, seed, 0}, 0, count, &shots);
  return shots;
}

/// A share within 4 standard errors of a probability.
void check_share(double hits, double count, double probability) {
  const double error = std::sqrt(probability * (1.0 - probability) / count);
  CHECK(std::fabs(hits / count - probability) < 4.0 * error + 1e-300);
}

/// Bins of equal mass on [0, gate] ns, centred on delay zero.
Gate gate_of(const std::vector<double>& mass, double gate_ns) {
  return make_gate({-0.5e-9 * gate_ns, 1e-9 * gate_ns / static_cast<double>(mass.size()), mass}, 1e-9 * gate_ns);
}

/// Kolmogorov-Smirnov distance of detection times from the exact distribution given a detection, in long double.
double ks_statistic(const Gate& gate, double noise_per_ns, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const auto expected = [&](long double t) {
    std::size_t i = 0;
    while (i + 2 < gate.edges() && gate.table[2 * i + 2] <= t) ++i;
    const long double t0 = gate.table[2 * i], t1 = gate.table[2 * i + 2];
    const long double s0 = gate.table[2 * i + 1], s1 = gate.table[2 * i + 3];
    return s0 + (s1 - s0) * ((t - t0) / (t1 - t0)) + static_cast<long double>(noise_per_ns) * t;
  };
  const long double all = -expm1l(-expected(gate.table[2 * gate.edges() - 2]));
  const auto n = static_cast<long double>(times.size());
  long double worst = 0.0L;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const long double cdf = -expm1l(-expected(times[i])) / all;
    worst = std::max({worst, std::fabs(cdf - i / n), std::fabs(cdf - (i + 1) / n)});
  }
  return static_cast<double>(worst * sqrtl(n));
}

std::vector<double> detected(const Shots& shots) {
  std::vector<double> times;
  for (std::size_t i = 0; i < shots.kind.size(); ++i) {
    if (shots.kind[i] != CLRAY_PHOTON_NONE) times.push_back(shots.time_ns[i]);
  }
  return times;
}

// P(sqrt(n) D > 1.95) = 0.001 (Kolmogorov); seeds are fixed, so the test is repeatable.
constexpr double kKolmogorov = 1.95;

}  // namespace

TEST_CASE("constant 0.001/ns over 100 ns: detection probability and mean time") {
  const Gate gate = gate_of({0.0}, 100.0);
  const auto times = detected(many(gate, 0.001, 1));
  const double p = -std::expm1(-0.1);
  check_share(static_cast<double>(times.size()), kMany, p);
  double sum = 0.0, squares = 0.0;
  for (const double t : times) {
    sum += t;
    squares += t * t;
  }
  const double n = static_cast<double>(times.size()), mean = sum / n;
  // E(t | t < T) = 1/a - T exp(-aT)/(1 - exp(-aT))
  const double exact = 1000.0 - 100.0 * std::exp(-0.1) / p;
  CHECK(std::fabs(mean - exact) < 4.0 * std::sqrt((squares / n - mean * mean) / n));
}

TEST_CASE("a narrow peak of two photons at 50 ns: shares before, in, after the peak and none") {
  std::vector<double> mass(1000, 0.0);
  mass[500] = 2.0;  // [50, 50.1] ns
  const Gate gate = gate_of(mass, 100.0);
  const Shots shots = many(gate, 0.001, 2);
  double before = 0, in = 0, after = 0, none = 0, signal = 0;
  for (std::size_t i = 0; i < shots.kind.size(); ++i) {
    const double t = shots.time_ns[i];
    if (shots.kind[i] == CLRAY_PHOTON_NONE)
      ++none;
    else if (t < 50.0)
      ++before;
    else if (t <= 50.1)
      ++in;
    else
      ++after;
    signal += shots.kind[i] == CLRAY_PHOTON_SIGNAL;
    if (shots.kind[i] == CLRAY_PHOTON_SIGNAL && !(t >= 50.0 && t <= 50.1)) FAIL("signal outside the peak");
  }
  const double l1 = 0.05, l2 = l1 + 2.0001, l3 = l2 + 0.0499;
  check_share(before, kMany, -std::expm1(-l1));
  check_share(in, kMany, std::exp(-l1) - std::exp(-l2));
  check_share(after, kMany, std::exp(-l2) - std::exp(-l3));
  check_share(none, kMany, std::exp(-l3));
  check_share(signal, kMany, (std::exp(-l1) - std::exp(-l2)) * (2.0 / 2.0001));
}

TEST_CASE("the exact distribution: everything in one bin, a million photons, ramps and dark stretches") {
  std::vector<double> one(512, 0.0), million(512, 0.0), ramp(512, 0.0);
  one[137] = 0.7;
  for (int i = 100; i < 400; ++i) million[static_cast<std::size_t>(i)] = 1e6 / 300.0;
  for (int i = 0; i < 512; ++i)
    ramp[static_cast<std::size_t>(i)] = i % 64 < 32 ? 0.0 : 1e-5 * i * i * (i > 300 ? 1e-4 : 1.0);
  const std::uint32_t count = 1000000;
  for (const double noise : {0.0, 0.001}) {
    CAPTURE(noise);
    std::uint64_t seed = 10;
    for (const auto* mass : {&one, &million, &ramp}) {
      const Gate gate = gate_of(*mass, 51.2);
      const auto times = detected(many(gate, noise, ++seed, count));
      const double all = photon_expected(gate.table.data(), gate.edges() - 1, 1.0, noise);
      check_share(static_cast<double>(times.size()), count, -std::expm1(-all));
      CHECK(ks_statistic(gate, noise, times) < kKolmogorov);
      if (noise > 0.0) continue;
      for (const double t : times) {
        // No light, no photon: the bin that holds t has mass (its lower edge counts as inside).
        const auto bin = std::min<std::size_t>(static_cast<std::size_t>(t / 0.1 + 1e-9), 511);
        if (!((*mass)[bin] > 0.0 || (bin > 0 && (*mass)[bin - 1] > 0.0)))
          FAIL("a photon where there is no light: " << t);
      }
    }
  }
}

TEST_CASE("10^-12 photons: the inverse is exact where 1 - exp(-x) would not be") {
  const Gate gate = gate_of({0.25e-12, 0.5e-12, 0.0, 0.25e-12}, 40.0);
  for (int k = 1; k < 1000; ++k) {
    const double u = 1e-12 * k / 1000.0;
    const double level = -el_log1p(-u);
    const std::uint32_t bin = photon_bin(gate.table.data(), gate.edges(), 1.0, 0.0, level);
    const double t = photon_time(gate.table.data(), bin, 1.0, 0.0, level);
    const double share = static_cast<double>(-log1pl(-static_cast<long double>(u)) / 1e-12L);
    const double exact = share < 0.25   ? 40.0 * share
                         : share < 0.75 ? 10.0 + 20.0 * (share - 0.25)
                                        : 30.0 + 40.0 * (share - 0.75);
    CHECK(t == doctest::Approx(exact).epsilon(1e-12));  // a few roundings of numbers near 40
  }
  // With noise of the same smallness the share of detections over 10^7 shots is zero, and none is invented.
  CHECK(detected(many(gate, 1e-14, 3, 1000000)).empty());
}

TEST_CASE("uniforms are multiples of 2^-53 in [0,1)") {
  CHECK(photon_uniform(0u, 0u) == 0.0);
  CHECK(photon_uniform(0u, 0x7ffu) == 0.0);
  CHECK(photon_uniform(0u, 0x800u) == std::ldexp(1.0, -53));
  CHECK(photon_uniform(0xffffffffu, 0xffffffffu) == 1.0 - std::ldexp(1.0, -53));
}

TEST_CASE("any part of a session can be redone alone, on any number of threads") {
  std::vector<double> mass(64, 0.01);
  const Gate gate = gate_of(mass, 100.0);
  Shots all, part;
  sample_shots(gate, {1.0}, {0.001, 0.2, 77, 1}, 0, 100000, &all);
  sample_shots(gate, {1.0}, {0.001, 0.2, 77, 3}, 40000, 50000, &part);
  for (std::size_t i = 0; i < part.kind.size(); ++i) {
    REQUIRE(part.kind[i] == all.kind[i + 40000]);
    REQUIRE(part.time_ns[i] == all.time_ns[i + 40000]);
  }
}

TEST_CASE("brightness per shot scales the signal alone") {
  std::vector<double> mass(10, 0.1);
  const Gate gate = gate_of(mass, 100.0);
  std::vector<double> brightness(2000000, 0.5);
  Shots each, same;
  sample_shots(gate, brightness, {0.001, 0.0, 5, 0}, 0, 2000000, &each);
  sample_shots(gate, {0.5}, {0.001, 0.0, 5, 0}, 0, 2000000, &same);
  CHECK(each.time_ns == same.time_ns);
  check_share(static_cast<double>(detected(each).size()), 2e6, -std::expm1(-0.6));
}

TEST_CASE("jitter: a Gaussian of the stated width on a sharp line") {
  std::vector<double> mass(100000, 0.0);
  mass[50000] = 3.0;  // 1 ps wide
  const double sigma = 0.5;
  const auto times = detected(many(gate_of(mass, 100.0), 0.0, 8, 1000000, sigma));
  double sum = 0.0, squares = 0.0;
  for (const double t : times) {
    sum += t - 50.0005;
    squares += (t - 50.0005) * (t - 50.0005);
  }
  const double n = static_cast<double>(times.size());
  CHECK(std::fabs(sum / n) < 4.0 * sigma / std::sqrt(n) + 1e-3);  // half a bin
  CHECK(std::fabs(squares / n - sigma * sigma) < 4.0 * sigma * sigma * std::sqrt(2.0 / n) + 1e-6);
}

TEST_CASE("a gate cuts bins at its ends and refuses to be shorter than one") {
  const Gate gate = make_gate({-6e-9, 4e-9, {1.0, 2.0, 4.0}}, 8e-9);  // bins [-6,-2] [-2,2] [2,6], gate [-4,4]
  CHECK(gate.signal() == doctest::Approx(0.5 + 2.0 + 2.0).epsilon(1e-15));
  CHECK(expected_until(gate, 2.0, 1.0, 0.0) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(expected_until(gate, 4.0, 2.0, 0.1) == doctest::Approx(3.4).epsilon(1e-14));
  CHECK(expected_until(gate, 100.0, 1.0, 0.0) == gate.signal());
  // Within a bin the light is spread evenly: a gate of half a bin catches half of it.
  CHECK(make_gate({-2e-9, 4e-9, {1.0}}, 2e-9).signal() == 0.5);
}

TEST_CASE("speed of the shots on this host, printed") {
  for (const double photons : {0.1, 10.0}) {  // mostly none; nearly always one
    const Gate gate = gate_of(std::vector<double>(512, photons / 512), 100.0);
    Shots shots;
    sample_shots(gate, {1.0}, {0.001, 0.0, 1, 1}, 0, 1 << 20, &shots);
    const std::clock_t begin = std::clock();  // CPU time: other programs do not count
    for (int k = 0; k < 4; ++k) sample_shots(gate, {1.0}, {0.001, 0.0, 1, 1}, 0, 1 << 20, &shots);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    MESSAGE("photons a shot " << photons << ": shots per second and core " << 4.0 * (1 << 20) / seconds);
    CHECK(shots.kind.size() == (1u << 20));
  }
}
