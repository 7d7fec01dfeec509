// SPDX-License-Identifier: Apache-2.0
// clray-bench method: whether `method = "auto"` takes the quickest way to a target. Bodies, ways of looking and targets
// are combined; every method runs each in turn, and what auto takes is held against the best. A run's time is processor
// time, which other work on the machine changes least, from the scene to the result; programs are built before, in a
// run that does not count. Writes method.md.
// Exit 1 where auto is more than kBar times slower than the best.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>

#include "bench.hpp"
#include "clray/error.hpp"
#include "end_bodies.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

namespace {

using namespace clray_test;
using clray::Method;
using clray::Vec3;

constexpr double kBar = 1.5;
constexpr double kSmall = 0.002;   // s: below it no user feels a factor
constexpr double kPatience = 3.0;  // times the best so far; then a method is cut off, by the clock on the wall
constexpr double kShortest = 0.1;  // s: but not before
constexpr int kRuns = 5;
constexpr double kTargets[] = {1.0, 0.1, 0.01};  // %

const std::map<Method, const char*> kNames = {
    {Method::exact, "exact"}, {Method::tiles, "tiles"}, {Method::points, "points"}, {Method::automatic, "auto"}};

/// Triangles in disorder: each hides some and is hidden by others.
MeshPtr soup(int count, double size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  auto mesh = std::make_shared<clray::Mesh>();
  for (int k = 0; k < count; ++k) {
    const Vec3 centre(any(random), any(random), any(random));
    for (std::uint32_t corner = 0; corner < 3; ++corner)
      mesh->vertices.push_back(centre + size * Vec3(any(random), any(random), any(random)));
    const auto first = static_cast<std::uint32_t>(3 * k);
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangle_slot.push_back(0);
  }
  mesh->material_slots = {""};
  return mesh;
}

struct Look {
  std::string name;
  void (*set)(clray::Scene&);
};

const Look kLooks[] = {
    {"one pulse", [](clray::Scene& s) { monostatic(s, toward(radians(35), 0.4)); }},
    {"20 turns",
     [](clray::Scene& s) {
       monostatic(s, toward(radians(35), 0.4));
       s.motion.emplace();
       s.motion->axis = {0.48, 0.8, 0.36};
       s.motion->period_s = 360.0;
       s.motion->step_rad = radians(18.0);
       s.motion->stop_s = 359.0;
     }},
    {"bistatic", [](clray::Scene& s) { bistatic(s, toward(radians(35), 0.4), toward(radians(60), 1.0)); }},
};

struct Case {
  std::string body, look;
  std::size_t faces = 0;
  double target = 0.0;
  clray::Scene scene;
  std::map<Method, std::vector<double>> seconds;  // empty: not possible
  std::map<Method, bool> cut;                     // it did not reach the target in time
  Method taken = Method::automatic;
};

/// The method that found a result's numbers.
Method found_by(const clray::Result& result) {
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  return a.exact() ? Method::exact : a.tiles ? Method::tiles : Method::points;
}

/// One run; false where the method is not for this scene.
bool take(Case* c, Method method, double limit_s) {
  clray::Scene scene = c->scene;
  scene.trace.method = method;
  scene.trace.rays = 0;
  scene.trace.target_error_percent = c->target;
  if (method != Method::exact) scene.trace.time_limit_s = limit_s;
  try {
    const std::clock_t start = std::clock();
    const clray::Result r = run(scene);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (method == Method::automatic) c->taken = found_by(r);
    if (method != Method::automatic) {
      c->seconds[method].push_back(seconds);
      c->cut[method] = c->cut[method] || !r.target_reached;
    }
  } catch (const clray::Error& e) {
    if (method == Method::automatic || e.code() != clray::ErrorCode::input) throw;
    return false;  // not for this scene
  }
  return true;
}

void measure(Case* c) {
  for (const Method method : {Method::exact, Method::tiles, Method::points}) {
    double best = 60.0;
    for (const auto& [other, seconds] : c->seconds)
      if (!seconds.empty() && !c->cut[other]) best = std::min(best, seconds.front());
    if (!take(c, method, std::max(kShortest, kPatience * best))) continue;  // the first run compiles
    c->seconds[method].clear();
    take(c, method, std::max(kShortest, kPatience * best));
  }
  for (int k = 1; k < kRuns; ++k) {
    for (auto& [method, seconds] : c->seconds) {
      if (!c->cut[method]) take(c, method, 0.0);
    }
  }
  take(c, Method::automatic, 0.0);
}

std::vector<std::string> row_of(Case* c, double* ratio) {
  double best = HUGE_VAL;
  for (const auto& [method, seconds] : c->seconds)
    if (!c->cut[method]) best = std::min(best, median(seconds));
  const double taken = c->cut[c->taken] ? HUGE_VAL : median(c->seconds.at(c->taken));
  *ratio = std::max(taken, kSmall) / std::max(best, kSmall);
  const auto text = [&](Method method) -> std::string {
    if (c->seconds.count(method) == 0) return "–";
    if (c->cut[method]) return fmt::format("> {:.2g} s", median(c->seconds[method]));
    return fmt::format("{:.2g} s", median(c->seconds[method]));
  };
  return {c->body,
          std::to_string(c->faces),
          c->look,
          fmt::format("{:g} %", c->target),
          text(Method::exact),
          text(Method::tiles),
          text(Method::points),
          kNames.at(c->taken),
          fmt::format("{:.2f}", *ratio)};
}

}  // namespace

int method(const Options& options) {
  std::vector<EndBody> bodies = end_bodies(options);
  bodies.insert(bodies.begin() + 1, {{"sphere", [] { return sphere_mesh(64, 32, 1.0); }},
                                     {"fine sphere", [] { return sphere_mesh(256, 128, 1.0); }},
                                     {"soup", [] { return soup(300, 0.6); }},
                                     {"large soup", [] { return soup(20000, 0.08); }}});
  std::vector<std::vector<std::string>> rows = {
      {"body", "faces", "look", "target", "exact", "tiles", "points", "auto takes", "over the best"}};
  double worst = 0.0;
  for (const EndBody& body : bodies) {
    if (!wanted(options, body.name)) continue;
    const MeshPtr mesh = body.mesh();
    for (const Look& look : kLooks) {
      if (mesh->triangles.size() > 50000 && look.name != kLooks[0].name) continue;  // minutes
      for (const double target : kTargets) {
        if (options.quick && target != kTargets[1]) continue;
        Case c{body.name, look.name, mesh->triangles.size(), target, scene_of(mesh, lambert(0.5)), {}, {}, {}};
        look.set(c.scene);
        measure(&c);
        double ratio = 0.0;
        rows.push_back(row_of(&c, &ratio));
        worst = std::max(worst, ratio);
        fmt::print("{}\n", fmt::join(rows.back(), " | "));
        std::fflush(stdout);
      }
    }
  }
  if (rows.size() == 1) return 2;
  write_text(options.out, options.quick || !options.only.empty() ? "method-short.md" : "method.md",
             fmt::format("# What auto takes\n\nWritten by `clray-bench method` on {}. Medians of {} runs in turn, of "
                         "processor time until the\ntarget is confirmed. >: cut off at {:g} times the "
                         "best. Times below {:g} ms count as that.\n\n{}",
                         device_line(), kRuns, kPatience, 1e3 * kSmall, markdown(rows)));
  fmt::print("auto takes at most {:.2f} times the best\n", worst);
  return worst > kBar ? 1 : 0;
}

}  // namespace clray_bench
