// SPDX-License-Identifier: Apache-2.0
// Plots through gnuplot's standard input: one look for all of clray's pictures, of results, sessions and
// benchmarks alike; 1200 x 750 pixels unless told otherwise.
#pragma once

#include <string>
#include <string_view>

namespace clray::text {

/// Text as a gnuplot string literal, on one line, to be shown as it is.
std::string gnuplot_text(std::string_view text);

/// What to subtract from times for an axis, and the label of the axis. It is nothing, or the whole seconds of the first
/// time if labels of six digits would all read the same, as those of Unix seconds do.
struct TimeAxis {
  double zero_s = 0.0;
  std::string label;
};
TimeAxis time_axis(double first_s, double last_s);

/// A gnuplot script in the making.
class Plot {
 public:
  /// Sets terminal, fonts, grid and colours; `file` is a plain name inside the folder given to draw().
  explicit Plot(const std::string& file, int width = 1200, int height = 750);

  Plot& line(std::string_view text);                   ///< one command
  Plot& legend_beside();                               ///< a column right of the data, for any number of curves
  Plot& begin_data(const std::string& name);           ///< lines of numbers follow, as `$name` in plot commands
  Plot& point(std::initializer_list<double> numbers);  ///< a line of data; not-finite numbers become NaN
  Plot& end_data();

  /// Runs gnuplot in `folder`. Returns an empty text, or why there is no picture.
  std::string draw(const std::string& folder) const;

 private:
  std::string file_, script_;
};

}  // namespace clray::text
