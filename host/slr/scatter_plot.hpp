// SPDX-License-Identifier: Apache-2.0
// observations.png: delay against time, one dot a shot. Shots are gathered in a grid of pixels, so neither memory nor
// the plotting program's work grows with their number.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clray::slr {

class ScatterPlot {
 public:
  /// Axes: time in s, which reads `origin_s` at time 0, with its label; delay in ns.
  ScatterPlot(double start_s, double stop_s, double low_ns, double high_ns, double origin_s = 0.0,
              const std::string& time_label = "time (s)");

  void add(double time_s, double delay_ns, bool signal);

  /// Draws `folder`/`file`. Returns an empty text, or why there is no picture.
  std::string draw(const std::string& folder, const std::string& file, const std::string& title) const;

 private:
  std::vector<std::uint8_t> pixels() const;

  double start_s_, stop_s_, low_ns_, high_ns_, origin_s_;
  std::string time_label_;
  std::vector<std::uint32_t> signal_, noise_;
};

}  // namespace clray::slr
