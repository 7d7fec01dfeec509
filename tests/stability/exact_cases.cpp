// SPDX-License-Identifier: Apache-2.0
// Stiff and extreme bodies for the exact method: sheets, fans, slats, needles, grazing light, far-off bodies, faces in
// one place, scaling. Each is right to the rounding that it claims; times are told, not judged.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;
using clray::Vec3;

namespace {

const char* const kTolerance = "the rounding_bound that is claimed, and 1e-9 of the total";

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Scene solved(const MeshPtr& mesh, Vec3 s, double rho = 0.5) {
  auto whole = std::make_shared<clray::Mesh>(*mesh);
  whole->triangle_slot.assign(whole->triangles.size(), 0);
  Scene scene = scene_of(whole, lambert(rho));
  monostatic(scene, s);
  scene.trace.method = clray::Method::exact;
  scene.trace.rays = 0;
  return scene;
}

/// `unknown`: what the closed form itself may be off.
Outcome is(const Scene& scene, double expected, double unknown = 0.0) {
  const double start = now();
  const clray::Result result = run(scene);
  const double seconds = result.seconds.trace, all = now() - start;
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  const double off = std::fabs(a.value - expected);
  Outcome outcome;
  outcome.measured = fmt::format("A = {:.12g}, off by {:.1e}, claimed {:.1e}; {:.2f} s of tracing, {:.2f} in all",
                                 a.value, off, a.rounding_bound, seconds, all);
  outcome.pass = off <= a.rounding_bound + unknown && off <= 1e-9 * expected + unknown;
  outcome.pass = sound(result, &outcome.measured) && outcome.pass;
  return outcome;
}

void quad(clray::Mesh* mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
  mesh->vertices.insert(mesh->vertices.end(), {a, b, c, d});
  mesh->triangles.push_back({first, first + 1, first + 2});
  mesh->triangles.push_back({first, first + 2, first + 3});
}

std::shared_ptr<clray::Mesh> empty_mesh() {
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  return mesh;
}

constexpr double kUnit = 0.5 / kPi;  // A of a square metre that faces the light

Outcome sheets() {
  auto mesh = empty_mesh();
  for (int k = 0; k < 1000; ++k) {
    const double z = -1e-9 * k, half = 0.5 + 5e-4 * k;  // each lower one is 0.5 mm wider
    quad(mesh.get(), {-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z});
  }
  const double side = 2.0 * (0.5 + 5e-4 * 999);
  return is(solved(mesh, toward(0.0)), kUnit * side * side);
}

Outcome fan() {
  auto mesh = empty_mesh();
  mesh->vertices.push_back({0.1, 0.2, 1.0});
  for (int k = 0; k <= 720; ++k) mesh->vertices.push_back({std::cos(kPi * k / 360.0), std::sin(kPi * k / 360.0), 0.0});
  double sum = 0.0;
  for (std::uint32_t k = 1; k <= 720; ++k) {
    mesh->triangles.push_back({0, k, k + 1});
    const Vec3 a = mesh->vertices[k] - mesh->vertices[0], b = mesh->vertices[k + 1] - mesh->vertices[0];
    const Vec3 n(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    sum += 0.5 * n.z * n.z / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  }
  return is(solved(mesh, toward(0.0)), kUnit * sum);
}

/// 720 plates that share one edge, like pages of a book that is open all around. Where several lie over one place the
/// steepest is seen, so each shows what reaches beyond the next steeper one.
Outcome pages() {
  constexpr int kQuarter = 180;
  auto mesh = empty_mesh();
  double sum = 0.0, reached = 0.0;
  for (int k = kQuarter - 1; k >= 0; --k) {
    const double angle = radians((k + 0.5) * 90.0 / kQuarter), c = std::cos(angle), s = std::sin(angle);
    for (const double x : {c, -c}) {
      for (const double z : {s, -s}) quad(mesh.get(), {0, 0, 0}, {x, 0, z}, {x, 1, z}, {0, 1, 0});
    }
    sum += 2.0 * (c - reached) * c;
    reached = c;
  }
  return is(solved(mesh, toward(0.0)), kUnit * sum);
}

/// 300 slats over 300 others across them: all that is beside an upper slat shows a lower one or nothing.
Outcome slats() {
  constexpr int kSlats = 300;
  auto mesh = empty_mesh();
  const double pitch = 1.0 / kSlats, width = 0.5 * pitch;
  for (int k = 0; k < kSlats; ++k) {
    const double x = k * pitch;
    quad(mesh.get(), {x, 0, 1}, {x + width, 0, 1}, {x + width, 1, 1}, {x, 1, 1});
    quad(mesh.get(), {0, x, 0}, {1, x, 0}, {1, x + width, 0}, {0, x + width, 0});
  }
  // Upper ones: half of the square; lower ones: half of the other half.
  return is(solved(mesh, toward(0.0)), kUnit * 0.75, kUnit * 1e-13);
}

Outcome needles() {
  auto mesh = empty_mesh();
  double sum = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double w = 1e-12, x = 0.01 * k;
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), {{x, 0, 0}, {x + w, 0, 0}, {x, 1, 0}});
    mesh->triangles.push_back({first, first + 1, first + 2});
    sum += 0.5 * (mesh->vertices[first + 1].x - mesh->vertices[first].x);
  }
  quad(mesh.get(), {3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0});
  return is(solved(mesh, toward(0.0)), kUnit * (1.0 + sum));
}

Outcome grazing() {
  const double tilt = radians(89.99999);
  return is(solved(plate_mesh(2.0, 1.0), toward(tilt)), lambert_plate(0.5, 2.0, 1.0, tilt).total_m2_per_sr,
            1e-9 * lambert_plate(0.5, 2.0, 1.0, tilt).total_m2_per_sr);
}

Outcome far_off() {
  // Coordinates near 10^6 m are multiples of 2^-33 m, and so are those of the box: nothing is rounded.
  return is(solved(moved(box_mesh(1.0, 2.0, 3.0), {1048576.0, -524288.0, 262144.0}), toward(0.0)), kUnit * 2.0);
}

Outcome coincident() {
  auto mesh = empty_mesh();
  for (int k = 0; k < 50000; ++k) quad(mesh.get(), {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  return is(solved(mesh, toward(0.0)), kUnit);
}

Outcome nested() {
  // 3,000 squares in one plane, no two alike: each point belongs to one of them, whichever it is.
  auto mesh = empty_mesh();
  for (int k = 0; k < 3000; ++k) {
    const double half = 0.5 + 1e-4 * ((k * 1741) % 3000);
    quad(mesh.get(), {-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0});
  }
  const double side = 2.0 * (0.5 + 1e-4 * 2999);
  return is(solved(mesh, toward(0.0)), kUnit * side * side);
}

Outcome scaled() {
  std::uint64_t first = 0;
  std::string broken;
  for (const int k : {0, -40, -7, 13, 40}) {
    Scene scene = solved(sphere_mesh(24, 12, 1.0), toward(0.7, 0.4));
    const double factor = std::ldexp(1.0, k);
    for (auto& c : scene.components) c.mesh = moved(c.mesh, {0, 0, 0}, factor);
    window(scene, -8e-9 * factor, 8e-9 * factor, 256);
    const std::uint64_t digest = run(scene).digest;
    if (k == 0) first = digest;
    if (digest != first) broken += fmt::format(" 2^{}", k);
  }
  return {broken.empty(), fmt::format("digest {:016x}{}", first, broken.empty() ? "" : ", differ:" + broken)};
}

/// A window of 10^6 fs, of which the plate fills nine tenths.
Outcome fine_bins() {
  const double window_s = 1e-9, half = 0.45 * window_s,
               side = 2.0 * half * kLightSpeed / (2.0 * std::sin(radians(60.0)));
  Scene scene = solved(plate_mesh(side, side), toward(radians(60.0)));
  window(scene, -0.5 * window_s, 0.5 * window_s, 1000000);
  const clray::Result result = run(scene);
  const clray::DelayResult& d = result.delay.at(0);
  const double a = lambert_plate(0.5, side, side, radians(60.0)).total_m2_per_sr;
  const double full = a * d.bin_width_s / (2.0 * half);
  double worst = 0.0;
  long double sum = static_cast<long double>(d.below_m2_per_sr) + d.above_m2_per_sr;
  std::size_t lit = 0;
  for (const double bin : d.bin_m2_per_sr) {
    sum += bin;
    if (bin <= 0.0) continue;
    ++lit;
    if (bin > 0.999 * full) worst = std::max(worst, std::fabs(bin / full - 1.0));
  }
  const double off = static_cast<double>(std::fabs(sum / a - 1.0L));
  Outcome outcome;
  outcome.measured =
      fmt::format("{} bins of {:.1f} fs lit, largest difference {:.1e} of a bin, sum off by {:.1e}; {:.2f} s", lit,
                  d.bin_width_s * 1e15, worst, off, result.seconds.trace);
  // A border is placed to 1e-16 of the window, which is 1e-10 of a bin.
  outcome.pass = worst < 1e-9 && off < 1e-12 && lit > 899990 && lit < 900010;
  return outcome;
}

}  // namespace

std::vector<Case> exact_cases() {
  const auto row = [](const char* name, Outcome (*run)()) {
    return Case{"exact", name, "closed form", kTolerance, true, run};
  };
  return {row("1,000 sheets 1e-9 m apart, each wider than those before it", sheets),
          row("a fan of 720 triangles about one point", fan),
          row("720 plates that share one edge at all angles", pages),
          row("300 x 300 slats across each other", slats),
          row("200 needles of aspect 10^12 beside a plate", needles),
          row("a plate at 89.99999 degrees", grazing),
          row("a box 10^6 m off the origin", far_off),
          row("10^5 faces in one place", coincident),
          row("6,000 faces in one plane, no two alike", nested),
          {"exact", "scaled by 2^-40 to 2^40", "no bit changes", "exact: digests are equal", true, scaled},
          {"exact", "10^6 bins of 1 fs", "uniform, and the sum is the total", "1e-9 of a bin, 1e-12 of the total", true,
           fine_bins}};
}

}  // namespace clray_test
