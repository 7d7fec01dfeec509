// SPDX-License-Identifier: Apache-2.0
// clray-bench scaling: how time and memory grow with triangles, rays, threads, orientations, bins, variants, bands and
// observers, one at a time, with fitted exponents. Each run is a process of its own, so that its peak of memory is its
// own; times are of its second trace, when programs are built. Writes scaling.md, scaling.csv and scaling.png.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <thread>

#include "bench.hpp"
#include "clray/trace.hpp"
#include "end_methods.hpp"
#include "rays.hpp"
#include "text/gnuplot.hpp"

namespace clray_bench {

using namespace clray_test;

namespace {

constexpr double kSmall = 1e5;  // sizes up to which a run is cheap
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What one run took, s and MB. NaN: not measured.
struct Cost {
  double load = kNone, prepare = kNone, trace = kNone, total = kNone, memory = kNone, rival = kNone,
         rival_memory = kNone;
};

/// Something that grows.
struct Axis {
  const char* name;
  const char* what;
  std::vector<double> sizes, short_sizes;
  std::function<Cost(double size, bool quick)> run;
};

/// What `run` gives in a process of its own, and that process's peak of memory in MB.
template <class Run>
Cost apart(const Run& run) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("scaling: no pipe");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("scaling: no process");
  if (child == 0) {
    Cost cost;
    bool done = false;
    try {
      cost = run();
      done = write(ends[1], &cost, sizeof cost) == static_cast<ssize_t>(sizeof cost);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "clray-bench: scaling: %s\n", e.what());
    }
    _exit(done ? 0 : 1);
  }
  close(ends[1]);
  Cost cost;
  const bool read_all = read(ends[0], &cost, sizeof cost) == static_cast<ssize_t>(sizeof cost);
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!read_all || status != 0) throw std::runtime_error("scaling: a run failed");
  cost.memory = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return cost;
}

clray::Scene ball(std::size_t triangles) {
  const int stacks = std::max(3, static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / 4.0))));
  return scene_of(sphere_mesh(2 * stacks, stacks, 1.0), lambert(0.5));
}

Cost cost_of(clray::Scene scene, int log2_rays) {
  scene.trace.method = clray::Method::points;
  run(clray_test::rays(scene, 8));  // builds programs
  const clray::Result r = run(clray_test::rays(scene, log2_rays));
  Cost cost;
  cost.prepare = r.seconds.bvh;
  cost.trace = r.seconds.trace;
  cost.total = r.seconds.total;
  return cost;
}

/// A file of a ball's mesh, binary PLY of fp32 vertices.
std::string write_ball(double triangles) {
  const clray::Scene scene = ball(static_cast<std::size_t>(triangles));
  const clray::Mesh& mesh = *scene.components[0].mesh;
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("clray-scaling-{}.ply", getpid())).string();
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const clray::Vec3& v : mesh.vertices) {
    const float p[3] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    out.write(reinterpret_cast<const char*>(p), sizeof p);
  }
  for (const auto& t : mesh.triangles) {
    const std::uint32_t corners[3] = {t[0], t[1], t[2]};
    out.put(3).write(reinterpret_cast<const char*>(corners), sizeof corners);
  }
  if (!out.flush()) throw std::runtime_error("scaling: cannot write " + path);
  return path;
}

Cost triangles(double size, bool quick) {
  const std::string path = write_ball(size);
  const Cost rival = apart([&] {
    Cost cost;
    const std::shared_ptr<const clray::Mesh> mesh = clray::load_mesh(path);
    const auto tree = path_rival(*mesh, {{0, 0, 1}, {0, 1, 0}}, false, std::thread::hardware_concurrency());
    if (tree) cost.rival = tree->build_s();
    return cost;
  });
  const auto start = std::chrono::steady_clock::now();
  const MeshPtr mesh = clray::load_mesh(path);
  const double load = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::filesystem::remove(path);
  Cost cost = cost_of(scene_of(mesh, lambert(0.5)), quick ? 12 : 20);
  cost.load = load;
  cost.rival = rival.rival;
  cost.rival_memory = std::isnan(rival.rival) ? kNone : rival.memory;
  return cost;
}

Cost threads(double size, bool quick) {
  setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(static_cast<int>(size)).c_str(), 1);
  return cost_of(ball(20000), quick ? 12 : 22);
}

Cost orientations(double size, bool quick) {
  clray::Scene scene = ball(2000);
  scene.motion.emplace();
  scene.motion->axis = {0, 1, 0};
  scene.motion->period_s = 1024.0;
  scene.motion->step_rad = 2.0 * kPi / 1024.0;
  scene.motion->stop_s = size - 0.5;
  return cost_of(scene, quick ? 8 : 14);
}

Cost bins(double size, bool quick) {
  clray::Scene scene = ball(2000);
  return cost_of(detect(scene, "delay", {{"bins", size}}), quick ? 12 : 20);
}

Cost variants(double size, bool quick) {
  clray::Scene scene = ball(2000);
  for (int k = 0; k < static_cast<int>(size); ++k) {
    clray::Material m = scene.materials[0];
    m.parameters["rho"] = 0.9 * (k + 1) / size;
    scene.variants.push_back({fmt::format("rho {}", k), {m}});
  }
  return cost_of(scene, quick ? 12 : 20);
}

Cost bands(double size, bool quick) {
  clray::Scene scene = ball(2000);
  scene.source.kind = clray::Source::Kind::sun;
  for (int k = 0; k < static_cast<int>(size); ++k)
    scene.source.bands.push_back({fmt::format("band {}", k), 400.0 + 300.0 * k / size, 400.0 + 300.0 * (k + 1) / size});
  return cost_of(scene, quick ? 12 : 20);
}

Cost observers(double size, bool quick) {
  clray::Scene scene = ball(2000);
  scene.observers.clear();
  for (int k = 0; k < static_cast<int>(size); ++k) {
    clray::Observer observer;
    observer.name = fmt::format("observer {}", k);
    observer.monostatic = false;
    observer.direction = toward(0.1 + 1.4 * (k + 0.5) / size, 0.3 * k);
    scene.observers.push_back(observer);
  }
  return cost_of(scene, quick ? 12 : 20);
}

std::vector<Axis> axes() {
  std::vector<double> counts{1.0};
  while (2.0 * counts.back() <= std::thread::hardware_concurrency()) counts.push_back(2.0 * counts.back());
  return {
      {"triangles", "a ball from a binary PLY, 2^20 rays", {1e2, 1e3, 1e4, 1e5, 1e6, 1e7}, {1e2, 1e3}, triangles},
      {"log2 of rays",
       "a ball of 20,000 triangles",
       {14, 16, 18, 20, 22, 24},
       {8, 10},
       [](double size, bool) { return cost_of(ball(20000), static_cast<int>(size)); }},
      {"threads", "a ball of 20,000 triangles, 2^22 rays", counts, counts, threads},
      {"orientations", "a ball of 2,000 triangles, 2^14 rays each", {1, 4, 16, 64, 256}, {1, 4}, orientations},
      {"bins", "a ball of 2,000 triangles, 2^20 rays", {10, 100, 1e3, 1e4, 1e5}, {10, 100}, bins},
      {"variants", "a ball of 2,000 triangles, 2^20 rays", {1, 2, 4, 8, 16, 32}, {1, 2}, variants},
      {"bands", "a ball of 2,000 triangles, 2^20 rays", {1, 2, 4, 8, 16}, {1, 2}, bands},
      {"observers", "a ball of 2,000 triangles, 2^20 rays", {1, 2, 4, 8, 16}, {1, 2}, observers},
  };
}

/// What size stands for: rays are given by their logarithm.
double amount(const Axis& axis, double size) {
  return std::string(axis.name) == "log2 of rays" ? std::exp2(size) : size;
}

/// The slope of log(cost) over log(size), least squares over the upper half of the sizes. NaN where there is none.
double exponent(const Axis& axis, const std::vector<double>& sizes, const std::vector<Cost>& costs,
                double Cost::*which) {
  const std::size_t first = sizes.size() > 3 ? sizes.size() / 2 : 0;
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = first; k < sizes.size(); ++k) {
    const double x = std::log(amount(axis, sizes[k])), y = std::log(costs[k].*which);
    ++n, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n < 2 ? kNone : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::string shown(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

constexpr const char* kHeading[] = {"load, s",  "prepare, s",       "trace, s",         "total, s",
                                    "peak, MB", "Embree's tree, s", "Embree's peak, MB"};
constexpr double Cost::*kColumns[] = {&Cost::load,   &Cost::prepare, &Cost::trace,       &Cost::total,
                                      &Cost::memory, &Cost::rival,   &Cost::rival_memory};

/// The table of an axis, its exponents in the last row; lines for the file of all.
std::string table_of(const Axis& axis, const std::vector<double>& sizes, const std::vector<Cost>& costs,
                     std::string* csv) {
  std::vector<std::vector<std::string>> rows{{axis.name}};
  rows[0].insert(rows[0].end(), std::begin(kHeading), std::end(kHeading));
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    rows.push_back({fmt::format("{:.0f}", sizes[k])});
    *csv += fmt::format("{},{:.0f}", axis.name, sizes[k]);
    for (double Cost::*column : kColumns) {
      rows.back().push_back(shown(costs[k].*column, "{:.4g}"));
      *csv += "," + shown(costs[k].*column, "{:.6g}");
    }
    *csv += "\n";
  }
  rows.push_back({"exponent"});
  for (double Cost::*column : kColumns) rows.back().push_back(shown(exponent(axis, sizes, costs, column), "{:.2f}"));
  return fmt::format("## {}\n{}.\n\n{}\n", axis.name, axis.what, markdown(rows));
}

void panel(clray::text::Plot& plot, const Axis& axis, const std::vector<double>& sizes,
           const std::vector<Cost>& costs) {
  plot.begin_data("cost");
  for (std::size_t k = 0; k < sizes.size(); ++k)
    plot.point({amount(axis, sizes[k]), costs[k].prepare, costs[k].trace, costs[k].memory / 1000.0});
  plot.end_data();
  const std::string name = std::string(axis.name) == "log2 of rays" ? "rays" : axis.name;
  plot.line("set title " + clray::text::gnuplot_text(name));
  plot.line(
      "plot $cost using 1:3 with linespoints pt 7 lw 1.5 lc rgb '#0b4f94' title 'trace, s', $cost using 1:2 with "
      "linespoints pt 5 lw 1.5 lc rgb '#e69f00' title 'prepare, s', $cost using 1:4 with linespoints pt 9 lw 1.5 lc "
      "rgb '#2f9e44' title 'peak, GB'");
}

}  // namespace

int scaling(const Options& options) {
  clray::text::Plot plot(options.quick ? "scaling-short.png" : "scaling.png", 1800, 900);
  plot.line("set multiplot layout 2,4; set lmargin; set rmargin; set tmargin; set bmargin; set logscale xy");
  plot.line("set format xy '10^{%L}'; set key bottom right noopaque nobox font ',11'");
  std::string text, csv = "axis,size,load_s,prepare_s,trace_s,total_s,peak_MB,embree_tree_s,embree_peak_MB\n";
  for (const Axis& axis : axes()) {
    if (!wanted(options, axis.name)) continue;
    const std::vector<double>& sizes = options.quick ? axis.short_sizes : axis.sizes;
    std::vector<Cost> costs;
    for (const double size : sizes) {
      // The compiler's memory is not the run's: programs are built and kept before.
      if (size <= kSmall) apart([&] { return axis.run(size, options.quick); });
      costs.push_back(apart([&] { return axis.run(size, options.quick); }));
      fmt::print("{} {:.0f}: prepare {} s, trace {} s, {:.0f} MB\n", axis.name, size,
                 shown(costs.back().prepare, "{:.4f}"), shown(costs.back().trace, "{:.4f}"), costs.back().memory);
      std::fflush(stdout);
    }
    text += table_of(axis, sizes, costs, &csv);
    panel(plot, axis, sizes, costs);
  }
  plot.line("unset multiplot");
  const std::string name = options.quick ? "scaling-short" : "scaling";
  write_text(options.out, name + ".csv", csv);
  write_text(
      options.out, name + ".md",
      fmt::format("# How costs grow\n\nWritten by `clray-bench scaling` on {}, {}. Each row is one process; times "
                  "are of its second trace. An exponent is the slope of the upper half of the sizes.\n\n{}",
                  device_line(), embree_line(), text));
  const std::string trouble = plot.draw(options.out);
  if (!trouble.empty()) fmt::print(stderr, "clray-bench: {}\n", trouble);
  return 0;
}

}  // namespace clray_bench
