// SPDX-License-Identifier: Apache-2.0
// The delay camera's files: delay.csv (one row per bin), delay.png (the pulse with its error band), and for several
// orientations delay-totals.csv and delay.fits (orientation x bin); with several bands, files for each. Delays in ns,
// densities in m²/sr per ns.
#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "io/fits_file.hpp"
#include "io/writer.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Group = std::vector<const DelayResult*>;

double at(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? values[i] : std::nan("");
}

std::string title_of(const Writer& writer, const ResultKey& key) {
  return writer.title("delay", key) + (key.band.empty() ? "" : ", " + key.band + " nm");
}

void delay_row(TableFile& table, const DelayResult& delay, std::size_t bin, bool photons) {
  const double width_ns = delay.bin_width_s * 1e9;
  table.cell((delay.first_bin_start_s + (static_cast<double>(bin) + 0.5) * delay.bin_width_s) * 1e9);
  table.cell(delay.bin_m2_per_sr[bin] / width_ns).cell(at(delay.bin_standard_error, bin) / width_ns);
  table.cell(bin < delay.hits.size() ? delay.hits[bin] : std::uint64_t{0});
  const bool resolved = bin < delay.resolved.size() && delay.resolved[bin];
  table.cell(std::uint64_t{resolved});
  table.cell(resolved ? std::nan("") : at(delay.bin_upper_bound, bin) / width_ns);
  if (photons) table.cell(at(delay.photons_per_ns, bin));
  table.end_row();
}

void delay_table(Writer& writer, const Group& group, const std::string& stem) {
  const bool several = group.size() > 1, photons = !group.front()->photons_per_ns.empty();
  auto table = writer.table(writer.add(stem, "csv"), "delay histogram A(t) of " + title_of(writer, group.front()->key),
                            "delay_ns: bin centres, ns after a path by way of the reference point; "
                            "intensity, standard_error and upper_bound: m^2/sr per ns" +
                                std::string(photons ? "; photons_per_ns: expected at the station" : ""));
  if (!several) {
    const auto& delay = *group.front();
    table.comment("total_m2_per_sr: " + number(delay.intensity_m2_per_sr.value) + " with standard error " +
                  number(delay.intensity_m2_per_sr.standard_error) + ", of which below the first bin " +
                  number(delay.below_m2_per_sr) + " and above the last " + number(delay.above_m2_per_sr));
  }
  table.comment("resolved: 0 where a bin was hit too seldom for its error to be trusted; it gets a 95 % upper_bound");
  std::vector<std::string> columns{"delay_ns",   "intensity_m2_per_sr_per_ns", "standard_error", "hits", "resolved",
                                   "upper_bound"};
  if (photons) columns.push_back("photons_per_ns");
  if (several) columns.insert(columns.begin(), {"orientation", "time_s"});
  table.columns(columns);
  for (const auto* delay : group) {
    for (std::size_t bin = 0; bin < delay->bin_m2_per_sr.size(); ++bin) {
      if (several) table.cell(std::uint64_t{delay->key.orientation}).cell(time_of(writer.result, delay->key));
      delay_row(table, *delay, bin, photons);
    }
  }
  table.close();
}

void totals_table(Writer& writer, const Group& group, const std::string& stem) {
  auto table = writer.table(
      writer.add(stem + "-totals", "csv"), "totals per orientation of " + title_of(writer, group.front()->key),
      "time s; intensity m^2/sr; cross-section m^2; delays ns; low and high bound the 95 % interval");
  table.columns({"orientation", "time_s", "intensity_m2_per_sr", "standard_error", "low", "high", "cross_section_m2",
                 "mean_delay_ns", "mean_delay_standard_error_ns", "rms_width_ns", "rms_width_standard_error_ns"});
  for (const auto* delay : group) {
    const auto& a = delay->intensity_m2_per_sr;
    table.cell(std::uint64_t{delay->key.orientation}).cell(time_of(writer.result, delay->key));
    table.cell(a.value).cell(a.standard_error).cell(a.low).cell(a.high).cell(4.0 * constants::kPi * a.value);
    table.cell(delay->mean_delay_s.value * 1e9).cell(delay->mean_delay_s.standard_error * 1e9);
    table.cell(delay->rms_width_s.value * 1e9).cell(delay->rms_width_s.standard_error * 1e9);
    table.end_row();
  }
  table.close();
}

bool same_bins(const Group& group) {
  return std::all_of(group.begin(), group.end(), [&](const DelayResult* delay) {
    return delay->bin_m2_per_sr.size() == group.front()->bin_m2_per_sr.size() &&
           delay->first_bin_start_s == group.front()->first_bin_start_s &&
           delay->bin_width_s == group.front()->bin_width_s;
  });
}

void delay_fits(Writer& writer, const Group& group, const std::string& stem) {
  const auto& first = *group.front();
  const std::size_t bins = first.bin_m2_per_sr.size();
  const double width_ns = first.bin_width_s * 1e9;
  std::vector<double> values, errors;
  FitsColumn index{"ORIENTATION", "", {}, {}}, time{"TIME", "s", {}, {}}, total{"INTENSITY", "m2 sr-1", {}, {}},
      error{"STANDARD_ERROR", "m2 sr-1", {}, {}};
  for (const auto* delay : group) {
    for (std::size_t bin = 0; bin < bins; ++bin) {
      values.push_back(delay->bin_m2_per_sr[bin] / width_ns);
      errors.push_back(at(delay->bin_standard_error, bin) / width_ns);
    }
    index.numbers.push_back(static_cast<double>(delay->key.orientation));
    time.numbers.push_back(time_of(writer.result, delay->key));
    total.numbers.push_back(delay->intensity_m2_per_sr.value);
    error.numbers.push_back(delay->intensity_m2_per_sr.standard_error);
  }
  const std::vector<FitsAxis> axes{{static_cast<long>(bins), "DELAY", "ns", 1.0,
                                    (first.first_bin_start_s + 0.5 * first.bin_width_s) * 1e9, width_ns},
                                   {static_cast<long>(group.size()), "ORIENTATION", "", 1.0, 0.0, 1.0}};
  FitsFile file(writer.folder.path(writer.add(stem, "fits")));
  file.image("DELAY", "m2 sr-1 ns-1", axes, values);
  file.history("clray " CLRAY_VERSION ": delay histograms A(t), one row per orientation");
  file.history("scene " + (writer.scene.path.empty() ? writer.scene.name : writer.scene.path));
  file.history("seed " + std::to_string(writer.result.seed) + ", digest " + hex16(writer.result.digest));
  file.image("STANDARD_ERROR", "m2 sr-1 ns-1", axes, errors);
  file.table("ORIENTATIONS", {index, time, total, error});
  file.close();
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

void pulse_picture(Writer& writer, const DelayResult& delay, const std::string& stem) {
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
  const auto estimate = [&](const Estimate& e, double scale) {
    return format_with_error(e.value * scale, e.standard_error * scale);
  };
  plot.line("set label 1 " + gnuplot_text(title_of(writer, delay.key)) +
            " at screen 0.54, 0.97 center font ',19' textcolor '#000000'");
  plot.line("set label 2 " +
            gnuplot_text("A = " + estimate(a, 1.0) + " m²/sr    σ = " + estimate(a, 4.0 * constants::kPi) +
                         " m²    mean " + estimate(delay.mean_delay_s, unit.per_second) + " " + unit.name +
                         "    rms width " + estimate(delay.rms_width_s, unit.per_second) + " " + unit.name) +
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
  plot.line("set key top center horizontal maxrows 1 Left reverse width -2 height 0.2 samplen 2 font ',13'");
  plot.line("set tmargin at screen " + std::string(depths ? "0.82" : "0.885"));
  plot.line("set boxwidth " + number(curve.width) + "; set style fill solid 1.0 noborder");
  std::string command = "plot ";
  if (any_unresolved) command += "$bound using 1:2 with boxes linecolor '#f3d9b8' title 'unresolved, 95 % bound', ";
  command +=
      "$pulse using 1:3:4 with filledcurves linecolor '#a9c9ea' title '± 1 standard error', "
      "$pulse using 1:2 with lines linewidth 1.4 linecolor '#0b4f94' title 'A(t)'";
  plot.line(command);
  writer.draw(plot, name);
}

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

void map_picture(Writer& writer, const Group& group, const std::string& stem) {
  const auto& first = *group.front();
  const TimeUnit unit = readable_time_unit(first.bin_width_s * static_cast<double>(first.bin_m2_per_sr.size()));
  const bool by_time = even_times(writer, group);
  const std::size_t skip = (group.size() + 1199) / 1200;
  const double start = by_time ? time_of(writer.result, first.key) : 0.0;
  const double step = by_time ? time_of(writer.result, group[1]->key) - start : 1.0;
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  plot.begin_data("map");
  Curve curve;
  for (std::size_t i = 0; i < group.size(); i += skip) {
    curve = curve_of(*group[i], unit.per_second, 700);
    for (std::size_t bin = 0; bin < curve.value.size(); ++bin) {
      plot.point({start + step * static_cast<double>(i), curve.start + (static_cast<double>(bin) + 0.5) * curve.width,
                  curve.value[bin]});
    }
  }
  plot.end_data();
  plot.line("set title " +
            gnuplot_text(title_of(writer, first.key) + ": " + std::to_string(group.size()) + " orientations") +
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

}  // namespace

void write_delay(Writer& writer) {
  for (const auto& group : groups_by_band(writer.result.delay)) {
    const ResultKey& key = group.front()->key;
    const std::string stem = writer.stem("delay", key, true);
    delay_table(writer, group, stem);
    if (group.size() > 1) {
      totals_table(writer, group, stem);
      if (same_bins(group)) delay_fits(writer, group, stem);
    }
    if (!writer.options.plots) continue;
    if (group.size() > 1 && same_bins(group)) {
      map_picture(writer, group, stem);
    } else {
      pulse_picture(writer, *group.front(), stem);
    }
  }
}

}  // namespace clray::io
