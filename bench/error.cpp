// SPDX-License-Identifier: Apache-2.0
// clray-bench error: error against run time. For every case, sampler and ray count: the true error (against the
// closed form) and the claimed one over many seeds, and the wall time split. Writes error.csv (every run), error.png
// and error.md (medians, 90 % of runs, fitted slopes, time to 1, 0.1 and 0.01 %; error per bin; cost of a claim).
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "bench.hpp"
#include "error_cases.hpp"

namespace clray_bench {

using clray_test::rays;
using clray_test::run;

namespace {

struct Point {
  std::uint64_t rays = 0;
  std::vector<double> truth, claim, trace_s, bin_truth, bin_claim;
  double load_s = 0.0, bvh_s = 0.0, compile_s = 0.0;
  double rms() const {
    double sum = 0.0;
    for (double e : truth) sum += e * e;
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
};

struct Curve {
  const ErrorCase* which;
  bool sobol;
  std::vector<Point> points;
};

/// Root mean square relative error of the bins with 10 hits or more, true and claimed.
void compare_bins(const clray::DelayResult& d, const ErrorCase& c, Point* point) {
  double truth = 0.0, claim = 0.0;
  int used = 0;
  for (std::size_t i = 0; i < d.bin_m2_per_sr.size(); ++i) {
    const double t = d.first_bin_start_s + static_cast<double>(i) * d.bin_width_s;
    const double exact = c.exact * (c.share(t + d.bin_width_s) - c.share(t));
    if (d.hits[i] < 10 || !(exact > 0.0)) continue;
    truth += std::pow(d.bin_m2_per_sr[i] / exact - 1.0, 2);
    claim += std::pow(d.bin_standard_error[i] / exact, 2);
    ++used;
  }
  if (used == 0) return;
  point->bin_truth.push_back(std::sqrt(truth / used));
  point->bin_claim.push_back(std::sqrt(claim / used));
}

Point measure(const ErrorCase& c, bool sobol, int log2_rays, int seeds, std::string* csv) {
  Point point;
  for (int seed = 1; seed <= seeds; ++seed) {
    clray::Scene scene = c.scene;
    scene.trace.sobol = sobol;
    rays(scene, log2_rays, static_cast<std::uint64_t>(seed));
    const clray::Result r = run(scene);
    const Found f = c.found(r);
    point.rays = r.rays;
    point.truth.push_back(std::fabs(f.value / c.exact - 1.0));
    point.claim.push_back(f.standard_error / c.exact);
    point.trace_s.push_back(r.seconds.trace);
    point.load_s += r.seconds.load / seeds;
    point.bvh_s += r.seconds.bvh / seeds;
    point.compile_s += r.seconds.compile / seeds;
    if (c.share) compare_bins(r.delay.at(0), c, &point);
    *csv += fmt::format("{},{},{},{},{:.6e},{:.6e},{:.6f},{:.6f},{:.6f},{:.6f}\n", c.name, sobol ? "sobol" : "random",
                        r.rays, seed, point.truth.back(), point.claim.back(), r.seconds.load, r.seconds.bvh,
                        r.seconds.compile, r.seconds.trace);
  }
  return point;
}

/// Least-squares slope of log(rms true error) against log(rays), without points at the case's own model error.
double slope_of(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Point& p : curve.points) {
    const double e = p.rms();
    if (!(e > 3.0 * std::max(curve.which->model_error, 1e-10))) continue;
    const double x = std::log2(static_cast<double>(p.rays)), y = std::log2(e);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n >= 3 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : std::nan("");
}

/// Trace time until 90 % of runs are within `target`; beyond the last point by the fitted slope, marked "~".
std::string time_to(const Curve& curve, double target) {
  for (const Point& p : curve.points)
    if (quantile(p.truth, 0.9) <= target) return fmt::format("{:.3g} s", median(p.trace_s));
  const double slope = slope_of(curve);
  const Point& last = curve.points.back();
  if (target <= curve.which->model_error || !(slope < -0.1)) return "–";
  const double more = std::pow(target / quantile(last.truth, 0.9), 1.0 / slope);
  return fmt::format("~{:.3g} s", median(last.trace_s) * more);
}

std::string percent(double x) {
  return fmt::format("{:.2g} %", 100.0 * x);
}

void plot(const Options& options, const std::vector<Curve>& curves) {
  std::vector<const ErrorCase*> cases;
  for (const Curve& c : curves)
    if (cases.empty() || cases.back() != c.which) cases.push_back(c.which);
  const int columns = 3, rows = (static_cast<int>(cases.size()) + columns - 1) / columns;
  std::string script = fmt::format(
      "set terminal pngcairo size 1500,{} font 'sans,10'\nset output '{}/error.png'\nset multiplot layout {},{} title "
      "'Relative error against tracing time: 90 % of seeds (lines: true, dots: 1.64 × claimed standard error)'\nset "
      "logscale xy\nset format y '10^{{%L}}'\nset format x '10^{{%L}}'\nset grid\nset key bottom left\nset xlabel "
      "'tracing, s'\nset ylabel 'relative error'\n",
      340 * rows + 60, options.out, rows, columns);
  for (const ErrorCase* which : cases) {
    std::string data, lines;
    for (const Curve& c : curves) {
      if (c.which != which) continue;
      const std::string name = c.sobol ? "sobol" : "random", colour = c.sobol ? "#0060ad" : "#dd181f";
      data += fmt::format("${} << EOD\n", name);
      // The interval that a fair claim of a normal error fills 90 % of: 1.645 standard errors.
      for (const Point& p : c.points)
        data += fmt::format("{} {} {}\n", median(p.trace_s), std::max(quantile(p.truth, 0.9), 1e-16),
                            std::max(1.645 * median(p.claim), 1e-16));
      data += "EOD\n";
      lines += fmt::format(
          "{}${} using 1:2 with linespoints pt 7 lc rgb '{}' title '{}', ${} using 1:3 with lines dt 3 lw 2 lc rgb "
          "'{}' "
          "notitle",
          lines.empty() ? "plot " : ", ", name, colour, name, name, colour);
    }
    script += data + fmt::format("set title '{}'\n", which->name) + lines + "\n";
  }
  gnuplot(script + "unset multiplot\n");
}

std::string totals_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {{"case", "sampler", "rays", "true error, median", "90 %",
                                                 "claimed, median", "90 %", "slope", "to 1 %", "to 0.1 %", "to 0.01 %",
                                                 "BVH / compile / trace, s"}};
  for (const Curve& c : curves) {
    const Point& p = c.points.back();
    rows.push_back({c.which->name, c.sobol ? "sobol" : "random", fmt::format("2^{:.0f}", std::log2(1.0 * p.rays)),
                    percent(median(p.truth)), percent(quantile(p.truth, 0.9)), percent(median(p.claim)),
                    percent(quantile(p.claim, 0.9)), fmt::format("{:.2f}", slope_of(c)), time_to(c, 1e-2),
                    time_to(c, 1e-3), time_to(c, 1e-4),
                    fmt::format("{:.2g} / {:.2g} / {:.2g}", p.bvh_s, p.compile_s, median(p.trace_s))});
  }
  return markdown(rows);
}

std::string bins_table(const std::vector<Curve>& curves) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "rays", "sobol: true", "claimed", "random: true", "claimed", "rays that random needs for the same"}};
  for (std::size_t i = 0; i + 1 < curves.size(); ++i) {
    const Curve &a = curves[i], &b = curves[i + 1];
    if (!a.which->share || a.which != b.which || !a.sobol || b.sobol) continue;
    for (std::size_t k = 0; k < a.points.size(); k += 4) {
      const Point &p = a.points[a.points.size() - 1 - k], &q = b.points[b.points.size() - 1 - k];
      if (p.bin_truth.empty() || q.bin_truth.empty()) continue;
      const double gain = std::pow(median(q.bin_truth) / median(p.bin_truth), 2);
      rows.push_back({a.which->name, fmt::format("2^{:.0f}", std::log2(1.0 * p.rays)), percent(median(p.bin_truth)),
                      percent(median(p.bin_claim)), percent(median(q.bin_truth)), percent(median(q.bin_claim)),
                      fmt::format("× {:.2g}", gain)});
    }
  }
  return markdown(rows);
}

/// What splitting the same rays into more replicates costs in true error, and what it buys in the claim's steadiness.
std::string replicates_table(const Options& options) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "replicates", "true error, rms", "claimed, median", "spread of the claim", "trace, s"}};
  const std::vector<ErrorCase> cases = error_cases();
  for (const ErrorCase& c : cases) {
    if ((c.name != "sphere" && c.name != "box") || !wanted(options, c.name)) continue;
    for (int replicates : {4, 16, 32}) {
      ErrorCase variant = c;
      variant.scene.trace.replicates = replicates;
      std::string unused;
      const Point p = measure(variant, true, options.quick ? 12 : 16, options.seeds, &unused);
      double mean = 0.0, square = 0.0;
      for (double e : p.claim) mean += e / options.seeds;
      for (double e : p.claim) square += (e - mean) * (e - mean) / (options.seeds - 1);
      rows.push_back({c.name, std::to_string(replicates), percent(p.rms()), percent(median(p.claim)),
                      percent(std::sqrt(square) / mean), fmt::format("{:.2g}", median(p.trace_s))});
    }
  }
  return markdown(rows);
}

}  // namespace

int error(const Options& asked) {
  Options options = asked;
  if (options.quick) options.max_log2_rays = std::min(options.max_log2_rays, 14);
  const std::vector<ErrorCase> cases = error_cases();
  std::string csv = "# relative error of the total against its closed form, and what it cost; " + device_line() +
                    "\ncase,sampler,rays,seed,true_error,claimed_standard_error,load_s,bvh_s,compile_s,trace_s\n";
  std::vector<Curve> curves;
  for (const ErrorCase& c : cases) {
    if (!wanted(options, c.name)) continue;
    for (const bool sobol : {true, false}) {
      Curve curve{&c, sobol, {}};
      for (int k = options.min_log2_rays; k <= options.max_log2_rays; ++k) {
        curve.points.push_back(measure(c, sobol, k, options.seeds, &csv));
        const Point& p = curve.points.back();
        fmt::print("{:22} {:6} 2^{:<2} true {:9.2e}  claimed {:9.2e}  {:.3f} s\n", c.name, sobol ? "sobol" : "random",
                   k, median(p.truth), median(p.claim), median(p.trace_s));
        std::fflush(stdout);
      }
      curves.push_back(curve);
    }
  }
  if (curves.empty()) return 2;
  write_text(options.out, "error.csv", csv);
  plot(options, curves);
  const std::string text = fmt::format(
      "# Error against run time\n\nWritten by `clray-bench error{}` on {}: {} seeds a point, 2^{} to 2^{} rays.\n"
      "True error: against the closed form. Claimed: standard error over the value; a fair claim has a median true\n"
      "error of 0.67 of it. Slope: of the root mean square true error against rays. Time to p %: tracing until 90 % "
      "of\n"
      "runs are that near (~: by the slope). The last ray count is shown; every run is in error.csv. The bowl is a "
      "mesh\n"
      "whose facets differ from the closed form by up to 0.02 %.\n\n![error against time](error.png)\n\n{}\n"
      "## Error per bin (512 bins)\n\nRoot mean square over bins of 10 hits or more.\n\n{}\n"
      "## The cost of a claim\n\nThe same rays as 4, 16 and 32 replicates.\n\n{}",
      options.quick ? " --short" : "", device_line(), options.seeds, options.min_log2_rays, options.max_log2_rays,
      totals_table(curves), bins_table(curves), replicates_table(options));
  write_text(options.out, "error.md", text);
  return 0;
}

}  // namespace clray_bench
