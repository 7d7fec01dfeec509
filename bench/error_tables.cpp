// SPDX-License-Identifier: Apache-2.0
// See error_report.hpp: the tables and the CSV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error_report.hpp"

namespace clray_bench {

namespace {

constexpr double kLeastHits = 10.0;  ///< expected of plain random rays, of a bin that is compared
constexpr double kRaysBar = 10.0, kBinBar = 2.0;

std::string percent(double x) {
  return fmt::format("{:.2g} %", 100.0 * x);
}

std::string power(int log2_rays) {
  return fmt::format("2^{}", log2_rays);
}

/// Trace time until 90 % of runs are within `target`; beyond the last point by the fitted slope, marked "~".
std::string time_to(const Curve& curve, double target) {
  for (const Point& p : curve.points)
    if (quantile(p.truth, 0.9) <= target) return fmt::format("{:.3g} s", median(p.seconds));
  const double slope = slope_of(curve);
  const Point& last = curve.points.back();
  if (target <= curve.which->model_error || !(slope < -0.25)) return "–";
  return fmt::format("~{:.3g} s", median(last.seconds) * std::pow(target / quantile(last.truth, 0.9), 1.0 / slope));
}

/// log2 of the rays from which on the rms true error stays within a target.
struct Crossing {
  double log2_rays = std::nan("");
  enum { measured, extrapolated, before_first } how = measured;
  std::string text() const {
    if (std::isnan(log2_rays)) return "–";
    return fmt::format("{}2^{:.1f}", how == extrapolated ? "~" : how == before_first ? "< " : "", log2_rays);
  }
};

Crossing rays_to(const Curve& curve, double target) {
  const std::vector<Point>& p = curve.points;
  std::size_t i = p.size();
  while (i > 0 && rms(p[i - 1].truth) <= target) --i;
  if (i == 0) return {1.0 * p.front().log2_rays, Crossing::before_first};
  const double above = std::log2(rms(p[i - 1].truth) / target);
  if (i < p.size()) {
    const double below = std::log2(target / std::max(rms(p[i].truth), 1e-16));
    return {p[i - 1].log2_rays + above / (above + below), Crossing::measured};
  }
  const double slope = slope_of(curve);
  if (target <= 3.0 * curve.which->model_error || !(slope < -0.25)) return {};
  return {p.back().log2_rays - above / slope, Crossing::extrapolated};
}

}  // namespace

std::string error_csv(const std::vector<DeviceCurves>& all) {
  std::string csv =
      "# relative error of the total against its closed form, over seeds: true, and claimed standard error (exact: "
      "rounding bound, rays 0)\n"
      "device,case,sampler,rays,seeds,true_median,true_90,true_rms,claimed_median,claimed_90,claimed_rms,trace_s\n";
  for (const DeviceCurves& d : all) {
    std::vector<Curve> curves = d.curves;
    curves.insert(curves.end(), d.tiles.begin(), d.tiles.end());
    for (const Curve& c : curves) {
      for (const Point& p : c.points)
        csv += fmt::format("\"{}\",{},{},{},{},{:.4e},{:.4e},{:.4e},{:.4e},{:.4e},{:.4e},{:.6f}\n", d.device,
                           c.which->name, c.sampler.name, 1ull << p.log2_rays, p.truth.size(), median(p.truth),
                           quantile(p.truth, 0.9), rms(p.truth), median(p.claim), quantile(p.claim, 0.9), rms(p.claim),
                           median(p.seconds));
    }
    for (const Solved& s : d.solved)
      csv += fmt::format("\"{}\",{},exact,0,1,{:.4e},{:.4e},{:.4e},{:.4e},{:.4e},{:.4e},{:.6f}\n", d.device,
                         s.which->name, s.truth, s.truth, s.truth, s.bound, s.bound, s.bound, s.seconds);
  }
  return csv;
}

std::string totals_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {{"case", "sampler", "rays", "true error, median", "90 %",
                                                 "claimed, median", "90 %", "slope", "to 1 %", "to 0.1 %",
                                                 "to 0.01 %"}};
  for (const Curve& c : curves) {
    const Point& p = c.points.back();
    rows.push_back({c.which->name, c.sampler.name, power(p.log2_rays), percent(median(p.truth)),
                    percent(quantile(p.truth, 0.9)), percent(median(p.claim)), percent(quantile(p.claim, 0.9)),
                    fmt::format("{:.2f}", slope_of(c)), time_to(c, 1e-2), time_to(c, 1e-3), time_to(c, 1e-4)});
  }
  return markdown(rows);
}

std::string solved_table(const std::vector<Solved>& solved) {
  std::vector<std::vector<std::string>> rows = {{"case", "true error", "rounding bound", "trace, s"}};
  for (const Solved& s : solved)
    rows.push_back({s.which->name, fmt::format("{:.1e}", s.truth), fmt::format("{:.1e}", s.bound),
                    fmt::format("{:.2g}", s.seconds)});
  return markdown(rows);
}

std::string rays_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "random", "sobol", "stratified", "random / stratified", fmt::format("bar: {:g}", kRaysBar)}};
  for (std::size_t i = 0; i + kSamplerCount <= curves.size(); i += kSamplerCount) {
    const Crossing random = rays_to(curves[i], 1e-3), sobol = rays_to(curves[i + 1], 1e-3),
                   best = rays_to(curves[i + 2], 1e-3);
    const double ratio = std::exp2(random.log2_rays - best.log2_rays);
    // A ratio from a bound or a fit is one, too.
    const bool known = !std::isnan(ratio) && random.how != Crossing::before_first;
    const char* mark = best.how == Crossing::before_first                                           ? "> "
                       : random.how == Crossing::extrapolated || best.how == Crossing::extrapolated ? "~ "
                                                                                                    : "";
    rows.push_back({curves[i].which->name, random.text(), sobol.text(), best.text(),
                    known ? fmt::format("{}{:.3g}", mark, ratio) : "–",
                    !known              ? "–"
                    : ratio >= kRaysBar ? "met"
                                        : "**not met**"});
  }
  return markdown(rows);
}

std::string fairness_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {{"case", "sampler"}};
  int low = 64, high = 0;
  for (const Curve& c : curves) low = std::min(low, c.points.front().log2_rays);
  for (const Curve& c : curves) high = std::max(high, c.points.back().log2_rays);
  for (int k = low; k <= high; k += 2) rows[0].push_back(power(k));
  for (const Curve& c : curves) {
    rows.push_back({c.which->name, c.sampler.name});
    for (int k = low; k <= high; k += 2) {
      const auto at = std::find_if(c.points.begin(), c.points.end(), [&](const Point& p) { return p.log2_rays == k; });
      rows.back().push_back(at == c.points.end() ? "" : fmt::format("{:.2f}", rms(at->truth) / rms(at->claim)));
    }
  }
  return markdown(rows);
}

std::string bins_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {{"case", "rays", "bins", "random: true", "claimed", "stratified: true",
                                                 "claimed", "rays that random needs for the same",
                                                 fmt::format("bar: {:g}", kBinBar)}};
  for (std::size_t i = 0; i + kSamplerCount <= curves.size(); i += kSamplerCount) {
    for (const auto& [log2_rays, random] : curves[i].bins) {
      const auto found = curves[i + 2].bins.find(log2_rays);
      if (found == curves[i + 2].bins.end()) continue;
      const Bins* both[] = {&random, &found->second};
      double truth[2] = {}, claim[2] = {};
      int used = 0;
      for (std::size_t b = 0; b < random.exact.size(); ++b) {
        if (!(random.exact[b] > 0.0) || random.hits / random.runs * random.expected[b] < kLeastHits) continue;
        ++used;
        for (int k = 0; k < 2; ++k) truth[k] += both[k]->truth2[b] / both[k]->runs;
        for (int k = 0; k < 2; ++k) claim[k] += both[k]->claim2[b] / both[k]->runs;
      }
      if (used == 0) continue;
      const double gain = truth[0] / truth[1];
      const auto part = [&](double sum) { return percent(std::sqrt(sum / used)); };
      rows.push_back({curves[i].which->name, power(log2_rays), std::to_string(used), part(truth[0]), part(claim[0]),
                      part(truth[1]), part(claim[1]), fmt::format("× {:.2g}", gain),
                      gain >= kBinBar ? "met" : "**not met**"});
    }
  }
  return markdown(rows);
}

std::string split_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {{"case", "sampler", "rays", "load", "BVH", "compile", "trace"}};
  for (const Curve& c : curves)
    rows.push_back({c.which->name, c.sampler.name, power(c.points.back().log2_rays),
                    c.split.load > 0.0 ? fmt::format("{:.2g}", c.split.load) : "–", fmt::format("{:.2g}", c.split.bvh),
                    fmt::format("{:.2g}", c.split.compile), fmt::format("{:.2g}", c.split.trace)});
  return markdown(rows);
}

std::string replicates_table(const Options& options, clray::Device& device) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "replicates", "true error, rms", "claimed, median", "spread of the claim", "trace, s"}};
  Options few = options;
  few.min_log2_rays = few.max_log2_rays = 16;
  for (ErrorCase c : error_cases()) {
    if ((c.name != "sphere" && c.name != "box" && c.name != "box-wing") || !wanted(options, c.name)) continue;
    for (int replicates : {4, 16, 32}) {
      c.scene.trace.replicates = replicates;
      std::string unused;
      const Point p = measure(c, kSamplers[2], 16, few, device, &unused).points.back();
      double mean = 0.0, square = 0.0;
      for (double e : p.claim) mean += e / options.seeds;
      for (double e : p.claim) square += (e - mean) * (e - mean) / (options.seeds - 1);
      rows.push_back({c.name, std::to_string(replicates), percent(rms(p.truth)), percent(median(p.claim)),
                      percent(std::sqrt(square) / mean), fmt::format("{:.2g}", median(p.seconds))});
    }
  }
  return rows.size() > 1 ? markdown(rows) : "";
}

}  // namespace clray_bench
