// SPDX-License-Identifier: Apache-2.0
// clray-bench rays: speed of beams, shadow rays and bounces over four bodies, by each walk and by a tracer on Embree,
// in turn. Sobol points on the rectangle, so that the share of rays that hit is the same for all. Writes rays.md.
#include "rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

#include "bench.hpp"
#include "body/bvh.hpp"
#include "clray/trace.hpp"
#include "end_bodies.hpp"
#include "end_methods.hpp"

namespace clray_bench {

using namespace clray_test;

namespace {

constexpr int kRounds = 5;
const PathViews kViews{toward(0.6 * kPi, 1.3 * kPi), toward(0.75 * kPi, 1.1 * kPi)};

struct Kind {
  const char* name;
  PathKind kind;
};
constexpr Kind kKinds[] = {{"beam", PathKind::beam}, {"bistatic", PathKind::bistatic}, {"bounces", PathKind::bounces}};

/// Something that traces 2^log2_paths paths of a kind.
struct Rival {
  std::string name;
  std::function<PathRun(int log2_paths)> run;
};

clray::Scene scene_for(const MeshPtr& mesh, PathKind kind, const char* walk) {
  clray::Scene scene = scene_of(mesh, lambert(0.5));
  kind == PathKind::bistatic ? bistatic(scene, kViews.light, kViews.observer) : monostatic(scene, kViews.light);
  scene.trace.max_bounces = kind == PathKind::bounces ? 4 : 1;
  scene.trace.method = clray::Method::points;
  scene.trace.sampler = clray::SamplerKind::sobol;
  scene.trace.walk = walk;
  return scene;
}

std::vector<Rival> rivals_of(const MeshPtr& mesh, PathKind kind, std::vector<std::uint64_t>* digests) {
  std::vector<Rival> rivals;
  for (const char* walk : {"plain", "packet"}) {
    rivals.push_back({walk, [mesh, kind, walk, digests](int log2_paths) {
                        clray::Scene scene = scene_for(mesh, kind, walk);
                        const clray::Result r = run(clray_test::rays(scene, log2_paths));
                        digests->push_back(r.digest);
                        PathRun out{r.seconds.trace, r.rays, 0, 0};
                        for (const std::uint64_t hits : r.delay.at(0).hits) out.hits += hits;
                        return out;
                      }});
  }
  for (const bool robust : {true, false}) {
    const std::shared_ptr<PathRival> rival = path_rival(*mesh, kViews, robust, device().info().compute_units);
    if (!rival) continue;
    for (const bool single : {false, true}) {
      if (kind == PathKind::bounces && !single) continue;
      rivals.push_back({fmt::format("Embree {}, {}", robust ? "robust" : "fast", single ? "single" : "packets"),
                        [rival, kind, single](int log2_paths) { return rival->run(kind, single, log2_paths); }});
    }
  }
  return rivals;
}

/// Rows of one body and kind: a line for each rival. Paths grow until the first takes half a second.
void measure(const std::string& body, const Kind& kind, const MeshPtr& mesh, bool quick,
             std::vector<std::vector<std::string>>* rows, bool* equal) {
  std::vector<std::uint64_t> digests;
  const std::vector<Rival> rivals = rivals_of(mesh, kind.kind, &digests);
  int log2_paths = quick ? 12 : 16;
  while (!quick && log2_paths < 24 && rivals[0].run(log2_paths).seconds < 0.5) ++log2_paths;
  std::vector<std::vector<double>> speed(rivals.size());
  std::vector<PathRun> last(rivals.size());
  digests.clear();
  for (int round = 0; round <= (quick ? 1 : kRounds); ++round) {
    for (std::size_t k = 0; k < rivals.size(); ++k) {
      last[k] = rivals[k].run(log2_paths);
      // The first round builds programs.
      if (round > 0) speed[k].push_back(1e-6 * static_cast<double>(last[k].paths) / last[k].seconds);
    }
  }
  *equal = *equal && std::all_of(digests.begin(), digests.end(), [&](auto d) { return d == digests.front(); });
  for (std::size_t k = 0; k < rivals.size(); ++k) {
    const auto paths = static_cast<double>(last[k].paths);
    const bool counts = last[k].rays != 0;
    rows->push_back({body, kind.name, rivals[k].name, fmt::format("2^{}", log2_paths),
                     fmt::format("{:.2f}", median(speed[k])),
                     fmt::format("{:.2f}", median(speed[k]) / median(speed[0])),
                     counts ? fmt::format("{:.2f}", static_cast<double>(last[k].rays) / paths) : "-",
                     counts ? fmt::format("{:.1f} %", 100.0 * static_cast<double>(last[k].hits) / paths) : "-"});
    fmt::print("{}, {}, {}: {} million paths/s\n", body, kind.name, rivals[k].name, rows->back()[4]);
    std::fflush(stdout);
  }
}

/// A row of trees: built in turn. What clray prepares besides are primitives in canonical order, views and a plan.
std::vector<std::string> tree_row(const std::string& body, const MeshPtr& mesh) {
  const auto box_of = [&](std::size_t t) {
    clray::Box box;
    for (const std::uint32_t corner : mesh->triangles[t]) {
      const clray::Vec3& p = mesh->vertices[corner];
      box.add(std::array<double, 3>{{p.x, p.y, p.z}});
    }
    return box;
  };
  std::vector<double> own, rival, prepared;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    clray::build_bvh(mesh->triangles.size(), box_of);
    own.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    const std::unique_ptr<PathRival> embree = path_rival(*mesh, kViews, false, 1);
    if (embree) rival.push_back(embree->build_s());
    clray::Scene scene = scene_for(mesh, PathKind::beam, "plain");
    prepared.push_back(run(clray_test::rays(scene, 8)).seconds.bvh);
  }
  const bool embree = !rival.empty();
  return {body,
          std::to_string(mesh->triangles.size()),
          fmt::format("{:.4f}", median(own)),
          embree ? fmt::format("{:.4f}", median(rival)) : "-",
          embree ? fmt::format("{:.2f}", median(own) / median(rival)) : "-",
          fmt::format("{:.4f}", median(prepared))};
}

}  // namespace

int ray_speed(const Options& options) {
  std::vector<std::vector<std::string>> rows = {
      {"body", "paths", "by", "paths in all", "million paths/s", "times plain", "rays per path", "hits"}};
  std::vector<std::vector<std::string>> trees = {
      {"body", "triangles", "tree, s", "Embree's, s", "times Embree's", "all that is prepared, s"}};
  bool equal = true;
  for (const EndBody& body : end_bodies(options)) {
    if (!wanted(options, body.name)) continue;
    const MeshPtr mesh = body.mesh();
    trees.push_back(tree_row(body.name, mesh));
    for (const Kind& kind : kKinds) measure(body.name, kind, mesh, options.quick, &rows, &equal);
  }
  write_text(
      options.out, options.quick ? "rays-short.md" : "rays.md",
      fmt::format("# Speed of rays\n\nWritten by `clray-bench rays` on {}, {}: medians of {} runs in turn.\n\n{}\n{}",
                  device_line(), embree_line(), kRounds, markdown(rows), markdown(trees)));
  if (!equal) fmt::print("digests DIFFER between walks\n");
  return equal ? 0 : 1;
}

}  // namespace clray_bench
