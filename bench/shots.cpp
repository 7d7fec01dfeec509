// SPDX-License-Identifier: Apache-2.0
// clray-bench shots: first-photon shots per second of CPU time, on the device (kernels/slr/shots.cl) and on the host,
// over a gate of 512 bins, median of five. To be 10⁷ a second per core. Writes shots.md.
#include "device/shots.hpp"

#include <fmt/format.h>

#include <ctime>

#include "bench.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

int shots(const Options& options) {
  const std::uint32_t count = options.quick ? 1u << 20 : 1u << 23;
  std::vector<std::vector<std::string>> rows = {{"photons a shot", "shots", "CPU time, s", "10⁶ shots per s and core"}};
  bool reached = true;
  for (const double photons : {0.01, 1.0, 100.0}) {
    std::vector<double> gate;  // (time, signal so far): the pulse of a sphere, 512 bins in the middle of 100 ns
    for (int b = 0; b <= 512; ++b) {
      const double x = b / 512.0;
      gate.push_back(45.0 + 10.0 * x);
      gate.push_back(photons * x * (2.0 - x));
    }
    gate.insert(gate.begin(), {0.0, 0.0});
    gate.insert(gate.end(), {100.0, photons});
    const std::vector<double> one{1.0};
    std::vector<double> seconds, time_ns;
    std::vector<std::uint32_t> kind;
    for (int run = 0; run < 6; ++run) {
      const std::clock_t begin = std::clock();
      clray::sample_shots_on(clray_test::device(), {gate, one, 0.001, 0.0, 1, 0, count}, &time_ns, &kind);
      if (run > 0) seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    const double rate = count / median(seconds);
    reached = reached && rate >= 1e7;
    rows.push_back({fmt::format("{:g}", photons), std::to_string(count), fmt::format("{:.3f}", median(seconds)),
                    fmt::format("{:.1f}", 1e-6 * rate)});
  }
  const std::string text = "# Shots per second\n\nMade by `clray-bench shots` on " + device_line() +
                           ". CPU time, transfers included; of a GPU it is the host's share.\n\n" + markdown(rows);
  fmt::print("{}", text);
  write_text(options.out, "shots.md", text);
  return reached ? 0 : 1;
}

}  // namespace clray_bench
