// SPDX-License-Identifier: Apache-2.0
// Histograms at their limits: singular pulses, bin edges on a plate, bins from femtoseconds to one for all, and
// windows that see nothing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;

namespace {

double sum_of(const clray::DelayResult& d) {
  return std::accumulate(d.bin_m2_per_sr.begin(), d.bin_m2_per_sr.end(), 0.0);
}

Outcome singular() {
  Scene scene = scene_of("cylinder", {{"radius", 1.0}, {"height", 3.0}, {"capped", 1.0}}, lambert(0.5));
  monostatic(scene, {1, 0, 0});
  const double front = -2.0 / kLightSpeed;
  window(scene, front, 0.0, 1000);
  const clray::Result result = run(rays(scene, 20));
  const clray::DelayResult& d = result.delay.at(0);
  const Pulse exact = lambert_cylinder_side(0.5, 1.0, 3.0);
  const double expected = exact.total_m2_per_sr * exact.share(front + d.bin_width_s);
  // The very front (u exactly at the axis) may fall one rounding before the window.
  return near(d.bin_m2_per_sr.at(0) + d.below_m2_per_sr, d.bin_standard_error.at(0), expected, 1e-3);
}

Outcome on_edge() {
  Outcome outcome{true, ""};
  for (const bool middle : {false, true}) {
    Scene scene = scene_of(plate_mesh(1, 1), lambert(1.0));
    const double half = 1e-9;
    window(scene, middle ? -1.5 * half : -half, middle ? 1.5 * half : half, middle ? 3 : 2);
    const clray::Result result = run(rays(scene, 14));
    const clray::DelayResult& d = result.delay.at(0);
    const double total = d.intensity_m2_per_sr.value;
    const auto filled = std::count_if(d.bin_m2_per_sr.begin(), d.bin_m2_per_sr.end(), [](double b) { return b > 0.0; });
    const bool kept = std::fabs(sum_of(d) - total) <= 1e-15 * total;
    const bool good = kept && filled == 1 && (!middle || d.bin_m2_per_sr[1] > 0.0);
    outcome.pass = outcome.pass && good;
    outcome.measured += fmt::format("{}{}: {} bins filled", middle ? "; " : "", middle ? "middle" : "edge", filled);
  }
  return outcome;
}

Outcome bins_of(int bins, double width_s) {
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  const double first = -2.0 / kLightSpeed - 1e-10;
  if (width_s > 0.0) {
    detect(scene, "delay",
           {{"start_ns", first * 1e9}, {"stop_ns", (first + bins * width_s) * 1e9}, {"bins", 1.0 * bins}});
  } else {
    window(scene, first, 1e-10, bins);
  }
  const clray::Result result = run(rays(scene, 18));
  const clray::DelayResult& d = result.delay.at(0);
  const double total = d.intensity_m2_per_sr.value, all = sum_of(d) + d.below_m2_per_sr + d.above_m2_per_sr;
  Outcome outcome;
  outcome.measured = fmt::format("{} bins of {:.3g} s, sum off by {:.1e}", d.bin_m2_per_sr.size(), d.bin_width_s,
                                 std::fabs(all - total) / total);
  outcome.pass = std::fabs(all - total) <= 1e-12 * total && d.bin_m2_per_sr.size() == static_cast<std::size_t>(bins) &&
                 sound(result, &outcome.measured);
  return outcome;
}

Outcome outside() {
  Outcome outcome{true, ""};
  for (const bool late : {false, true}) {
    Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
    window(scene, late ? 1e-6 : -1e-6, late ? 2e-6 : -5e-7, 64);
    const clray::Result result = run(rays(scene, 16));
    const clray::DelayResult& d = result.delay.at(0);
    const double total = d.intensity_m2_per_sr.value, kept = late ? d.below_m2_per_sr : d.above_m2_per_sr;
    outcome.pass = outcome.pass && sum_of(d) == 0.0 && std::fabs(kept - total) <= 1e-15 * total && total > 0.3;
    outcome.measured += fmt::format("{}{}: {:.6g} of {:.6g}", late ? "; " : "", late ? "below" : "above", kept, total);
  }
  return outcome;
}

}  // namespace

std::vector<Case> bin_cases() {
  return {
      {"bins", "cylinder side-on: the singular first bin of 1000", "the CDF's share",
       "4 standard errors + 1e-3: two hits per replicate", true, singular},
      {"bins", "a plate on a bin's edge and in its middle", "all light in one bin, none lost", "exact", true, on_edge},
      {"bins", "10⁴ bins of 1 fs", "bins, below and above add up to the total", "1e-12: rounding of 10⁴ additions",
       true, [] { return bins_of(10000, 1e-15); }},
      {"bins", "one bin", "bins, below and above add up to the total", "1e-12", true, [] { return bins_of(1, 0.0); }},
      {"bins", "10⁶ bins", "bins, below and above add up to the total", "1e-12: pairwise errors of 10⁶ additions", true,
       [] { return bins_of(1000000, 0.0); }},
      {"bins", "everything outside the window", "kept in below and above", "1e-15", true, outside},
  };
}

}  // namespace clray_test
