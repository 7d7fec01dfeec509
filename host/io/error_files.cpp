// SPDX-License-Identifier: Apache-2.0
// error.csv and error.png: relative standard error against rays and against seconds of tracing, on every run; with a
// reference also the true error. What is claimed falls as N^-1/2 for random points, faster for Sobol points.
#include <algorithm>
#include <cmath>

#include "clray/write.hpp"
#include "io/writer.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

/// True error of the first total at one point of the run; NaN if the run did not keep the total.
std::vector<double> true_errors(const Writer& writer) {
  std::vector<double> errors(writer.result.errors.size(), std::nan(""));
  if (!writer.reference || writer.result.errors.empty()) return errors;
  const double wanted = first_reference_total(writer.result, *writer.reference);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    errors[i] = std::fabs(writer.result.errors[i].first_total - wanted) / std::fabs(wanted);
  }
  if (std::isnan(errors.back())) errors.back() = relative_true_error(writer.result, *writer.reference);
  return errors;
}

/// The largest bound of rounding over its value, of the exact totals; NaN where there are none.
double relative_rounding(const Result& result) {
  double largest = std::nan("");
  const auto look = [&](const Estimate& e) {
    if (e.exact() && e.value > 0.0) largest = std::fmax(largest, e.rounding_bound / e.value);
  };
  for (const DelayResult& d : result.delay) look(d.intensity_m2_per_sr);
  for (const SpectrometerResult& s : result.spectrometer) look(s.intensity_m2_per_sr);
  for (const PressureResult& p : result.pressure) look(p.absorbed_m2);
  return largest;
}

void error_table(Writer& writer, const std::vector<double>& truth) {
  auto table =
      writer.table(writer.add("error", "csv"), "error against run time, a row per doubling; the last row is the result",
                   "rays per orientation; seconds of tracing from the start of the phase; errors relative to the value "
                   "(standard error: the largest over all totals)");
  std::vector<std::string> columns{"rays", "seconds", "relative_standard_error"};
  if (writer.reference) columns.push_back("relative_true_error");
  const double rounding = relative_rounding(writer.result);
  if (!std::isnan(rounding)) columns.push_back("rounding_bound");
  columns.push_back("phase");
  table.columns(columns);
  for (std::size_t i = 0; i < writer.result.errors.size(); ++i) {
    const auto& point = writer.result.errors[i];
    if (point.rays != 0) {
      table.cell(point.rays);
    } else {
      table.cell(std::string_view());  // nothing was sampled
    }
    table.cell(point.seconds).cell(point.relative_standard_error);
    if (writer.reference) table.cell(truth[i]);
    if (!std::isnan(rounding)) table.cell(point.rays == 0 ? rounding : std::nan(""));
    table.cell(std::string_view(point.phase)).end_row();
  }
  table.close();
}

/// Writes the points that a logarithmic axis can show. Returns the first, or zero if there is none.
struct Place {
  double x = 0.0, error = 0.0;
};

struct Series {
  std::vector<ErrorPoint> points;
  void data(Plot& plot, const std::string& name) const {
    plot.begin_data(name);
    for (const auto& p : points) plot.point({static_cast<double>(p.rays), p.seconds, p.relative_standard_error});
    plot.end_data();
  }
};

bool drawable(double error) {
  return std::isfinite(error) && error > 0.0;
}

/// "[low:high]" for a logarithmic axis: around the values with a margin, at least half a decade wide.
std::string log_range(double low, double high) {
  const double air = high / low < 3.0 ? 2.0 : 1.4;
  return "[" + number(low / air) + ":" + number(high * air) + "]";
}

/// Labels at 1, 2 and 5 times powers of ten, since gnuplot's own leave an axis of less than a decade bare.
std::string log_tics(const std::string& axis, double low, double high) {
  std::string tics;
  const int first = static_cast<int>(std::floor(std::log10(low))) - 1,
            last = static_cast<int>(std::ceil(std::log10(high)));
  const bool sparse = high / low > 60.0;
  for (int power = first; power <= last; ++power) {
    for (const int mantissa : {1, 2, 5}) {
      if (sparse && mantissa != 1) continue;
      const std::string ten = "10^{" + std::to_string(power) + "}";
      tics += (tics.empty() ? "'" : ", '") + (mantissa == 1 ? ten : std::to_string(mantissa) + "·" + ten) + "' " +
              number(mantissa * std::pow(10.0, power));
    }
  }
  return "set " + axis + "tics (" + tics + "); ";
}

/// Range and labels of an axis ("x" or "y") that shows a coordinate of several series.
template <class Coordinate>
std::string log_axis(const std::string& axis, const std::vector<const Series*>& all, Coordinate coordinate) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const auto* series : all) {
    for (const auto& point : series->points) {
      const double x = coordinate(point);
      if (!(x > 0.0)) continue;
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  if (!(high > 0.0)) low = 1.0, high = 10.0;
  return log_tics(axis, low, high) + "set " + axis + "range " + log_range(low, high);
}

/// One panel: x is column 1 (rays) or 2 (seconds). The guide passes through the first claimed point.
void panel(Plot& plot, const std::string& column, const std::string& xlabel, Place guide, bool confirmed, bool truth) {
  plot.line("set xlabel " + gnuplot_text(xlabel));
  std::string command = "plot ";
  if (guide.x > 0.0 && guide.error > 0.0) {
    command += number(guide.error) + "*sqrt(" + number(guide.x) +
               "/x) with lines dashtype 2 linewidth 1 linecolor '#999999' title 'falling as N^{-1/2}', ";
  }
  command += "$claimed using " + column +
             ":3 with linespoints pointtype 7 pointsize 1.1 linecolor '#0b4f94' "
             "title 'claimed standard error'";
  if (confirmed) {
    command += ", $confirmed using " + column +
               ":3 with linespoints pointtype 6 pointsize 1.8 linewidth 1.4 "
               "linecolor '#c8511b' title 'confirmation, last: result'";
  }
  if (truth) {
    command += ", $true using " + column +
               ":3 with linespoints pointtype 5 pointsize 1.0 linecolor '#2b8a3e' "
               "title 'true error'";
  }
  plot.line(command);
}

void error_picture(Writer& writer, const std::vector<double>& truth) {
  Series claimed, confirmed, true_error;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto& point = writer.result.errors[i];
    if (drawable(point.relative_standard_error)) {
      (point.phase == "confirm" ? confirmed : claimed).points.push_back(point);
    }
    if (drawable(truth[i])) {
      true_error.points.push_back(point);
      true_error.points.back().relative_standard_error = truth[i];
    }
  }
  const std::string name = writer.add("error", "png");
  Plot plot(name);
  const std::string title = gnuplot_text(writer.scene_name() + ": error against cost");
  if (claimed.points.empty() && confirmed.points.empty()) {
    const bool exact = !writer.result.errors.empty() && writer.result.errors.back().relative_standard_error == 0.0;
    const bool solved = !std::isnan(relative_rounding(writer.result));
    plot.line("set title " + title + " font ',18'; unset border; unset tics; unset key; unset grid");
    plot.line(std::string("set label 1 ") +
              gnuplot_text(solved  ? "exact: visibility was solved, nothing was sampled"
                           : exact ? "the standard error is exactly 0: every replicate found the same total"
                                   : "no error to show: nothing came back, or nothing was finished") +
              " at graph 0.5, graph 0.5 center font ',18' textcolor '#555555'");
    plot.line("plot [0:1][0:1] -1 notitle");
    writer.draw(plot, name);
    return;
  }
  claimed.data(plot, "claimed");
  confirmed.data(plot, "confirmed");
  true_error.data(plot, "true");
  const auto& first = (claimed.points.size() < confirmed.points.size() ? confirmed : claimed).points.front();
  plot.line("set multiplot layout 1,2 title " + title + " font ',18'");
  plot.line("set logscale xy");
  plot.line("set grid xtics ytics mxtics mytics linecolor '#cccccc' linewidth 0.6, linecolor '#eeeeee' linewidth 0.4");
  plot.line(
      "set key at screen 0.985, screen 0.955 right top horizontal maxrows 1 Left reverse nobox width -3 font ',12'; "
      "set ylabel 'error relative to the value' offset 1,0; set tmargin at screen "
      "0.9");
  const bool any_confirmed = !confirmed.points.empty(), any_truth = !true_error.points.empty();
  const std::vector<const Series*> all{&claimed, &confirmed, &true_error};
  const auto rays = [](const ErrorPoint& p) { return static_cast<double>(p.rays); };
  const auto seconds = [](const ErrorPoint& p) { return p.seconds; };
  plot.line(log_axis("y", all, [](const ErrorPoint& p) { return p.relative_standard_error; }));
  plot.line("set lmargin at screen 0.12; set rmargin at screen 0.515; " + log_axis("x", all, rays));
  panel(plot, "1", "rays per orientation", {static_cast<double>(first.rays), first.relative_standard_error},
        any_confirmed, any_truth);
  plot.line("set lmargin at screen 0.595; set rmargin at screen 0.985; unset ylabel; unset key");
  plot.line(log_axis("x", all, seconds));
  panel(plot, "2", "seconds of tracing", {first.seconds, first.relative_standard_error}, any_confirmed, any_truth);
  plot.line("unset multiplot");
  writer.draw(plot, name);
}

}  // namespace

void write_error(Writer& writer) {
  const auto truth = true_errors(writer);
  error_table(writer, truth);
  if (writer.options.plots) error_picture(writer, truth);
}

}  // namespace clray::io
