// SPDX-License-Identifier: Apache-2.0
// See error_report.hpp: the picture. A panel a case, log-log, error against tracing time; of each sampler the true
// error that 90 % of seeds stay within, and the claim for it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "error_report.hpp"

namespace clray_bench {

namespace {

constexpr const char* kColours[kSamplerCount] = {"#d1342b", "#e69f00", "#0b4f94"};  // random, sobol, stratified
constexpr int kColumns = 3;
/// A normal error stays within 1.645 standard errors in 90 % of cases.
constexpr double kNinety = 1.645;

std::string panel(const Curve* curves) {
  std::string data, lines;
  for (int k = 0; k < kSamplerCount; ++k) {
    const Curve& c = curves[k];
    data += fmt::format("${} << EOD\n", c.sampler.name);
    for (const Point& p : c.points)
      data += fmt::format("{} {} {}\n", median(p.seconds), std::max(quantile(p.truth, 0.9), 1e-16),
                          std::max(kNinety * median(p.claim), 1e-16));
    data += "EOD\n";
    lines += fmt::format(
        "{}${} using 1:2 with linespoints pt 7 ps 0.6 lw 1.6 lc rgb '{}' title '{}', ${} using 1:3 with lines dt 2 lw "
        "1.6 lc rgb '{}' notitle",
        k == 0 ? "plot " : ", ", c.sampler.name, kColours[k], c.sampler.name, c.sampler.name, kColours[k]);
  }
  return data + fmt::format("set title '{}'\n", curves->which->name) + lines + "\n";
}

}  // namespace

void plot_error(const std::string& folder, const std::string& name, const std::vector<Curve>& curves) {
  const int cases = static_cast<int>(curves.size()) / kSamplerCount, rows = (cases + kColumns - 1) / kColumns;
  std::string script = fmt::format(
      "set encoding utf8\nset terminal pngcairo size 1500,{} font 'DejaVu Sans,11'\nset output '{}/{}'\nset multiplot "
      "layout {},{} title 'Relative error against tracing time: within which 90 % of seeds lie (solid: true; dashed: "
      "claimed, 1.645 standard errors)' font ',14'\nset logscale xy\nset format xy '10^{{%L}}'\nset grid xtics ytics "
      "lt 1 "
      "lc rgb '#dddddd'\nset key bottom left samplen 2 opaque nobox\nset xlabel 'tracing, s' offset 0,0.5\nset ylabel "
      "'relative error' offset 1,0\n",
      360 * rows + 60, folder, name, rows, kColumns);
  for (int i = 0; i < cases; ++i) script += panel(&curves[static_cast<std::size_t>(i * kSamplerCount)]);
  std::filesystem::create_directories(folder);
  gnuplot(script + "unset multiplot\n");
}

}  // namespace clray_bench
