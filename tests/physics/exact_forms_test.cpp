// SPDX-License-Identifier: Apache-2.0
// The exact pulse against closed forms: totals to 1e-12, bins to 1e-11 of the total (support/exact_checks.hpp).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "reference/box_wing.hpp"
#include "support/exact_checks.hpp"

using namespace clray_test;

namespace {

/// A flat part whose visible area is spread evenly over depths (m, away from the station).
struct Even {
  double area_m2, cosine;  // across the beam
  double from, to;
};

Pulse lambert_sum(double rho, const std::vector<Even>& parts) {
  double sum = 0.0;
  for (const Even& p : parts) sum += p.area_m2 * p.cosine;
  return {rho / kPi * sum, two_way([parts, sum](double depth) {
            double share = 0.0;
            for (const Even& p : parts) {
              const double low = std::min(p.from, p.to), length = std::fabs(p.to - p.from);
              const double here = length > 0.0 ? (depth - low) / length : depth < low ? 0.0 : 1.0;
              share += p.area_m2 * p.cosine * std::clamp(here, 0.0, 1.0);
            }
            return share / sum;
          })};
}

void check_pulse(const MeshPtr& mesh, const clray::Vec3& s, const Pulse& exact) {
  const clray::Result result = solve(lambert_scene(mesh, s));
  check_exact(result, exact.total_m2_per_sr);
  check_exact_bins(result, exact);
}

}  // namespace

TEST_CASE("exact plates, boxes and prisms against closed forms, with their bins") {
  for (const double degrees : {0.0, 20.0, 60.0, 89.0}) {
    CAPTURE(degrees);
    const double tilt = radians(degrees);
    const clray::Result result = solve(lambert_scene(plate_mesh(2.0, 1.0), toward(tilt)));
    const Pulse exact = lambert_plate(0.5, 2.0, 1.0, tilt);
    check_exact(result, exact.total_m2_per_sr);
    if (degrees == 0.0) continue;
    check_exact_bins(result, exact);
    const double length_s = 4.0 * std::sin(tilt) / kLightSpeed;
    CHECK(std::fabs(result.delay.at(0).mean_delay_s.value) <= kExact * length_s);
    CHECK(result.delay.at(0).rms_width_s.value == relative(length_s / std::sqrt(12.0)).epsilon(1e-11));
  }
  for (const MeshPtr& mesh : {box_mesh(1.0, 2.0, 3.0), prism_mesh(6, 1.0, 1.0), prism_mesh(31, 0.5, 2.0),
                              cone_mesh(7, 1.0, 2.0), sphere_mesh(24, 12, 1.0)}) {
    for (const clray::Vec3& s : {toward(0.0), toward(0.9, 0.5), toward(1.4, 0.1), toward(2.5, -2.0)}) {
      const Pulse exact = convex_lambert(*mesh, 0.5, s, s);
      const clray::Result result = solve(lambert_scene(mesh, s));
      check_exact(result, exact.total_m2_per_sr);
      if (s.z < 1.0) check_exact_bins(result, exact);  // a face that looks at the light may lie on a border of bins
    }
  }
}

TEST_CASE("a plate that faces the light lies in one bin") {
  const clray::Result result = solve(lambert_scene(plate_mesh(2.0, 1.0), toward(0.0)));
  int lit = 0;
  for (const double bin : result.delay.at(0).bin_m2_per_sr) lit += bin != 0.0;
  CHECK(lit == 1);
}

TEST_CASE("what lies below and above a window is counted") {
  const double tilt = radians(60.0), half_s = 2.0 * std::sin(tilt) / kLightSpeed;
  clray::Scene scene = lambert_scene(plate_mesh(2.0, 1.0), toward(tilt));
  window(scene, -0.5 * half_s, 0.25 * half_s, 12);
  const clray::Result result = solve(scene);
  const Pulse exact = lambert_plate(0.5, 2.0, 1.0, tilt);
  check_exact(result, exact.total_m2_per_sr);
  check_exact_bins(result, exact);
  CHECK(result.delay.at(0).below_m2_per_sr == relative(0.25 * exact.total_m2_per_sr).epsilon(1e-11));
  CHECK(result.delay.at(0).above_m2_per_sr == relative(0.375 * exact.total_m2_per_sr).epsilon(1e-11));
}

TEST_CASE("plates behind plates, and plates that cross, against closed forms") {
  // A plate of 1 x 1 before one of 2 x 2: what is seen of the second is 3 m².
  const MeshPtr behind = merged({plate_mesh(2.0, 2.0), moved(plate_mesh(1.0, 1.0), {0.25, -0.125, 1.0})});
  check_exact(solve(lambert_scene(behind, toward(0.0))), 0.5 / kPi * 4.0);
  // Two plates z = ±x + y·lean: of each, the half that is nearer is seen, so depth is |x| + y·lean over 2 x 2 m².
  for (const double lean : {0.0, 0.5}) {
    CAPTURE(lean);
    Triangles cross;
    for (const double sign : {1.0, -1.0}) {
      const auto at = [&](double x, double y) { return clray::Vec3(x, y, sign * x + lean * y); };
      add_quad(&cross, at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
    }
    // Without lean depth is even from 0 to 1; with 1/2, the sum of two even numbers, a triangle from -1/2 to 3/2.
    const Cdf depth = two_way([&](double d) {
      if (lean == 0.0) return std::clamp(d + 1.0, 0.0, 1.0);
      const double x = std::clamp(-d + 0.5, 0.0, 2.0);  // from the far end
      return x < 1.0 ? 1.0 - 0.5 * x * x : 0.5 * (2.0 - x) * (2.0 - x);
    });
    check_pulse(mesh_of(cross), toward(0.0), {0.5 / kPi * 4.0 / std::sqrt(2.0 + lean * lean), depth});
  }
}

TEST_CASE("stairs from the front and from behind, where each step shades the one below it") {
  constexpr int kSteps = 5;
  const double tread = 0.5, rise = 0.25, width = 2.0;
  Triangles stairs;
  for (int k = 0; k < kSteps; ++k) {
    const double x = k * tread, z = (k + 1) * rise;
    add_quad(&stairs, {x, 0, z}, {x + tread, 0, z}, {x + tread, width, z}, {x, width, z});
    add_quad(&stairs, {x, 0, z - rise}, {x, 0, z}, {x, width, z}, {x, width, z - rise});
  }
  for (const double sx : {-0.6, 0.6}) {
    CAPTURE(sx);
    const clray::Vec3 s(sx, 0.0, 0.8);
    const auto depth = [&](double x, double z) { return -(s.x * x + s.z * z); };
    std::vector<Even> parts;
    for (int k = 0; k < kSteps; ++k) {
      const double x = k * tread, z = (k + 1) * rise;
      // From behind the next riser's shadow lies on a tread, and no riser is seen.
      const double seen = sx < 0.0 || k == kSteps - 1 ? tread : tread - rise * s.x / s.z;
      parts.push_back({seen * width * s.z, s.z, depth(x, z), depth(x + seen, z)});
      if (sx < 0.0) parts.push_back({rise * width * -s.x, -s.x, depth(x, z - rise), depth(x, z)});
    }
    check_pulse(mesh_of(stairs), s, lambert_sum(0.5, parts));
  }
  // Aslant from the front all of them are seen.
  const clray::Vec3 s = toward(0.8, 2.8);
  const double sum = kSteps * width * (tread * s.z * s.z + rise * s.x * s.x);
  check_exact(solve(lambert_scene(mesh_of(stairs), s)), 0.5 / kPi * sum);
}

TEST_CASE("louvres, dense before nothing and wide apart before a wall") {
  constexpr int kSlats = 8;
  const double width = 2.0, across = 0.4, height = 0.3;  // of a slat of 0.5 m, cosine 0.8
  for (const double pitch : {0.25, 0.5}) {
    CAPTURE(pitch);
    Triangles louvres;
    std::vector<Even> parts;
    for (int k = 0; k < kSlats; ++k) {
      const double x = k * pitch;
      add_quad(&louvres, {x, 0, 0}, {x + across, 0, height}, {x + across, width, height}, {x, width, 0});
      // The slat before it, which is higher, hides its lower end.
      const double hidden = k == 0 ? 0.0 : std::max(0.0, across - pitch), slope = height / across;
      parts.push_back({(across - hidden) * width, 0.8, -slope * hidden, -height});
    }
    if (pitch > across) {
      // The wall leans: z = -1 - x/8.
      const double end = kSlats * pitch, cosine = 1.0 / std::sqrt(1.0 + 1.0 / 64.0), low = -1.0 - end / 8.0;
      add_quad(&louvres, {0, 0, -1}, {end, 0, low}, {end, width, low}, {0, width, -1});
      for (int k = 0; k < kSlats; ++k) {
        const double x = k * pitch + across;
        parts.push_back({(pitch - across) * width, cosine, 1.0 + x / 8.0, 1.0 + (x + pitch - across) / 8.0});
      }
    }
    check_pulse(mesh_of(louvres), toward(0.0), lambert_sum(0.5, parts));
  }
}

TEST_CASE("a box with wings from 20 directions, against overlaps of convex outlines in long double") {
  clray_reference::BoxWing body{{{0.5, 0.625, 0.75}}, 2.0, 1.25, {{0.375, 0.0, 0.125}}};
  Triangles wings;
  for (const double sign : {1.0, -1.0}) {
    const auto at = [&](double along, double over) {
      return clray::Vec3(over * body.half_chord[0], sign * body.wing_y + along * body.half_span,
                         over * body.half_chord[2]);
    };
    add_quad(&wings, at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
  }
  const MeshPtr mesh = merged({box_mesh(1.0, 1.25, 1.5), mesh_of(wings)});
  int hiding = 0;
  for (int k = 0; k < 20; ++k) {
    CAPTURE(k);
    const clray::Vec3 s = toward(std::acos(0.95 - 0.1 * k), 2.4 * k + 0.3);  // 2.4 rad: near the golden angle
    const clray_reference::BoxWingView view = clray_reference::box_wing_view(body, {{s.x, s.y, s.z}});
    check_exact(solve(lambert_scene(mesh, s)), static_cast<double>(0.5L / kPi * view.area_times_cosine));
    hiding += view.hidden > 1e-3L;
  }
  CHECK(hiding >= 10);
}
