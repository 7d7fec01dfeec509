// SPDX-License-Identifier: Apache-2.0
// See error_measure.hpp.
#include "error_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "clray/error.hpp"

namespace clray_bench {

namespace {

constexpr int kFirstDoubling = 14;   ///< of a run's own record: 2^10 points in each of 16 replicates
constexpr double kStillBlind = 0.3;  ///< rms error of rays that have not yet met what matters: no slope there
constexpr int kBinRays[] = {14, 18, 22};

clray::Result run(const ErrorCase& which, const Sampler& sampler, int log2_rays, int seed, clray::Device& device) {
  clray::Scene scene = which.scene;
  scene.trace.sampler = sampler.kind;
  scene.trace.method = sampler.method;
  clray_test::rays(scene, log2_rays, static_cast<std::uint64_t>(seed));
  return clray::trace(scene, device);
}

void add_bins(const clray::DelayResult& d, const ErrorCase& c, Bins* bins) {
  const std::size_t count = d.bin_m2_per_sr.size();
  for (auto* list : {&bins->exact, &bins->expected, &bins->truth2, &bins->claim2}) list->resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = d.first_bin_start_s + static_cast<double>(i) * d.bin_width_s;
    bins->exact[i] = c.exact * (c.share(t + d.bin_width_s) - c.share(t));
    bins->expected[i] = c.hits(t + d.bin_width_s) - c.hits(t);
    bins->hits += static_cast<double>(d.hits[i]);
    if (!(bins->exact[i] > 0.0)) continue;
    bins->truth2[i] += std::pow(d.bin_m2_per_sr[i] / bins->exact[i] - 1.0, 2);
    bins->claim2[i] += std::pow(d.bin_standard_error[i] / bins->exact[i], 2);
  }
  ++bins->runs;
}

/// All ray counts of one seed.
class Seed {
 public:
  Seed(Curve* curve, int seed, clray::Device& device, std::string* runs)
      : curve_(*curve), seed_(seed), device_(device), runs_(runs) {}

  void small(std::size_t point) {
    record(point, run(*curve_.which, curve_.sampler, curve_.points[point].log2_rays, seed_, device_).errors.back());
  }

  /// One run for all points from `first` on.
  clray::Result large(std::size_t first) {
    const clray::Result r = run(*curve_.which, curve_.sampler, curve_.points.back().log2_rays, seed_, device_);
    for (std::size_t i = first; i < curve_.points.size(); ++i) {
      const std::uint64_t rays = 1ull << curve_.points[i].log2_rays;
      const auto at = std::find_if(r.errors.begin(), r.errors.end(), [&](const auto& e) { return e.rays == rays; });
      if (at == r.errors.end()) throw std::runtime_error("a run without its doubling of " + std::to_string(rays));
      record(i, *at);
      if (curve_.which->share) bins_at(i, *at, r);
    }
    return r;
  }

 private:
  void record(std::size_t i, const clray::ErrorPoint& e) {
    const double exact = curve_.which->exact;
    Point& point = curve_.points[i];
    point.truth.push_back(std::fabs(e.first_total / exact - 1.0));
    point.claim.push_back(e.first_standard_error / exact);
    point.seconds.push_back(e.seconds);
    *runs_ += fmt::format("{},{},{},{},{:.6e},{:.6e},{:.6f}\n", curve_.which->name, curve_.sampler.name, e.rays, seed_,
                          point.truth.back(), point.claim.back(), e.seconds);
  }

  void bins_at(std::size_t i, const clray::ErrorPoint& row, const clray::Result& largest) {
    const int log2_rays = curve_.points[i].log2_rays;
    if (std::find(std::begin(kBinRays), std::end(kBinRays), log2_rays) == std::end(kBinRays)) return;
    if (curve_.sampler.kind == clray::SamplerKind::sobol) return;  // bins are compared of the other two
    Bins* bins = &curve_.bins[log2_rays];
    if (largest.rays == row.rays) return add_bins(largest.delay.at(0), *curve_.which, bins);
    const clray::Result r = run(*curve_.which, curve_.sampler, log2_rays, seed_, device_);
    if (r.errors.back().first_total != row.first_total ||
        r.errors.back().first_standard_error != row.first_standard_error)
      throw std::runtime_error(fmt::format("{}, {}: 2^{} rays alone give another total than in a longer run",
                                           curve_.which->name, curve_.sampler.name, log2_rays));
    add_bins(r.delay.at(0), *curve_.which, bins);
  }

  Curve& curve_;
  int seed_;
  clray::Device& device_;
  std::string* runs_;
};

}  // namespace

std::optional<Solved> solve(const ErrorCase& which, clray::Device& device) {
  clray::Scene scene = which.scene;
  if (scene.detectors.at(0).kind != "delay" || scene.trace.max_bounces > 1) return {};
  scene.trace.rays = 0;
  scene.trace.method = clray::Method::exact;
  Solved solved;
  solved.which = &which;
  std::vector<double> seconds;
  for (int k = 0; k < 5; ++k) {
    clray::Result r;
    try {
      r = clray::trace(scene, device);
    } catch (const clray::Error& e) {
      if (e.code() == clray::ErrorCode::input) return {};
      throw;
    }
    const clray::Estimate& found = r.delay.at(0).intensity_m2_per_sr;
    solved.truth = std::fabs(found.value / which.exact - 1.0);
    solved.bound = found.rounding_bound / which.exact;
    seconds.push_back(r.seconds.trace);
  }
  solved.seconds = median(seconds);
  return solved;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

Curve measure(const ErrorCase& which, const Sampler& sampler, int most, const Options& options, clray::Device& device,
              std::string* runs) {
  Curve curve;
  curve.which = &which;
  curve.sampler = sampler;
  for (int k = std::min(options.min_log2_rays, most); k <= most; ++k) curve.points.push_back({k, {}, {}, {}});
  std::vector<double> bvh, compile, trace;
  for (int seed = 1; seed <= options.seeds; ++seed) {
    Seed one(&curve, seed, device, runs);
    std::size_t i = 0;
    while (i + 1 < curve.points.size() && curve.points[i].log2_rays < kFirstDoubling) one.small(i++);
    const clray::Result r = one.large(i);
    bvh.push_back(r.seconds.bvh);
    compile.push_back(r.seconds.compile);
    trace.push_back(r.seconds.trace);
  }
  curve.split = {which.load_s, median(bvh), median(compile), median(trace)};
  return curve;
}

int affordable(const ErrorCase& which, const Options& options, clray::Device& device) {
  int most = options.max_log2_rays;
  if (options.max_seconds_per_case <= 0.0) return most;
  const int pilot = std::min(most, 16);
  double seconds = 0.0;
  for (const Sampler& sampler : kSamplers) {
    run(which, sampler, pilot, 1, device);  // the first launch of a program finishes its compilation
    seconds += run(which, sampler, pilot, 2, device).seconds.trace;
  }
  seconds *= options.seeds * std::pow(2.0, most - pilot);
  for (; most > pilot && seconds > options.max_seconds_per_case; --most) seconds /= 2.0;
  return most;
}

double slope_of(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Point& p : curve.points) {
    const double e = rms(p.truth);
    if (!(e > 3.0 * std::max(curve.which->model_error, 1e-10)) || e > kStillBlind) continue;
    const double x = p.log2_rays, y = std::log2(e);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n >= 3 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : std::nan("");
}

}  // namespace clray_bench
