// SPDX-License-Identifier: Apache-2.0
// First photons from 10⁻¹² to 10⁶ expected ones, a peak over 10⁻⁹ of noise, and shots numbered near 2³² and 2⁴⁰:
// the device's shots against a reference that shares nothing with kernels/ but the definition of its random numbers
// (docs/physics.md, section 5, shared/photon.h): Philox of tests/reference, inversion in long double. Times in ns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "device/shots.hpp"
#include "reference/sobol.hpp"
#include "shared/photon.h"
#include "slr/gate.hpp"
#include "stability/case.hpp"

namespace clray_test {

namespace {

using Long = long double;
constexpr double kEps = 0x1p-53;
constexpr double kGate_ns = 100.0;
constexpr std::uint64_t kSeed = 0x9e3779b97f4a7c15ull;
constexpr double kDecades[] = {1e-12, 1e-9, 1e-6, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e6};

/// What is expected over a gate, and the exact answers about it.
struct Light {
  clray::slr::Gate gate;
  double noise_per_ns = 0.0;

  std::size_t last() const { return gate.edges() - 1; }
  Long edge_ns(std::size_t i) const { return gate.table[2 * i]; }
  Long at_edge(std::size_t i) const {
    return gate.table[2 * i + 1] + static_cast<Long>(noise_per_ns) * gate.table[2 * i];
  }
  Long all() const { return at_edge(last()); }

  /// Photons expected up to a time.
  Long until(Long t) const {
    std::size_t low = 0, high = last();
    while (high - low > 1) (edge_ns((low + high) / 2) <= t ? low : high) = (low + high) / 2;
    return at_edge(low) + (at_edge(high) - at_edge(low)) * ((t - edge_ns(low)) / (edge_ns(high) - edge_ns(low)));
  }

  /// When `level` photons are expected, and how far fp64 may be off it: of 10 eps of the count at the bin's end by its
  /// slope (level 4, its two edges 2 each and their difference again), 3 eps of the bin and one of the time.
  struct Inverse {
    Long time, bound;
  };
  Inverse invert(Long level) const {
    std::size_t low = 0, high = last();
    while (high - low > 1) (at_edge((low + high) / 2) <= level ? low : high) = (low + high) / 2;
    const Long before = at_edge(low), after = at_edge(high), width = edge_ns(high) - edge_ns(low);
    const Long time = edge_ns(low) + (level - before) / (after - before) * width;
    return {time, kEps * (10.0L * after / (after - before) * width + 3.0L * width + time)};
  }
};

Light light_of(const std::vector<double>& mass, double noise) {
  const double width_s = 1e-9 * kGate_ns / static_cast<double>(mass.size());
  return {clray::slr::make_gate({-0.5e-9 * kGate_ns, width_s, mass}, 1e-9 * kGate_ns), noise / kGate_ns};
}

/// A pulse of 64 bins with a ramp, a dark stretch and a spike of half its light, over a hundredth of noise.
Light pulse(double expected) {
  std::vector<double> mass(64, 0.0);
  for (std::size_t i = 0; i < 24; ++i) mass[i] = 0.49 / 300.0 * static_cast<double>(i + 1);
  mass[40] = 0.5;
  for (std::size_t i = 50; i < 64; ++i) mass[i] = 1e-4;
  double sum = 0.0;
  for (double m : mass) sum += m;
  for (double& m : mass) m *= 0.99 * expected / sum;
  return light_of(mass, 0.01 * expected);
}

/// A shot by the definition.
struct Shot {
  Long level;  ///< photons expected until the first
  bool signal;
};

Shot reference_shot(const Light& light, std::uint64_t number) {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto random = clray_reference::philox({low(kSeed), low(kSeed >> 32)},
                                              {low(number), low(number >> 32), CLRAY_PHOTON_STREAM, 0u});
  const auto uniform = [&](std::size_t k) {
    const std::uint64_t word = static_cast<std::uint64_t>(random[k + 1]) << 32 | random[k];
    return std::ldexp(static_cast<Long>(word >> 11), -53);
  };
  Shot shot{-std::log1p(-uniform(0)), false};
  if (shot.level < light.all()) {
    std::size_t bin = 0;
    while (light.at_edge(bin + 1) <= shot.level) ++bin;
    const Long rate = light.at_edge(bin + 1) - light.at_edge(bin);
    const Long noise = static_cast<Long>(light.noise_per_ns) * (light.edge_ns(bin + 1) - light.edge_ns(bin));
    shot.signal = (rate - noise) * (1.0L - uniform(2)) > noise * uniform(2);
  }
  return shot;
}

struct Shots {
  std::vector<double> time_ns;
  std::vector<std::uint32_t> kind;
};

Shots device_shots(const Light& light, std::uint64_t first, std::uint32_t count) {
  Shots shots;
  const std::vector<double> brightness{1.0};
  clray::sample_shots_on(device(), {light.gate.table, brightness, light.noise_per_ns, 0.0, kSeed, first, count},
                         &shots.time_ns, &shots.kind);
  return shots;
}

/// Shots that differ from the definition's: in kind, or in time by more than the bound.
std::uint32_t wrong_shots(const Light& light, std::uint64_t first, const Shots& shots) {
  std::uint32_t wrong = 0;
  for (std::size_t i = 0; i < shots.kind.size(); ++i) {
    const Shot exact = reference_shot(light, first + i);
    const std::uint32_t kind = !(exact.level < light.all()) ? CLRAY_PHOTON_NONE
                               : exact.signal               ? CLRAY_PHOTON_SIGNAL
                                                            : CLRAY_PHOTON_NOISE;
    bool good = kind == shots.kind[i];
    if (good && kind != CLRAY_PHOTON_NONE) {
      const Light::Inverse inverse = light.invert(exact.level);
      good = std::fabs(shots.time_ns[i] - inverse.time) <= inverse.bound;
    }
    wrong += !good;
  }
  return wrong;
}

/// Kolmogorov's √n·D of detection times from [1 − exp(−Λ(t))]/[1 − exp(−Λ)].
double kolmogorov(const Light& light, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const Long all = -std::expm1(-light.all()), n = static_cast<Long>(times.size());
  Long worst = 0.0L;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Long share = -std::expm1(-light.until(times[i])) / all, rank = static_cast<Long>(i);
    worst = std::max({worst, std::fabs(share - rank / n), std::fabs(share - (rank + 1.0L) / n)});
  }
  return static_cast<double>(worst * std::sqrt(n));
}

/// P(√n·D > 1.95) = 0.001.
constexpr double kKolmogorov = 1.95;

Outcome detections() {
  constexpr std::uint32_t kShots = 1u << 20;
  Outcome outcome{true, ""};
  double worst = 0.0, furthest = 0.0;
  int compared = 0;
  for (double expected : kDecades) {
    const Light light = pulse(expected);
    const Shots shots = device_shots(light, 0, kShots);
    std::vector<double> times;
    for (std::size_t i = 0; i < kShots; ++i)
      if (shots.kind[i] != CLRAY_PHOTON_NONE) times.push_back(shots.time_ns[i]);
    const double p = -std::expm1(-expected), n = kShots, hits = static_cast<double>(times.size());
    const double off = std::fabs(hits - n * p) / std::sqrt(n * p * std::max(1.0 - p, 1e-12));
    furthest = std::max(furthest, off);
    outcome.pass = outcome.pass && off <= 4.0;
    if (times.size() < 100) continue;
    const double distance = kolmogorov(light, times);
    worst = std::max(worst, distance);
    outcome.pass = outcome.pass && distance <= kKolmogorov;
    ++compared;
  }
  outcome.measured =
      fmt::format("{} of 2^20 shots each: shares off by up to {:.1f} standard errors; √n·D up to {:.2f} for {} of them",
                  std::size(kDecades), furthest, worst, compared);
  return outcome;
}

Outcome shot_by_shot() {
  constexpr std::uint32_t kShots = 1u << 16;
  std::uint32_t wrong = 0;
  for (double expected : kDecades) {
    const Light light = pulse(expected);
    wrong += wrong_shots(light, 0, device_shots(light, 0, kShots));
  }
  return {wrong == 0, fmt::format("{} of {} shots differ", wrong, std::size(kDecades) * kShots)};
}

/// The share of the 2^53 uniforms that detect, by bisection: the decision is monotonic in them.
Outcome probability() {
  Outcome outcome{true, ""};
  double worst = 0.0;
  for (double expected : kDecades) {
    const Light light = pulse(expected);
    const double all = photon_expected(light.gate.table.data(), light.gate.edges() - 1, 1.0, light.noise_per_ns);
    std::uint64_t detects = 0, none = 1ull << 53;
    while (none - detects > 1) {
      const std::uint64_t middle = detects + (none - detects) / 2;
      (-el_log1p(-photon_uniform(static_cast<u32>(middle << 11 >> 32), static_cast<u32>(middle << 11))) < all ? detects
                                                                                                              : none) =
          middle;
    }
    const Long found = std::ldexp(static_cast<Long>(none), -53), exact = -std::expm1(-light.all());
    // The grid of uniforms, and 2 ulp of log1p beside two roundings of Λ.
    const Long bound = 0x1p-53L + 6.0L * kEps * light.all() * std::exp(-light.all());
    worst = std::max(worst, static_cast<double>(std::fabs(found - exact) / bound));
  }
  outcome.pass = worst <= 1.0;
  outcome.measured = fmt::format("off by up to {:.2f} of the bound", worst);
  return outcome;
}

/// photon_bin and photon_time of the kernel, compiled for the host, at levels over the whole gate.
double worst_inversion(const Light& light, const std::vector<double>& levels) {
  double worst = 0.0;
  const double* table = light.gate.table.data();
  for (double level : levels) {
    const std::uint32_t bin = photon_bin(table, light.gate.edges(), 1.0, light.noise_per_ns, level);
    const Light::Inverse exact = light.invert(level);
    const Long off = std::fabs(photon_time(table, bin, 1.0, light.noise_per_ns, level) - exact.time);
    worst = std::max(worst, static_cast<double>(off / exact.bound));
  }
  return worst;
}

Outcome inversion() {
  double worst = 0.0;
  for (double expected : kDecades) {
    std::vector<double> levels;
    for (int k = 0; k < 4000; ++k) {
      levels.push_back(expected * (k + 0.5) / 4000.0);
      levels.push_back(expected * std::pow(10.0, -0.004 * (k + 0.5)));
    }
    worst = std::max(worst, worst_inversion(pulse(expected), levels));
  }
  return {worst <= 1.0 && worst > 0.0, fmt::format("off by up to {:.2f} of the bound", worst)};
}

Outcome needle() {
  constexpr std::uint32_t kShots = 1u << 20;
  std::vector<double> mass(1000, 0.0), levels;
  mass[500] = 2.0;  // [50, 50.1] ns
  const Light light = light_of(mass, 2e-9);
  for (int k = 0; k < 1000; ++k) {
    const double share = (k + 0.5) / 1000.0;
    levels.insert(levels.end(), {1e-9 * share, 1e-9 + 2.0 * share, 2.0 + 1.002e-9 + 0.998e-9 * share});
  }
  const double worst = worst_inversion(light, levels);
  const Shots shots = device_shots(light, 0, kShots);
  double inside = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < kShots; ++i) {
    if (shots.kind[i] == CLRAY_PHOTON_NONE) continue;
    const bool in = shots.time_ns[i] >= 50.0 && shots.time_ns[i] <= 50.1 && shots.kind[i] == CLRAY_PHOTON_SIGNAL;
    (in ? inside : outside) += 1.0;
  }
  const double p = -std::expm1(-2.0), off = std::fabs(inside - kShots * p) / std::sqrt(kShots * p * (1.0 - p));
  return {worst <= 1.0 && outside == 0.0 && off <= 4.0,
          fmt::format("times off by up to {:.2f} of the bound; {:.0f} in the peak, {:.1f} standard errors off; {:.0f} "
                      "elsewhere",
                      worst, inside, off, outside)};
}

Outcome late_shots() {
  constexpr std::uint32_t kShots = 1u << 14;
  const Light light = pulse(3.0);
  std::uint32_t wrong = 0;
  std::set<double> times;
  std::size_t detected = 0;
  for (std::uint64_t middle : {1ull << 13, 1ull << 32, 1ull << 40, 3ull << 62}) {
    const std::uint64_t first = middle - kShots / 2;
    const Shots shots = device_shots(light, first, kShots);
    wrong += wrong_shots(light, first, shots);
    for (std::size_t i = 0; i < kShots; ++i) {
      if (shots.kind[i] == CLRAY_PHOTON_NONE) continue;
      times.insert(shots.time_ns[i]);
      ++detected;
    }
  }
  // 6·10⁴ times drawn from 2^53 levels: no two are equal, but streams that repeat make thousands so.
  return {wrong == 0 && times.size() == detected,
          fmt::format("{} of {} shots differ; {} of {} times distinct", wrong, 4 * kShots, times.size(), detected)};
}

}  // namespace

std::vector<Case> photon_cases() {
  const char* const kInverse = "10 eps·Λ/slope + 3 eps of the bin + eps of the time: roundings counted";
  return {
      {"statistics", "first photons, 10⁻¹² to 10⁶ expected", "1 − exp(−Λ) of them; times' distribution exact",
       "4 standard errors; Kolmogorov at 0.001 from 100 detections on", true, detections},
      {"statistics", "first photons, 10⁻¹² to 10⁶ expected, shot by shot", "kind and time as by the definition",
       kInverse, true, shot_by_shot},
      {"statistics", "probability of detection, 10⁻¹² to 10⁶ expected", "1 − exp(−Λ) of the 2^53 uniforms",
       "2^-53, the grid, + 6 eps·Λ·exp(−Λ): roundings of Λ and log1p", true, probability},
      {"statistics", "inversion of Λ, 10⁻¹² to 10⁶ expected", "long double's", kInverse, true, inversion},
      {"statistics", "a peak in one bin over 10⁻⁹ of noise", "all light in the peak, times exact before and after it",
       "2·10⁻³ shots expected elsewhere; 4 standard errors; 10 eps·Λ/slope", true, needle},
      {"statistics", "shots numbered about 2³², 2⁴⁰ and 3·2⁶²", "as by the definition; no stream repeats", kInverse,
       true, late_shots},
  };
}

}  // namespace clray_test
