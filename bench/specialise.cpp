// SPDX-License-Identifier: Apache-2.0
// clray-bench specialise: what leaving out buys. Ten scenes, generic against specialised program: time, size, equal
// digests; and twelve variants of a material against one. Writes specialise.md.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "bench.hpp"
#include "clray/trace.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

using namespace clray_test;

namespace {

struct Named {
  std::string name;
  clray::Scene scene;
};

std::vector<Named> scenes() {
  std::vector<Named> all;
  const auto tilted = [](clray::Scene scene) { return monostatic(scene, toward(0.7, 0.4)); };
  clray::Scene box_wing = scene_of(box_mesh(1, 1, 2), lambert(0.5));
  for (double side : {-1.0, 1.0})
    add(box_wing, moved(plate_mesh(3, 1), {2.2 * side, 0, 0.1}), ashikhmin_shirley(0.5, 0.2, 50));
  clray::Scene rich = box_wing;
  add(rich, "paraboloid", {{"radius", 0.6}, {"depth", 0.2}}, lambert(0.8)).transform.translate = {0, 0, 1.5};
  add(rich, "cylinder", {{"radius", 0.05}, {"height", 2.0}}, mirror(0.9)).transform.translate = {0, 0, -2};
  all.push_back({"plate", tilted(scene_of(plate_mesh(2, 1), lambert(0.5)))});
  all.push_back({"sphere", scene_of("sphere", {}, lambert(0.5))});
  all.push_back({"box-wing", tilted(box_wing)});
  all.push_back({"sphere of 20,000 triangles", tilted(scene_of(sphere_mesh(140, 72, 1), lambert(0.5)))});
  all.push_back({"A-S sphere", scene_of("sphere", {}, ashikhmin_shirley(0.5, 0.2, 50))});
  all.push_back({"cylinder", tilted(scene_of("cylinder", {}, lambert(0.5)))});
  all.push_back({"rich body", tilted(rich)});
  rich.trace.max_bounces = 8;
  all.push_back({"rich body, 8 bounces", tilted(rich)});
  clray::Scene phase = box_wing;
  all.push_back({"box-wing, bistatic", bistatic(phase, toward(0.7, 0.4), toward(1.2, -0.3))});
  clray::Scene pushed = scene_of("sphere", {}, lambert(0.5));
  all.push_back({"pressure on a sphere", detect(pushed, "pressure")});
  return all;
}

struct Timing {
  double seconds = 1e300;
  std::uint64_t digest = 0;
};

/// Best of some runs: what is left is the program, not the machine's other work.
Timing best_of(clray::Scene scene, bool specialise, int log2_rays) {
  scene.trace.specialise = specialise;
  rays(scene, log2_rays);
  Timing best;
  for (int i = 0; i < 5; ++i) {
    const clray::Result r = run(scene);
    best.seconds = std::min(best.seconds, r.seconds.trace);
    best.digest = r.digest;
  }
  return best;
}

std::size_t source_bytes(clray::Scene scene, bool specialise) {
  scene.trace.specialise = specialise;
  return clray::kernel_source(scene, device()).size();
}

std::string variants_line(int log2_rays) {
  clray::Scene one = scene_of(sphere_mesh(140, 72, 1), ashikhmin_shirley(0.5, 0.2, 50)), twelve = one;
  for (int i = 0; i < 12; ++i) {
    clray::Material m = twelve.materials[0];
    m.parameters["n"] = 10.0 * (i + 1);
    twelve.variants.push_back({fmt::format("n = {}", 10 * (i + 1)), {m}});
  }
  const double a = best_of(one, true, log2_rays).seconds, b = best_of(twelve, true, log2_rays).seconds;
  return fmt::format("Twelve variants of a material: {:.3f} s, one: {:.3f} s, ratio {:.2f} (to be 2.5 at most).\n", b,
                     a, b / a);
}

}  // namespace

int specialise(const Options& options) {
  const int log2_rays = options.quick ? 16 : 21;
  std::vector<std::vector<std::string>> rows = {
      {"scene", "generic, s", "specialised, s", "times faster", "source, KiB: generic", "specialised", "digests"}};
  int different = 0;
  for (const Named& s : scenes()) {
    if (!wanted(options, s.name)) continue;
    const Timing generic = best_of(s.scene, false, log2_rays), special = best_of(s.scene, true, log2_rays);
    different += generic.digest != special.digest;
    rows.push_back({s.name, fmt::format("{:.3f}", generic.seconds), fmt::format("{:.3f}", special.seconds),
                    fmt::format("{:.2f}", generic.seconds / special.seconds),
                    fmt::format("{:.0f}", source_bytes(s.scene, false) / 1024.0),
                    fmt::format("{:.0f}", source_bytes(s.scene, true) / 1024.0),
                    generic.digest == special.digest ? "equal" : "**DIFFERENT**"});
    fmt::print("{}: {} s generic, {} s specialised, {} times\n", s.name, rows.back()[1], rows.back()[2],
               rows.back()[3]);
    std::fflush(stdout);
  }
  const std::string variants = variants_line(log2_rays);
  fmt::print("{}", variants);
  write_text(
      options.out, options.quick ? "specialise-short.md" : "specialise.md",
      fmt::format("# What leaving out buys\n\nWritten by `clray-bench specialise` on {}: 2^{} rays, best of 5 runs.\n\n"
                  "{}\n{}",
                  device_line(), log2_rays, markdown(rows), variants));
  return different == 0 ? 0 : 1;
}

}  // namespace clray_bench
