// SPDX-License-Identifier: Apache-2.0
// See error_report.hpp: the picture. A panel a case, log-log, error against tracing time; of each sampler the true
// error that 90 % of seeds stay within, and the claim for it; of the exact method its rounding bound.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "error_report.hpp"
#include "text/gnuplot.hpp"

namespace clray_bench {

namespace {

constexpr const char* kColours[kSamplerCount] = {"#d1342b", "#e69f00", "#0b4f94"};  // random, sobol, stratified
constexpr const char* kTilesColour = "#2f9e44";
constexpr int kColumns = 3;
/// A normal error stays within 1.645 standard errors in 90 % of cases.
constexpr double kNinety = 1.645;

/// The curve's data; returns what draws them.
std::string curve(clray::text::Plot& plot, const Curve& c, const char* colour) {
  plot.begin_data(c.sampler.name);
  for (const Point& p : c.points)
    plot.point(
        {median(p.seconds), std::max(quantile(p.truth, 0.9), 1e-16), std::max(kNinety * median(p.claim), 1e-16)});
  plot.end_data();
  return fmt::format(
      "${} using 1:2 with linespoints pt 7 ps 0.7 lw 1.2 lc rgb '{}' title '{}', ${} using 1:3 with lines dt 2 lw "
      "1.2 lc rgb '{}' notitle",
      c.sampler.name, colour, c.sampler.name, c.sampler.name, colour);
}

void panel(clray::text::Plot& plot, const Curve* curves, const DeviceCurves& all) {
  const auto same = [&](const auto& other) { return other.which == curves->which; };
  std::string lines = "plot ";
  for (int k = 0; k < kSamplerCount; ++k) lines += (k == 0 ? "" : ", ") + curve(plot, curves[k], kColours[k]);
  const auto tiles = std::find_if(all.tiles.begin(), all.tiles.end(), same);
  if (tiles != all.tiles.end()) lines += ", " + curve(plot, *tiles, kTilesColour);
  const auto exact = std::find_if(all.solved.begin(), all.solved.end(), same);
  if (exact != all.solved.end()) {
    plot.begin_data("exact");
    plot.point({exact->seconds, exact->bound});
    plot.end_data();
    lines += ", $exact using 1:2 with points pt 2 ps 1.6 lw 2 lc rgb 'black' title 'exact'";
  }
  plot.line("set title " + clray::text::gnuplot_text(curves->which->name)).line(lines);
}

}  // namespace

void plot_error(const std::string& folder, const std::string& name, const DeviceCurves& all) {
  const std::vector<Curve>& curves = all.curves;
  const int cases = static_cast<int>(curves.size()) / kSamplerCount, rows = (cases + kColumns - 1) / kColumns;
  clray::text::Plot plot(name, 1800, 420 * rows + 60);
  plot.line(
      fmt::format("set multiplot layout {},{} title 'Relative error against tracing time: within which 90 % of "
                  "seeds lie (solid: true; dashed: claimed, 1.645 standard errors)' font ',18'",
                  rows, kColumns));
  plot.line(
      "set lmargin; set rmargin; set bmargin; set logscale xy; set format xy '10^{%L}'; set xtics 10; set ytics 100");
  plot.line(
      "set key bottom left noopaque nobox width 0 font ',13'; set xlabel 'tracing, s' offset 0,0.3; set ylabel "
      "'relative "
      "error'");
  for (int i = 0; i < cases; ++i) panel(plot, &curves[static_cast<std::size_t>(i * kSamplerCount)], all);
  plot.line("unset multiplot");
  std::filesystem::create_directories(folder);
  const std::string trouble = plot.draw(folder);
  if (!trouble.empty()) fmt::print(stderr, "clray-bench: {}\n", trouble);
}

}  // namespace clray_bench
