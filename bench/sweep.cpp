// SPDX-License-Identifier: Apache-2.0
// clray-bench sweep: orientations of a pass traced together: 1 to 91 of the cylinder, 512 bins, 1 % on each total;
// cost must grow linearly. Writes sweep.md.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "bench.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

using namespace clray_test;

int sweep(const Options& options) {
  std::vector<std::vector<std::string>> rows = {
      {"orientations", "rays each", "trace, s", "total, s", "ms per orientation", "largest error", "target reached"}};
  bool reached = true;
  for (int steps : {1, 7, 31, 91}) {
    clray::Scene scene = scene_of(prism_mesh(128, 1.0, 3.0), ashikhmin_shirley(0.5, 0.2, 50));
    scene.motion.emplace();
    scene.motion->axis = {0, 1, 0};
    scene.motion->period_s = 360.0;
    scene.motion->step_rad = radians(1.0);
    scene.motion->stop_s = steps - 0.5;
    scene.trace.rays = 0;
    scene.trace.target_error_percent = 1.0;
    const clray::Result r = run(scene);
    double worst = 0.0;
    for (const clray::DelayResult& d : r.delay) {
      const clray::Estimate& a = d.intensity_m2_per_sr;
      worst = std::max(worst, 0.5 * (a.high - a.low) / a.value);
    }
    reached = reached && r.target_reached && static_cast<int>(r.delay.size()) == steps;
    rows.push_back({std::to_string(r.delay.size()), std::to_string(r.rays), fmt::format("{:.3f}", r.seconds.trace),
                    fmt::format("{:.3f}", r.seconds.total), fmt::format("{:.2f}", 1e3 * r.seconds.trace / steps),
                    fmt::format("{:.2f} %", 100.0 * worst), r.target_reached ? "yes" : "no"});
    fmt::print("{} orientations: {} s\n", steps, rows.back()[3]);
    std::fflush(stdout);
  }
  write_text(
      options.out, "sweep.md",
      fmt::format("# Cost of orientations\n\nWritten by `clray-bench sweep` on {}: the cylinder, 512 bins, 1 % on each "
                  "total.\n\n{}",
                  device_line(), markdown(rows)));
  return reached ? 0 : 1;
}

}  // namespace clray_bench
