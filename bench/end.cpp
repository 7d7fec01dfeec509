// SPDX-License-Identifier: Apache-2.0
// clray-bench end: how long each method takes to 0.1, 0.01 and 0.001 % of a body's total and to 5 and 1 % mean error
// per bin. True errors are taken from the exact pulse. Methods take turns at every effort and seed, so that what slows
// the machine slows all of them. Writes end.csv and end.md. Exit 1 if a method goes elsewhere than the exact pulse.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "end_bodies.hpp"
#include "end_methods.hpp"

namespace clray_bench {

namespace {

constexpr double kTotals[] = {1e-3, 1e-4, 1e-5}, kBins[] = {0.05, 0.01};
constexpr double kLeastShare = 0.01;  // of an even share of the total: bins with less are not compared
constexpr int kRunsThatEnd = 5;       // at least, of a method whose answer is always the same
constexpr double kStrayed = 0.02;     // relative error at the greatest effort that no honest method has
constexpr double kBlind = 0.3;        // errors above it say nothing of how they fall

/// What a method does at one effort: medians and errors over seeds.
struct Measured {
  int effort = 0;
  std::vector<double> seconds, total, bins;  // relative errors of each seed
};

struct Curve {
  std::string method;
  bool ends = false;
  std::vector<double> prepared_s;
  std::vector<Measured> at;
};

struct BodyCurves {
  std::string name;
  std::size_t triangles = 0;
  std::vector<Curve> curves;
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}
double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// Mean relative error of the bins that hold light.
double bin_error(const Answer& found, const Answer& exact) {
  const double least = kLeastShare * exact.total / static_cast<double>(exact.bins.size());
  std::vector<double> errors;
  for (std::size_t b = 0; b < exact.bins.size(); ++b) {
    if (exact.bins[b] > least) errors.push_back(std::fabs(found.bins[b] / exact.bins[b] - 1.0));
  }
  return mean(errors);
}

void take(const EndMethod& method, const Answer& exact, int effort, std::uint64_t seed, Curve* curve) {
  if (curve->at.empty() || curve->at.back().effort != effort) curve->at.push_back({effort, {}, {}, {}});
  const Answer found = method.run(effort, seed);
  Measured& m = curve->at.back();
  m.seconds.push_back(found.seconds);
  m.total.push_back(std::fabs(found.total / exact.total - 1.0));
  m.bins.push_back(bin_error(found, exact));
  curve->prepared_s.push_back(found.prepared_s);
}

/// Methods in turn, at every effort and seed.
std::vector<Curve> measure(const std::vector<EndMethod>& methods, const Answer& exact, const Options& options) {
  std::vector<Curve> curves;
  std::size_t most = 0;
  for (const EndMethod& m : methods) {
    m.run(m.efforts.front(), 1);  // the first run of a program finishes its compilation
    curves.push_back({m.name, m.ends, {}, {}});
    most = std::max(most, m.efforts.size());
  }
  // What always gives the same answer runs among all efforts of the others.
  const int turns = (kRunsThatEnd + static_cast<int>(most) - 1) / static_cast<int>(most);
  for (std::size_t e = 0; e < most; ++e) {
    for (int seed = 1; seed <= options.seeds; ++seed) {
      for (std::size_t k = 0; k < methods.size(); ++k) {
        const std::vector<int>& efforts = methods[k].efforts;
        const bool enough =
            e > 0 && e <= curves[k].at.size() && 4.0 * median(curves[k].at[e - 1].seconds) > options.max_seconds;
        if (methods[k].ends) {
          if (seed <= turns) take(methods[k], exact, efforts.front(), static_cast<std::uint64_t>(seed), &curves[k]);
          continue;
        }
        if (e >= efforts.size() || curves[k].at.size() < e || enough) continue;
        take(methods[k], exact, efforts[e], static_cast<std::uint64_t>(seed), &curves[k]);
      }
    }
  }
  return curves;
}

using Errors = double (*)(const Measured&);
double total_error(const Measured& m) {
  return rms(m.total);
}
double bins_error(const Measured& m) {
  return mean(m.bins);
}

/// log2 of an error against effort, as a straight line by least squares: its slope, and its value at the last effort.
struct Fall {
  double slope = std::nan(""), last = std::nan("");
};
Fall fall_of(const Curve& curve, Errors error) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Measured& m : curve.at) {
    if (!(error(m) < kBlind)) continue;
    const double x = m.effort, y = std::log2(error(m));
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  if (n < 2) return {};
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return {slope, (sy + slope * (n * curve.at.back().effort - sx)) / n};
}

struct Time {
  double seconds = std::nan("");
  const char* how = "";  // "<": less than the first effort; "~": by the slope
  std::string text() const { return std::isnan(seconds) ? "–" : fmt::format("{}{:.2g} s", how, seconds); }
};

/// The time from which on the error stays within a target, between the efforts measured, or beyond them by the slope.
Time time_to(const Curve& curve, Errors error, double target) {
  const std::vector<Measured>& at = curve.at;
  std::size_t i = at.size();
  while (i > 0 && error(at[i - 1]) <= target) --i;
  if (i == 0) return {median(at.front().seconds), curve.ends ? "" : "< "};
  const double from = std::log(median(at[i - 1].seconds)), above = std::log(error(at[i - 1]) / target);
  if (i < at.size()) {
    const double to = std::log(median(at[i].seconds)), below = std::log(target / error(at[i]));
    return {std::exp(from + (to - from) * above / (above + below)), ""};
  }
  // Beyond the longest runs time goes with effort.
  const Fall fall = fall_of(curve, error);
  if (!(fall.slope < -0.2)) return {};
  const double doublings = std::max(0.0, (std::log2(target) - fall.last) / fall.slope);
  return {std::exp(from) * std::exp2(doublings), "~ "};
}

std::string table(const std::vector<BodyCurves>& all) {
  std::vector<std::vector<std::string>> rows = {
      {"body", "faces", "method", "before", "total to 0.1 %", "0.01 %", "0.001 %", "bins to 5 %", "1 %"}};
  for (const BodyCurves& body : all) {
    for (const Curve& c : body.curves) {
      rows.push_back(
          {body.name, std::to_string(body.triangles), c.method, fmt::format("{:.2g} s", median(c.prepared_s))});
      for (const double target : kTotals) rows.back().push_back(time_to(c, total_error, target).text());
      for (const double target : kBins) rows.back().push_back(time_to(c, bins_error, target).text());
    }
  }
  return markdown(rows);
}

std::string csv(const std::vector<BodyCurves>& all) {
  std::string text =
      "# relative errors against the exact pulse, over seeds; effort: log2 of rays; medians of seconds of tracing\n"
      "body,faces,method,effort,seeds,trace_s,total_rms,total_largest,bins_mean,before_s\n";
  for (const BodyCurves& body : all) {
    for (const Curve& c : body.curves) {
      for (const Measured& m : c.at)
        text += fmt::format("{},{},\"{}\",{},{},{:.6g},{:.4e},{:.4e},{:.4e},{:.4g}\n", body.name, body.triangles,
                            c.method, m.effort, m.seconds.size(), median(m.seconds), total_error(m),
                            *std::max_element(m.total.begin(), m.total.end()), bins_error(m), median(c.prepared_s));
    }
  }
  return text;
}

std::vector<int> efforts_of(const Options& options) {
  std::vector<int> log2_rays;
  for (int k = 12; k <= (options.quick ? 16 : 26); k += 2) log2_rays.push_back(k);
  return log2_rays;
}

BodyCurves measure_body(const EndBody& body, const Options& options, clray::Device& device, std::string* about) {
  EndCase which{body.name, clray_test::scene_of(body.mesh(), clray_test::lambert(0.5))};
  const double length = std::sqrt(0.3 * 0.3 + 0.5 * 0.5 + 0.81 * 0.81);
  clray_test::monostatic(which.scene, {-0.3 / length, -0.5 / length, -0.81 / length});
  const std::vector<int> log2_rays = efforts_of(options);
  std::vector<EndMethod> methods = clray_methods(which, log2_rays, device);
  const Answer exact = methods.front().run(0, 1);
  clray::Scene one = which.scene;
  clray_test::rays(one, 10);
  const clray::DelayResult window = clray::trace(one, device).delay.at(0);
  std::string rival;
  for (EndMethod& m :
       embree_methods(which, {window.first_bin_start_s, window.bin_width_s, exact.bins.size()}, log2_rays, &rival))
    methods.push_back(std::move(m));
  if (!rival.empty()) *about += "- " + rival + "\n";
  return {body.name, which.scene.components.at(0).mesh->triangles.size(), measure(methods, exact, options)};
}

bool strayed(const BodyCurves& body) {
  bool found = false;
  for (const Curve& c : body.curves) {
    const double off = median(c.at.back().total);
    if (off <= kStrayed) continue;
    found = true;
    fmt::print(stderr, "clray-bench: {}: {} is off by {:.1e} of the total at its greatest effort\n", body.name,
               c.method, off);
  }
  return found;
}

}  // namespace

int end(const Options& asked) {
  Options options = asked;
  if (options.quick) options.seeds = std::min(options.seeds, 5);
  clray::Device device(options.devices.empty() ? clray_test::device_name() : options.devices.front());
  std::vector<BodyCurves> all;
  std::string about;
  bool wrong = false;
  for (const EndBody& body : end_bodies(options)) {
    if (!wanted(options, body.name)) continue;
    all.push_back(measure_body(body, options, device, &about));
    wrong = strayed(all.back()) || wrong;
    fmt::print("{}", table({all.back()}));
    std::fflush(stdout);
  }
  if (all.empty()) return 2;
  const std::string stem = options.quick || !options.only.empty() ? "end-short" : "end";
  write_text(options.out, stem + ".csv", csv(all));
  write_text(
      options.out, stem + ".md",
      fmt::format("# Time to a given error\n\nWritten by `clray-bench end` on {}; {}.\n"
                  "Medians of {} runs in turn: of tracing, and of what goes before it (geometry and trees). Totals: "
                  "rms error over "
                  "seeds.\nBins: mean relative error of those of 512 that hold at least {:g} % of an even share.\n"
                  "~: beyond the longest runs, by the slope; <: the first effort is enough.\n\n{}\n{}",
                  device_line(device.info()), embree_line(), options.seeds, 100.0 * kLeastShare, table(all), about));
  return wrong ? 1 : 0;
}

}  // namespace clray_bench
