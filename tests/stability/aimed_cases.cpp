// SPDX-License-Identifier: Apache-2.0
// Rays aimed exactly at vertices and edges. Seen face-on, the unit square's beam is the square itself, and a ray's foot
// is its sample point, (bits + ½)·2⁻³² in both coordinates and exact in double. The points of a seed are made again by
// tests/reference/sobol, and the square is cut at each of them: no ray meets the inside of a triangle.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "reference/sobol.hpp"
#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;

namespace {

using Foot = std::array<double, 2>;

/// A vertical cut through the square: corners from y = 0 to y = 1 at one x, or two.
struct Cut {
  double x;
  std::vector<double> y;
  std::vector<std::uint32_t> vertex;
};

class Square {
 public:
  Square() { mesh_->material_slots = {""}; }

  /// Triangles between the last cut and a new one at `x` with corners at 0, `middle` and 1.
  void cut(double x, const std::vector<double>& middle) {
    Cut next{x, {0.0}, {}};
    next.y.insert(next.y.end(), middle.begin(), middle.end());
    next.y.push_back(1.0);
    for (double y : next.y) {
      next.vertex.push_back(static_cast<std::uint32_t>(mesh_->vertices.size()));
      mesh_->vertices.push_back({next.x, y, 0.0});
    }
    if (!last_.vertex.empty()) fill(next);
    last_ = next;
  }

  MeshPtr finished() const { return mesh_; }

 private:
  /// Corners with the same number from below are joined, if both cuts have as many.
  void fill(const Cut& next) {
    std::size_t i = 0, j = 0;
    while (i + 1 < last_.y.size() || j + 1 < next.y.size()) {
      const bool right = i + 1 == last_.y.size() || (j <= i && j + 1 < next.y.size());
      if (right) {
        mesh_->triangles.push_back({last_.vertex[i], next.vertex[j], next.vertex[j + 1]});
        ++j;
      } else {
        mesh_->triangles.push_back({last_.vertex[i], next.vertex[j], last_.vertex[i + 1]});
        ++i;
      }
      mesh_->triangle_slot.push_back(0);
    }
  }

  std::shared_ptr<clray::Mesh> mesh_ = std::make_shared<clray::Mesh>();
  Cut last_{0.0, {}, {}};
};

double power_of_two_below(double x) {
  return std::ldexp(1.0, std::ilogb(x));
}

/// The square cut at all feet, in turn: a vertex on it, an upright edge through it, a slanting edge through it.
MeshPtr cut_at(std::vector<Foot> feet) {
  std::sort(feet.begin(), feet.end());
  double gap = 1.0;
  for (std::size_t i = 1; i < feet.size(); ++i) gap = std::min(gap, feet[i][0] - feet[i - 1][0]);
  gap = 0.25 * power_of_two_below(std::min(gap, std::min(feet.front()[0], 1.0 - feet.back()[0])));
  Square square;
  square.cut(0.0, {});
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const double x = feet[i][0], y = feet[i][1];
    const double rise = 0.25 * power_of_two_below(std::min(y, 1.0 - y));
    if (i % 3 == 0) square.cut(x, {y});
    if (i % 3 == 1) square.cut(x, {});
    if (i % 3 == 2) {  // sums of so few bits are exact
      square.cut(x - gap, {y - rise});
      square.cut(x + gap, {y + rise});
    }
  }
  square.cut(1.0, {});
  return square.finished();
}

Outcome aimed(bool sobol, int log2_rays) {
  constexpr std::uint64_t kSeed = 1;
  const std::uint64_t key = clray_reference::view_key({{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}});
  std::vector<Foot> feet = clray_reference::beam_points({kSeed ^ key, 0, sobol}, 16, 1ull << log2_rays);
  std::sort(feet.begin(), feet.end());
  const auto same = [](const Foot& a, const Foot& b) { return a[0] == b[0]; };
  if (std::adjacent_find(feet.begin(), feet.end(), same) != feet.end())
    return {false, "two feet on one upright line: the seed does not do"};
  Scene scene = scene_of(cut_at(feet), lambert(1.0));
  scene.trace.sampler = sobol ? clray::SamplerKind::sobol : clray::SamplerKind::random;
  const clray::Result result = run(rays(scene, log2_rays, kSeed));
  const clray::DelayResult& d = result.delay.at(0);
  const std::uint64_t hits = std::accumulate(d.hits.begin(), d.hits.end(), std::uint64_t{0});
  Outcome outcome = near(d.intensity_m2_per_sr.value, 0.0, 1.0 / kPi, kQuantumOfTotal);
  outcome.pass = sound(result, &outcome.measured) && outcome.pass && hits == feet.size();
  outcome.measured += fmt::format("; {} hits of {} rays", hits, feet.size());
  return outcome;
}

}  // namespace

std::vector<Case> aimed_cases() {
  const char* const kWhat = "every ray counted once";
  const char* const kExact = "hits: exact; total: 2^-37, every weight may be rounded by half a unit of the sums";
  return {
      {"geometry", "rays aimed at vertices, upright and slanting edges, Sobol", kWhat, kExact, true,
       [] { return aimed(true, 14); }},
      {"geometry", "rays aimed at vertices, upright and slanting edges, random", kWhat, kExact, true,
       [] { return aimed(false, 14); }},
  };
}

}  // namespace clray_test
