// SPDX-License-Identifier: Apache-2.0
// See delay_pictures.hpp.
#include "io/detector/delay_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "io/detector/words.hpp"
#include "text/text.hpp"

namespace clray::io {

std::string delay_title(const Writer& writer, const ResultKey& key) {
  return writer.title("delay", key) + (key.band.empty() ? "" : ", " + key.band + " nm");
}

namespace {

using Group = std::vector<const DelayResult*>;

double at(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? values[i] : std::nan("");
}

/// A histogram no finer than a picture can show. The error of joined bins is the mean of theirs: its upper limit, since
/// neighbouring bins may be correlated.
struct Curve {
  double start = 0.0, width = 0.0;  ///< plot units
  std::vector<double> value, error, bound;
};

Curve curve_of(const DelayResult& delay, double per_second, std::size_t most) {
  const std::size_t bins = delay.bin_m2_per_sr.size(), join = (bins + most - 1) / std::max<std::size_t>(most, 1);
  const std::size_t step = std::max<std::size_t>(join, 1);
  Curve curve{
      delay.first_bin_start_s * per_second, delay.bin_width_s * per_second * static_cast<double>(step), {}, {}, {}};
  const double bin_width = delay.bin_width_s * per_second;
  for (std::size_t begin = 0; begin < bins; begin += step) {
    const std::size_t end = std::min(begin + step, bins);
    double value = 0.0, error = 0.0, bound = 0.0;
    bool unresolved = true;
    for (std::size_t i = begin; i < end; ++i) {
      value += delay.bin_m2_per_sr[i];
      error += at(delay.bin_standard_error, i);
      bound += i < delay.bin_upper_bound.size() ? delay.bin_upper_bound[i] : 0.0;
      unresolved = unresolved && i < delay.resolved.size() && !delay.resolved[i];
    }
    const double scale = 1.0 / (bin_width * static_cast<double>(end - begin));
    curve.value.push_back(value * scale);
    curve.error.push_back(error * scale);
    curve.bound.push_back(unresolved ? bound * scale : std::nan(""));
  }
  return curve;
}

double highest(const Curve& curve) {
  double high = 0.0;
  for (std::size_t i = 0; i < curve.value.size(); ++i) {
    if (std::isfinite(curve.value[i] + curve.error[i])) high = std::max(high, curve.value[i] + curve.error[i]);
  }
  return high;
}

/// The upper axis, for a round trip: depth along the line of sight, which is half the delay times c.
void depth_axis(Plot& plot, double per_second, double start, double end) {
  const double m_per_unit = 0.5 * constants::kLightSpeed_m_s / per_second;
  plot.line("set border 7; set xtics nomirror");
  plot.line("set x2range [" + number(start * m_per_unit) + ":" + number(end * m_per_unit) + "]");
  plot.line("set x2tics nomirror; set x2label 'depth away from the station (m)' offset 0,-0.5 textcolor '#555555'");
}

bool monostatic(const Writer& writer, const ResultKey& key) {
  for (const auto& observer : writer.scene.observers) {
    if (key.observer.empty() || observer.name == key.observer) return at_source(observer, writer.scene.source);
  }
  return false;
}

/// The lower end of the axis of A. It is 0, or, if one bright line would press the rest flat, a positive number below
/// the faint part: the axis is then logarithmic.
double axis_floor(const Curve& curve) {
  std::vector<double> lit;
  for (const double value : curve.value) {
    if (value > 0.0 && std::isfinite(value)) lit.push_back(value);
  }
  if (lit.size() < 8) return 0.0;
  std::sort(lit.begin(), lit.end());
  const double top = lit.back(), middle = lit[lit.size() / 2];
  return top > 100.0 * middle ? std::max(0.3 * lit[lit.size() / 50], 1e-8 * top) : 0.0;
}

void pulse_data(Plot& plot, const Curve& curve, double floor) {
  plot.begin_data("pulse");
  plot.point({curve.start, floor, floor, floor});
  for (std::size_t i = 0; i < curve.value.size(); ++i) {
    const double value = std::max(floor, curve.value[i]), low = std::max(floor, curve.value[i] - curve.error[i]);
    const double high = std::max(floor, curve.value[i] + curve.error[i]);
    for (const std::size_t edge : {i, i + 1}) {
      plot.point({curve.start + static_cast<double>(edge) * curve.width, value, low, high});
    }
  }
  plot.point({curve.start + static_cast<double>(curve.value.size()) * curve.width, floor, floor, floor});
  plot.end_data();
}

/// Draws unresolved bins as boxes up to their bound; returns whether there are any.
bool bound_data(Plot& plot, const Curve& curve) {
  plot.begin_data("bound");
  bool any = false;
  for (std::size_t i = 0; i < curve.bound.size(); ++i) {
    if (!std::isfinite(curve.bound[i])) continue;
    any = true;
    plot.point({curve.start + (static_cast<double>(i) + 0.5) * curve.width, curve.bound[i]});
  }
  plot.end_data();
  return any;
}

}  // namespace

void delay_pulse_picture(Writer& writer, const DelayResult& delay, const std::string& stem) {
  const auto& a = delay.intensity_m2_per_sr;
  const double window_s = delay.bin_width_s * static_cast<double>(delay.bin_m2_per_sr.size());
  const TimeUnit unit = readable_time_unit(window_s);
  const Curve curve = curve_of(delay, unit.per_second, 2400);
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  const double floor = axis_floor(curve);
  pulse_data(plot, curve, floor);
  const bool any_unresolved = bound_data(plot, curve);
  const double top = highest(curve);
  plot.line("set label 1 " + gnuplot_text(delay_title(writer, delay.key)) +
            " at screen 0.54, 0.97 center font ',19' textcolor '#000000'");
  plot.line("set label 2 " +
            gnuplot_text("A = " + scaled(a, 1.0) + " m²/sr    σ = " + scaled(a, 4.0 * constants::kPi) + " m²    mean " +
                         scaled(delay.mean_delay_s, unit.per_second) + " " + unit.name + "    rms width " +
                         scaled(delay.rms_width_s, unit.per_second) + " " + unit.name) +
            " at screen 0.51, 0.925 center font ',11.2' textcolor '#333333'");
  plot.line("set xlabel 'delay after a path by way of the reference point (" + std::string(unit.name) + ")'");
  plot.line("set ylabel 'A(t)  (m² sr⁻¹ " + std::string(unit.name) + "⁻¹)' offset -0.5,0");
  const double end = curve.start + static_cast<double>(curve.value.size()) * curve.width;
  if (end > curve.start) plot.line("set xrange [" + number(curve.start) + ":" + number(end) + "]");
  const bool depths = monostatic(writer, delay.key) && end > curve.start;
  if (depths) depth_axis(plot, unit.per_second, curve.start, end);
  // Room above the curve for the key.
  if (floor > 0.0) {
    plot.line("set logscale y; set format y '10^{%T}'");
    plot.line("set yrange [" + number(floor) + ":" + number(top * std::pow(top / floor, 0.16)) + "]");
  } else {
    plot.line(top > 0.0 ? "set yrange [0:" + number(top * 1.16) + "]" : "set yrange [0:1]");
  }
  if (!(top > 0.0)) {
    plot.line("set label 3 'nothing came back' at graph 0.5, graph 0.5 center font ',20' textcolor '#888888'");
  }
  plot.line("set key inside top center horizontal maxrows 1 Left reverse width -2 height 0.2 samplen 2 font ',13'");
  plot.line("set tmargin at screen " + std::string(depths ? "0.82" : "0.885"));
  plot.line("set boxwidth " + number(curve.width) + "; set style fill solid 1.0 noborder");
  std::string command = "plot ";
  if (any_unresolved) command += "$bound using 1:2 with boxes linecolor '#f3d9b8' title 'unresolved, 95 % bound', ";
  if (!a.exact()) command += "$pulse using 1:3:4 with filledcurves linecolor '#a9c9ea' title '± 1 standard error', ";
  command += "$pulse using 1:2 with lines linewidth 1.4 linecolor '#0b4f94' title 'A(t)" +
             std::string(a.exact() ? ", exact'" : "'");
  plot.line(command);
  writer.draw(plot, name);
}

namespace {

/// Whether the orientations follow each other in equal steps of time.
bool even_times(const Writer& writer, const Group& group) {
  const double first = time_of(writer.result, group.front()->key);
  const double step = time_of(writer.result, group[1]->key) - first;
  for (std::size_t i = 1; i < group.size(); ++i) {
    const double expected = first + step * static_cast<double>(i);
    if (std::fabs(time_of(writer.result, group[i]->key) - expected) > 1e-3 * step) return false;
  }
  return step > 0.0;
}

}  // namespace

void delay_map_picture(Writer& writer, const std::vector<const DelayResult*>& group, const std::string& stem) {
  const auto& first = *group.front();
  const TimeUnit unit = readable_time_unit(first.bin_width_s * static_cast<double>(first.bin_m2_per_sr.size()));
  const bool by_time = even_times(writer, group);
  const std::size_t skip = (group.size() + 1199) / 1200;
  const double start = by_time ? time_of(writer.result, first.key) : 0.0;
  const double step = by_time ? time_of(writer.result, group[1]->key) - start : 1.0;
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  std::vector<Curve> curves;
  double top = 0.0;
  for (std::size_t i = 0; i < group.size(); i += skip) {
    curves.push_back(curve_of(*group[i], unit.per_second, 700));
    for (const double value : curves.back().value) top = std::max(top, value);
  }
  // A flash of a face is thousands of times as bright as the rest of a spin: only logarithms show both.
  const double floor = 1e-4 * top;
  plot.begin_data("map");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Curve& curve = curves[i];
    for (std::size_t bin = 0; bin < curve.value.size(); ++bin) {
      plot.point({start + step * static_cast<double>(i * skip),
                  curve.start + (static_cast<double>(bin) + 0.5) * curve.width, std::max(curve.value[bin], floor)});
    }
  }
  plot.end_data();
  if (top > 0.0) {
    plot.line("set logscale cb; set cbrange [" + number(floor) + ":" + number(top) + "]; set format cb '10^{%T}'");
  } else {
    plot.line(
        "set cbrange [0:1]; set label 3 'nothing came back' at graph 0.5, graph 0.5 center font ',20' textcolor "
        "'#ffffff' front");
  }
  plot.line("set title " +
            gnuplot_text(delay_title(writer, first.key) + ": " + std::to_string(group.size()) + " orientations") +
            " font ',18'");
  plot.line(by_time ? "set xlabel 'time (s)'" : "set xlabel 'orientation'");
  plot.line("set ylabel 'delay after a path by way of the reference point (" + std::string(unit.name) + ")'");
  plot.line("set cblabel 'A(t)  (m² sr⁻¹ " + std::string(unit.name) + "⁻¹)' offset 1,0");
  plot.line(
      "unset grid; unset key; set autoscale xfix; set autoscale yfix; set rmargin at screen 0.84; set tmargin at "
      "screen 0.92");
  plot.line("plot $map using 1:2:3 with image");
  writer.draw(plot, name);
}

}  // namespace clray::io
