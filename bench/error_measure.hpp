// SPDX-License-Identifier: Apache-2.0
// What clray-bench error measures: for a case and a sampler, the true and the claimed error and the tracing time at
// every doubling, over many seeds. Errors are relative to the closed form.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench.hpp"
#include "clray/device.hpp"
#include "clray/trace.hpp"
#include "error_cases.hpp"

namespace clray_bench {

struct Sampler {
  const char* name;
  clray::SamplerKind kind;
  clray::Method method = clray::Method::points;
};
constexpr Sampler kSamplers[] = {{"random", clray::SamplerKind::random},
                                 {"sobol", clray::SamplerKind::sobol},
                                 {"stratified", clray::SamplerKind::strata}};
constexpr int kSamplerCount = 3;
/// Points in tiles (docs/exact.md), of cases with a pulse that tiles can find. More are dearer than to solve them.
constexpr Sampler kTiles = {"tiles", clray::SamplerKind::sobol, clray::Method::tiles};
constexpr int kMostTiles = 20;  ///< log2 of their points

/// One ray count: a value per seed.
struct Point {
  int log2_rays = 0;
  std::vector<double> truth, claim;  ///< relative true error, relative standard error
  std::vector<double> seconds;       ///< of tracing
};

/// The bins of a delay camera at one ray count, summed over seeds; [bin].
struct Bins {
  std::vector<double> exact;           ///< m²/sr
  std::vector<double> expected;        ///< share of the hits, by the closed form
  std::vector<double> truth2, claim2;  ///< squares of relative true and claimed errors
  double hits = 0.0;                   ///< of all bins
  int runs = 0;
};

/// Medians over the runs at the largest ray count, s.
struct Split {
  double load = 0.0, bvh = 0.0, compile = 0.0, trace = 0.0;
};

struct Curve {
  const ErrorCase* which = nullptr;
  Sampler sampler{};
  std::vector<Point> points;
  std::map<int, Bins> bins;  ///< by log2 of rays
  Split split;
};

/// What the exact method finds of a case: relative to the closed form, and the median of its tracing times.
struct Solved {
  const ErrorCase* which = nullptr;
  double truth = 0.0, bound = 0.0;
  double seconds = 0.0;
};
/// Nothing where the case has no pulse, or one that is not solved to its end.
std::optional<Solved> solve(const ErrorCase& which, clray::Device& device);

double rms(const std::vector<double>& values);

/// Measures ray counts from 2^options.min_log2_rays to 2^`most` with seeds 1 … options.seeds. A run records its total
/// at each doubling from 2^14, which is to the bit what a run of so many rays finds: checked at the counts of `bins`,
/// throws std::runtime_error where it is not. `runs` receives a CSV row per seed and ray count.
Curve measure(const ErrorCase& which, const Sampler& sampler, int most, const Options& options, clray::Device& device,
              std::string* runs);

/// The largest log2 of rays at which all samplers and seeds of a case trace for at most `seconds` (0: no limit).
int affordable(const ErrorCase& which, const Options& options, clray::Device& device);

/// Slope of log(rms true error) against log(rays), by least squares over points below 30 % and above the case's own
/// model error.
double slope_of(const Curve& curve);

}  // namespace clray_bench
