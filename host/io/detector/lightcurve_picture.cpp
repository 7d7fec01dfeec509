// SPDX-License-Identifier: Apache-2.0
// Pictures of light curves; see lightcurve_picture.hpp. Magnitudes are those of the Vega system where every band is
// stated in it by habit (Johnson-Cousins, Gaia), else AB; brighter is up. Without a range, A is drawn.
#include "io/detector/lightcurve_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clray/constants.hpp"
#include "ephemeris/epoch.hpp"
#include "text/text.hpp"

namespace clray::io {
namespace {

constexpr const char* kColours[] = {"#0b4f94", "#c8511b", "#2b8a3e", "#8a2b84", "#a67c00", "#3aa6a6",
                                    "#555555", "#d63a6a", "#7aa329", "#6f5bd6", "#8c4a2f", "#1fa0d8"};
constexpr int kPoints[] = {7, 5, 9, 13, 11};  // for each round of the colours

/// Beyond so many instants bars would hide each other; the errors are then a band about the line.
constexpr std::size_t kMostBars = 250;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

enum class Shown { AB, Vega, intensity };

Shown shown_of(const LightCurve& curve) {
  bool magnitudes = false, vega = true;
  for (const BandCurve& band : curve.bands) {
    for (const LightCurveRow& row : band.rows) {
      magnitudes = magnitudes || std::isfinite(row.record->magnitude_AB);
      vega = vega && row.record->band.in_vega;
    }
  }
  return !magnitudes ? Shown::intensity : vega ? Shown::Vega : Shown::AB;
}

struct Point {
  double value, error;
};

/// A star of infinite magnitude (nothing came back) leaves a gap.
Point point_of(const LightCurveRow& row, Shown shown) {
  const SpectrometerResult& s = *row.record;
  if (shown == Shown::intensity) return {s.intensity_m2_per_sr.value, s.intensity_m2_per_sr.standard_error};
  const double magnitude = shown == Shown::Vega ? s.magnitude_Vega : s.magnitude_AB;
  if (!std::isfinite(magnitude) || !std::isfinite(s.magnitude_standard_error)) return {kNan, kNan};
  return {magnitude, s.magnitude_standard_error};
}

/// Whether instants that were not traced, or not seen, lie between two rows.
bool interrupted(const LightCurveRow& first, const LightCurveRow& next) {
  return first.instant != nullptr && next.instant != nullptr && next.instant - first.instant > 1;
}

/// "time after 2026-11-25T18:02:00.000Z (s)", or that of a motion; `zero_s` is subtracted.
std::string time_label(const Writer& writer, const LightCurve& curve, double* zero_s) {
  const auto& rows = curve.bands.front().rows;
  if (!writer.result.instants.empty()) {
    const PassInstant& first = writer.result.instants.front();
    *zero_s = first.time_s;
    return "time after " + ephemeris::iso_text(first.epoch) + " (s)";
  }
  const TimeAxis axis =
      time_axis(time_of(writer.result, rows.front().record->key), time_of(writer.result, rows.back().record->key));
  *zero_s = axis.zero_s;
  return axis.label;
}

bool phase_changes(const LightCurve& curve) {
  double least = 1e300, most = -1e300;
  for (const LightCurveRow& row : curve.bands.front().rows) {
    least = std::min(least, row.record->phase_angle_rad * constants::kDegrees);
    most = std::max(most, row.record->phase_angle_rad * constants::kDegrees);
  }
  return most - least > 0.1;
}

/// The data of each band as $band0 …: time, phase, value, error. Returns the largest error.
double put_data(Plot& plot, const Writer& writer, const LightCurve& curve, Shown shown, double zero_s) {
  double largest = 0.0;
  for (std::size_t b = 0; b < curve.bands.size(); ++b) {
    const std::vector<LightCurveRow>& rows = curve.bands[b].rows;
    plot.begin_data("band" + std::to_string(b));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i > 0 && interrupted(rows[i - 1], rows[i])) plot.point({kNan, kNan, kNan, kNan});
      const Point p = point_of(rows[i], shown);
      if (std::isfinite(p.error)) largest = std::max(largest, p.error);
      plot.point({time_of(writer.result, rows[i].record->key) - zero_s,
                  rows[i].record->phase_angle_rad * constants::kDegrees, p.value, p.error});
    }
    plot.end_data();
  }
  return largest;
}

bool too_many(const LightCurve& curve) {
  return curve.bands.front().rows.size() > kMostBars;
}

/// The curves over column `x`. Over time lines join them, and they have titles.
std::string curves(const LightCurve& curve, int x, bool over_time) {
  std::string command = "plot ";
  for (std::size_t b = 0; b < curve.bands.size(); ++b) {
    const std::string data = "$band" + std::to_string(b) + " using " + std::to_string(x) + ":";
    const std::string colour = std::string("'") + kColours[b % std::size(kColours)] + "'";
    const std::string points =
        " pointtype " + std::to_string(kPoints[b / std::size(kColours) % std::size(kPoints)]) + " linecolor " + colour;
    const std::string title =
        over_time ? " title " + gnuplot_text(band_label(*curve.bands[b].rows.front().record)) : " notitle";
    command += b > 0 ? ", " : "";
    if (!too_many(curve)) {
      command += data + "3:4 with yerrorbars pointsize 0.6 linewidth 1.3" + points + title;
      if (over_time) command += ", " + data + "3 with lines linewidth 1 linecolor " + colour + " notitle";
    } else if (over_time) {
      command += data + "($3-$4):($3+$4) with filledcurves fillcolor " + colour +
                 " fillstyle transparent solid 0.3 noborder notitle, " + data + "3 with lines linewidth 1 linecolor " +
                 colour + title;
    } else {
      command += data + "3 with points pointsize 0.3" + points + title;
    }
  }
  return command;
}

/// Beside the data; short names stand close to it.
void legend(Plot& plot, const LightCurve& curve) {
  std::size_t longest = 0;
  for (const BandCurve& band : curve.bands) longest = std::max(longest, band_label(*band.rows.front().record).size());
  plot.legend_beside();
  if (longest <= 12) plot.line("set rmargin at screen 0.85; set key at screen 0.86, screen 0.91 left top width 1");
}

}  // namespace

void light_curve_picture(Writer& writer, const LightCurve& curve, const std::string& stem) {
  const Shown shown = shown_of(curve);
  const bool phases = phase_changes(curve);
  const std::string name = writer.add(stem, "png");
  Plot plot(name, 1200, phases ? 1100 : 750);
  double zero_s = 0.0;
  const std::string label = time_label(writer, curve, &zero_s);
  const double largest = put_data(plot, writer, curve, shown, zero_s);
  const std::string unit = shown == Shown::intensity ? " m²/sr" : " mag";
  legend(plot, curve);
  plot.line(phases ? "set multiplot" : "");
  plot.line("set title " + gnuplot_text(writer.title("spectrometer", curve.key) + ": light curve") + " font ',18'");
  plot.line("set label 1 " +
            gnuplot_text((too_many(curve) ? "shaded" : "bars") + std::string(": ± 1 standard error, at most ") +
                         rounded(largest, 2) + unit) +
            " at graph 0.01, graph 0.04 front font ',11' textcolor '#444444'");
  plot.line("set errorbars 0.7; set autoscale xfix; set offsets graph 0.01, graph 0.01, graph 0.05, graph 0.08");
  plot.line(shown == Shown::intensity ? "set ylabel 'A  (m² sr⁻¹)'"
                                      : std::string("set yrange [] reverse; set ylabel 'apparent ") +
                                            (shown == Shown::Vega ? "Vega" : "AB") + " magnitude (brighter is up)'");
  plot.line("set xlabel " + gnuplot_text(label));
  plot.line(phases ? "set tmargin at screen 0.945; set bmargin at screen 0.565" : "set tmargin at screen 0.92");
  plot.line(curves(curve, 1, true));
  if (phases) {
    plot.line("unset title; unset label 1; set xlabel 'phase angle (deg)'");
    plot.line("set tmargin at screen 0.465; set bmargin at screen 0.085");
    plot.line(curves(curve, 2, false));
    plot.line("unset multiplot");
  }
  writer.draw(plot, name);
}

}  // namespace clray::io
