// SPDX-License-Identifier: Apache-2.0
// Delay against time through gnuplot; see scatter_plot.hpp. The image goes through a temporary file in the result's
// folder.
#include "slr/scatter_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "text/gnuplot.hpp"
#include "text/output_file.hpp"

namespace clray::slr {

namespace {

// The plotting area of the picture, in its pixels: a cell of the grid is a pixel.
constexpr int kWidth = 1026, kHeight = 574;

text::Plot plot_of(const std::string& file, const std::string& image, const std::string& title,
                   const std::string& time_label, double start_s, double stop_s, double low_ns, double high_ns) {
  const double dx = (stop_s - start_s) / kWidth, dy = (high_ns - low_ns) / kHeight;
  text::Plot plot(file);
  plot.line("set tics nomirror out; unset grid; set tmargin at screen 0.88");
  plot.line("set xlabel '" + time_label + "'; set ylabel 'delay after a path by way of the reference point (ns)'");
  plot.line("set title " + text::gnuplot_text(title) + " font ',18'");
  plot.line(
      fmt::format("set xrange [{:.17g}:{:.17g}]; set yrange [{:.17g}:{:.17g}]", start_s, stop_s, low_ns, high_ns));
  plot.line(fmt::format(
      "plot '{}' binary array=({},{}) format='%uchar' dx={:.17g} dy={:.17g} origin=({:.17g},{:.17g}) using 1:2:3:4 "
      "with "
      "rgbalpha notitle, NaN with points pointtype 7 linecolor '#0b4f94' title 'signal', NaN with points pointtype 7 "
      "linecolor '#9a9a9a' title 'noise'",
      image, kWidth, kHeight, dx, dy, start_s + 0.5 * dx, low_ns + 0.5 * dy));
  return plot;
}

}  // namespace

ScatterPlot::ScatterPlot(double start_s, double stop_s, double low_ns, double high_ns, double origin_s,
                         const std::string& time_label)
    : start_s_(start_s),
      stop_s_(stop_s > start_s ? stop_s : start_s + 1.0),
      low_ns_(low_ns),
      high_ns_(high_ns),
      origin_s_(origin_s),
      time_label_(time_label),
      signal_(static_cast<std::size_t>(kWidth) * kHeight),
      noise_(signal_.size()) {}

void ScatterPlot::add(double time_s, double delay_ns, bool signal) {
  const double x = std::floor((time_s - start_s_) / (stop_s_ - start_s_) * kWidth);
  const double y = std::floor((delay_ns - low_ns_) / (high_ns_ - low_ns_) * kHeight);
  if (!(x >= 0.0 && x < kWidth && y >= 0.0 && y < kHeight)) return;
  const std::size_t cell = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
  std::uint32_t& count = (signal ? signal_ : noise_)[cell];
  if (count != UINT32_MAX) ++count;
}

std::vector<std::uint8_t> ScatterPlot::pixels() const {
  std::vector<std::uint8_t> rgba(4 * signal_.size());
  // Single pixels are hard to see. If there are few dots, each becomes a plus sign of five pixels.
  std::uint64_t filled = 0;
  for (std::size_t i = 0; i < signal_.size(); ++i) filled += signal_[i] + noise_[i] > 0;
  const bool large = filled < 40000;
  const auto paint = [&](long x, long y, const std::uint8_t(&colour)[3], std::uint32_t count) {
    if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) return;
    std::uint8_t* p = rgba.data() + 4 * (y * kWidth + x);
    std::copy(colour, colour + 3, p);
    p[3] = static_cast<std::uint8_t>(255.0 * (1.0 - std::pow(0.35, count)));
  };
  const std::uint8_t grey[3] = {0x9a, 0x9a, 0x9a}, blue[3] = {0x0b, 0x4f, 0x94};
  for (const bool signal : {false, true}) {
    for (long y = 0; y < kHeight; ++y) {
      for (long x = 0; x < kWidth; ++x) {
        const std::uint32_t count = (signal ? signal_ : noise_)[static_cast<std::size_t>(y * kWidth + x)];
        if (count == 0) continue;
        const auto& colour = signal ? blue : grey;
        paint(x, y, colour, count + (large ? 2 : 0));
        if (!large) continue;
        for (const long step : {-1L, 1L}) {
          paint(x + step, y, colour, count);
          paint(x, y + step, colour, count);
        }
      }
    }
  }
  return rgba;
}

std::string ScatterPlot::draw(const std::string& folder, const std::string& file, const std::string& title) const {
  const std::string image = file + ".rgba", directory = folder.empty() ? "." : folder;
  const auto rgba = pixels();
  text::write_output_file(directory + "/" + image, {reinterpret_cast<const char*>(rgba.data()), rgba.size()});
  std::string fault =
      plot_of(file, image, title, time_label_, origin_s_ + start_s_, origin_s_ + stop_s_, low_ns_, high_ns_)
          .draw(directory);
  text::discard_output_file(directory + "/" + image);
  return fault;
}

}  // namespace clray::slr
