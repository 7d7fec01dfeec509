// SPDX-License-Identifier: Apache-2.0
// See coverage.hpp.
#include "support/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace clray_test {

using clray::Estimate;
using clray::Result;
using clray::Scene;

namespace {

/// Student's t for 95 % and 15 degrees of freedom (16 replicates); the normal's where there are many.
constexpr double kStudent15 = 2.1314495455597742, kNormal = 1.9599639845400545;

Estimate interval(double value, double error, double width) {
  return {value, error, value - width * error, value + width * error, 0.0};
}

clray::SamplerKind sampler_of(bool sobol) {
  return sobol ? clray::SamplerKind::strata : clray::SamplerKind::random;
}

std::string sampler_name(bool sobol) {
  return sobol ? "Sobol" : "random";
}

CoverageScene delay_of_sphere(bool sobol) {
  CoverageScene c{"delay of a sphere, " + sampler_name(sobol), scene_of("sphere", {{"radius", 1.0}}, lambert(0.5)), {}};
  monostatic(c.scene, toward(0.7, 0.4));
  // The share returned from above the depth y·R below the top is 1 − (1 − y)³: mean 1/4, variance 3/80.
  const double twice = 2.0 / kLightSpeed;
  c.claims = {
      {"total", 1.0 / 3.0, [](const Result& r) { return r.delay.at(0).intensity_m2_per_sr; }},
      {"mean delay", -0.75 * twice, [](const Result& r) { return r.delay.at(0).mean_delay_s; }},
      {"rms width", std::sqrt(3.0 / 80.0) * twice, [](const Result& r) { return r.delay.at(0).rms_width_s; }},
  };
  return c;
}

CoverageScene delay_of_prism(bool sobol) {
  const MeshPtr mesh = prism_mesh(6, 1.0, 1.0);
  const clray::Vec3 s = toward(0.7, 0.4);
  CoverageScene c{"delay of a hexagonal prism, " + sampler_name(sobol), scene_of(mesh, lambert(0.5)), {}};
  monostatic(c.scene, s);
  c.claims = {{"total", convex_lambert(*mesh, 0.5, s, s).total_m2_per_sr,
               [](const Result& r) { return r.delay.at(0).intensity_m2_per_sr; }}};
  return c;
}

CoverageScene spectrometer(bool sobol) {
  CoverageScene c{"spectrometer, sphere at a phase angle, " + sampler_name(sobol),
                  scene_of("sphere", {{"radius", 1.0}}, lambert(1.0)),
                  {}};
  detect(bistatic(c.scene, toward(0.3), toward(1.5)), "spectrometer");
  c.claims = {{"total", 2.0 / 3.0 * lambert_phase(1.2),
               [](const Result& r) { return r.spectrometer.at(0).intensity_m2_per_sr; }}};
  return c;
}

/// Lambert sphere two metres off the reference point: F = π(1 + 4ρ/9), torque 2F.
CoverageScene pressure(bool sobol) {
  CoverageScene c{
      "pressure on a sphere, " + sampler_name(sobol), scene_of("sphere", {{"radius", 1.0}}, lambert(0.5)), {}};
  c.scene.components[0].transform.translate = {2, 0, 0};
  detect(c.scene, "pressure");
  const double force = kPi * (1.0 + 0.5 * 4.0 / 9.0);
  const auto axis = [](bool torque, int k) {
    return [=](const Result& r) {
      const clray::PressureResult& p = r.pressure.at(0);
      const clray::VectorEstimate& v = torque ? p.torque_coefficient_m3 : p.coefficient_m2;
      return interval(v.value[k], v.standard_error[k], kStudent15);
    };
  };
  c.claims = {{"force along the light", -force, axis(false, 2)},
              {"force across", 0.0, axis(false, 0)},
              {"torque", 2.0 * force, axis(true, 1)},
              {"torque across", 0.0, axis(true, 2)},
              {"absorbed", 0.5 * kPi, [](const Result& r) { return r.pressure.at(0).absorbed_m2; }}};
  return c;
}

/// Intensity of a band, the sum over pixels, whose errors are independent: ±1.96 of their sum in quadrature.
Estimate picture_total(const clray::ImageResult& image, std::size_t band) {
  const std::size_t pixels = image.coverage.size();
  const double area = image.pixel_m * image.pixel_m;
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = band * pixels; i < (band + 1) * pixels; ++i) {
    sum += image.radiance_per_sr[i] * area;
    squares += std::pow(image.standard_error_per_sr[i] * area, 2);
  }
  return interval(sum, std::sqrt(squares), kNormal);
}

CoverageScene picture(const std::string& kind, bool sobol) {
  clray::Material material = lambert(0.5);
  const std::vector<double> rho = kind == "rgb" ? std::vector<double>{0.5} : std::vector<double>{0.25, 0.35, 0.45};
  if (kind != "rgb") material.spectra["rho"] = clray::Spectrum{{400.0, 800.0}, {0.2, 0.6}};
  CoverageScene c{kind + " of a sphere, " + sampler_name(sobol), scene_of("sphere", {{"radius", 1.0}}, material), {}};
  if (kind != "rgb") {
    c.scene.source.kind = clray::Source::Kind::sun;
    c.scene.source.spectrum = clray::Spectrum{{300.0, 1100.0}, {1.0, 1.0}};
    c.scene.source.bands = {{"blue", 440.0, 460.0}, {"green", 540.0, 560.0}, {"red", 640.0, 660.0}};
  }
  detect(bistatic(c.scene, toward(0.3), toward(1.5)), kind, {{"width", 24.0}, {"height", 24.0}, {"samples", 16.0}});
  for (std::size_t b = 0; b < rho.size(); ++b)
    c.claims.push_back({fmt::format("intensity of band {}", b + 1), 2.0 / 3.0 * rho[b] * lambert_phase(1.2),
                        [b](const Result& r) { return picture_total(r.image.at(0), b); }});
  return c;
}

constexpr int kBins = 40;

void add_bin(double value, double error, std::uint64_t hits, double exact, ByHits* groups) {
  const std::size_t group = hits < 30 ? 0 : hits < 100 ? 1 : hits < 1000 ? 2 : 3;
  (*groups)[group].add(interval(value, error, kStudent15), exact);
}

/// A of bin b of a unit sphere of rho = 0.5 seen from +z, bins of equal depth from the top to the rim.
double exact_bin(int b) {
  const auto left = [](int k) { return std::pow(1.0 - 1.0 * k / kBins, 3); };
  return (left(b) - left(b + 1)) / 3.0;
}

}  // namespace

void Coverage::add(const Estimate& e, double exact) {
  ++intervals;
  no_error += e.standard_error == 0.0;
  held += e.standard_error != 0.0 && e.low <= exact && exact <= e.high;
}

double Coverage::share() const {
  return intervals > no_error ? 1.0 * held / (intervals - no_error) : 0.0;
}

bool Coverage::fair() const {
  return no_error == 0 && share() >= 0.92 && share() <= 0.98;
}

std::string Coverage::text() const {
  return fmt::format("{:.1f} % of {}{}", 100.0 * share(), intervals,
                     no_error ? fmt::format(", {} more without error", no_error) : "");
}

std::vector<CoverageScene> coverage_scenes() {
  std::vector<CoverageScene> scenes;
  for (const bool sobol : {true, false}) {
    for (CoverageScene c : {delay_of_sphere(sobol), delay_of_prism(sobol), spectrometer(sobol), pressure(sobol),
                            picture("rgb", sobol), picture("hyperspectral", sobol)}) {
      c.scene.trace.sampler = sampler_of(sobol);
      scenes.push_back(std::move(c));
    }
  }
  CoverageScene tiles = delay_of_prism(true);
  tiles.name = "delay of a hexagonal prism, tiles";
  tiles.scene.trace.method = clray::Method::tiles;
  scenes.push_back(std::move(tiles));
  return scenes;
}

namespace {

std::vector<Coverage> cover_seeds(const CoverageScene& scene, int first, int last) {
  std::vector<Coverage> found(scene.claims.size());
  Scene seeded = scene.scene;
  for (int seed = first; seed <= last; ++seed) {
    const Result result = run(rays(seeded, 12, static_cast<std::uint64_t>(seed)));
    for (std::size_t k = 0; k < found.size(); ++k) found[k].add(scene.claims[k].find(result), scene.claims[k].exact);
  }
  return found;
}

}  // namespace

std::vector<Coverage> cover(const CoverageScene& scene) {
  std::vector<Coverage> found = cover_seeds(scene, 1, 400);
  const bool fair = std::all_of(found.begin(), found.end(), [](const Coverage& c) { return c.fair(); });
  return fair ? found : cover_seeds(scene, 401, 1600);
}

const std::array<const char*, 4> kHitsGroups = {"10 to 29 hits", "30 to 99 hits", "100 to 999 hits",
                                                "1000 hits and more"};

ByHits cover_bins(bool sobol, int seeds) {
  ByHits groups;
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  scene.trace.sampler = sampler_of(sobol);
  window(scene, -2.0 / kLightSpeed, 0.0, kBins);
  for (int log2_rays : {10, 12, 14, 16})
    for (int seed = 1; seed <= seeds; ++seed) {
      const clray::DelayResult d = run(rays(scene, log2_rays, static_cast<std::uint64_t>(seed))).delay.at(0);
      for (int b = 0; b < kBins; ++b) {
        const auto i = static_cast<std::size_t>(b);
        if (d.resolved[i]) add_bin(d.bin_m2_per_sr[i], d.bin_standard_error[i], d.hits[i], exact_bin(b), &groups);
      }
    }
  return groups;
}

ByHits cover_tiles_bins(int seeds) {
  ByHits groups;
  const MeshPtr mesh = sphere_mesh(24, 12, 1.0);
  const clray::Vec3 s = toward(0.7, 0.4);
  const Pulse pulse = convex_lambert(*mesh, 0.5, s, s);
  const double first = -2.0 / kLightSpeed, width = 2.0 / kLightSpeed / kBins;
  Scene scene = scene_of(mesh, lambert(0.5));
  window(monostatic(scene, s), first, 0.0, kBins);
  scene.trace.method = clray::Method::tiles;
  for (int log2_rays : {10, 12, 14, 16})
    for (int seed = 1; seed <= seeds; ++seed) {
      const clray::DelayResult d = run(rays(scene, log2_rays, static_cast<std::uint64_t>(seed))).delay.at(0);
      for (int b = 0; b < kBins; ++b) {
        const auto i = static_cast<std::size_t>(b);
        const double from = first + b * width;
        const double exact = pulse.total_m2_per_sr * (pulse.share(from + width) - pulse.share(from));
        if (d.resolved[i]) add_bin(d.bin_m2_per_sr[i], d.bin_standard_error[i], d.hits[i], exact, &groups);
      }
    }
  return groups;
}

ByHits simulate_bins(int seeds) {
  constexpr int kReplicates = 16;
  ByHits groups;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int log2_rays : {10, 12, 14, 16})
    for (int seed = 1; seed <= seeds; ++seed) {
      std::array<std::array<double, kReplicates>, kBins> sums{}, hits{};
      const int points = (1 << log2_rays) / kReplicates;
      for (std::size_t r = 0; r < kReplicates; ++r)
        for (int i = 0; i < points; ++i) {
          const double x = uniform(random), y = uniform(random), square = 1.0 - x * x - y * y;
          if (square <= 0.0) continue;
          const double mu = std::sqrt(square);
          const auto b = static_cast<std::size_t>(std::min(kBins - 1.0, std::floor((1.0 - mu) * kBins)));
          sums[b][r] += 0.5 / kPi * mu * 4.0 / points;
          hits[b][r] += 1.0;
        }
      for (int b = 0; b < kBins; ++b) {
        const auto i = static_cast<std::size_t>(b);
        double mean = 0.0, square = 0.0, all = 0.0;
        int hit = 0;
        for (std::size_t r = 0; r < kReplicates; ++r) {
          mean += sums[i][r] / kReplicates;
          all += hits[i][r];
          hit += hits[i][r] > 0.0;
        }
        for (double s : sums[i]) square += (s - mean) * (s - mean);
        if (all < 10.0 || 2 * hit < kReplicates) continue;
        const double error = std::sqrt(square / (kReplicates * (kReplicates - 1.0)));
        add_bin(mean, error, static_cast<std::uint64_t>(all), exact_bin(b), &groups);
      }
    }
  return groups;
}

PixelShares cover_pixels(bool sobol) {
  constexpr int kSide = 128;
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  scene.trace.sampler = sampler_of(sobol);
  detect(scene, "rgb", {{"width", 1.0 * kSide}, {"height", 1.0 * kSide}, {"samples", 128.0}});
  const clray::ImageResult image = run(scene).image.at(0);
  // Gauss's three points: relative error h⁶ of a smooth function, 10⁻¹⁰ away from the rim.
  const double node[3] = {-0.5 * std::sqrt(0.6), 0.0, 0.5 * std::sqrt(0.6)}, weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  PixelShares shares;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const double x = (column + 0.5 - 0.5 * kSide) * image.pixel_m, y = (row + 0.5 - 0.5 * kSide) * image.pixel_m;
      if (std::hypot(x, y) > 0.95) continue;
      double exact = 0.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const double u = x + node[i] * image.pixel_m, v = y + node[j] * image.pixel_m;
          exact += weight[i] * weight[j] * 0.5 / kPi * std::sqrt(1.0 - u * u - v * v);
        }
      const auto at = static_cast<std::size_t>(row * kSide + column);
      const double off = std::fabs(image.radiance_per_sr[at] - exact), error = image.standard_error_per_sr[at];
      ++shares.pixels;
      shares.no_error += error == 0.0;
      shares.within_one += off <= error;
      shares.within_95 += off <= 12.706204736174698 * error;
    }
  return shares;
}

}  // namespace clray_test
