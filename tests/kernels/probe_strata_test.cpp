// SPDX-License-Identifier: Apache-2.0
// The strata of a beam: together they are the cells that the body can be in, once each; the device chooses among them
// as their probabilities say; and rays, weighted, are spread evenly over the beam whatever the strata favour.
#include <doctest/doctest.h>

#include <map>

#include "body/geometry.hpp"
#include "kernels/probes/probe.hpp"
#include "pipeline/plan.hpp"
#include "support/scenes.hpp"

namespace {

using namespace probe;
using namespace clray_test;

struct Case {
  std::string name;
  clray::Scene scene;
};

/// Curved, flat, face-on, edge-on parts, a narrow peak, two directions, and no delay detector.
std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"sphere", scene_of("sphere", {{"radius", 1.0}}, lambert(0.5))});
  all.push_back({"narrow peak", scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(0.5, 0.2, 1e5))});
  all.push_back({"face-on box", scene_of(box_mesh(1.0, 1.0, 2.0), lambert(0.5))});
  all.push_back({"tilted box", scene_of(box_mesh(1.0, 1.0, 2.0), lambert(0.5))});
  monostatic(all.back().scene, toward(0.7, 0.4));
  all.push_back({"bistatic cylinder", scene_of("cylinder", {{"radius", 1.0}, {"height", 3.0}}, lambert(0.5))});
  bistatic(all.back().scene, toward(1.0, 0.2), toward(0.4, 2.0));
  all.push_back({"no delay", scene_of(prism_mesh(6, 1.0, 3.0), lambert(0.5))});
  detect(monostatic(all.back().scene, toward(1.1, 0.3)), "spectrometer");
  all.push_back({"few bins", scene_of("cone", {{"radius", 1.0}, {"height", 2.0}}, lambert(0.5))});
  window(all.back().scene, -3e-8, 3e-8, 3);
  return all;
}

clray::PassPlan plan_of(const clray::Scene& scene) {
  return clray::plan_passes(scene, clray::build_geometry(scene)).front();
}

const char* const kPlace = R"(
#include "math/strata.cl"
__kernel void probe(const __global ClrayStratum *strata, const __global ClrayView *view, const __global f64 *in,
                    __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  f64 u[2] = {in[2 * i], in[2 * i + 1]};
  out[3 * i + 2] = strata_place(strata, view, u);
  out[3 * i] = u[0];
  out[3 * i + 1] = u[1];
})";

const char* const kChoose = R"(
#include "math/strata.cl"
__kernel void probe(const __global ClrayStratum *strata, u32 first, u32 count, const __global f64 *in,
                    __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  f64 place, size;
  const u32 k = strata_choose(strata, first, count, in[i], &place, &size);
  out[3 * i] = (f64)k;
  out[3 * i + 1] = place;
  out[3 * i + 2] = size;
})";

/// Points (i, j) of an n × n grid, each moved at random within its square.
std::vector<double> spread(std::uint32_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> points;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      points.push_back((i + random.between(0.001, 0.999)) / n);
      points.push_back((j + random.between(0.001, 0.999)) / n);
    }
  return points;
}

}  // namespace

TEST_CASE("pieces of a cell are its whole area, once, and every filled cell has some") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const clray::PassPlan plan = plan_of(c.scene);
    const ClrayView& view = plan.beams.views.front();
    REQUIRE(view.strips > 0);
    std::map<u32, std::vector<std::pair<u32, u32>>> parts;
    for (u32 s = 0; s < view.strips; ++s) {
      const ClrayStratum& strip = plan.beams.strata.at(view.first_stratum + s);
      for (u32 k = 0; k < strip.b; ++k) {
        const ClrayStratum& piece = plan.beams.strata.at(strip.a + k);
        parts[piece.a & CLRAY_PIECE_CELL].push_back({piece.b & 0xffffu, (piece.b >> 16) + 1});
      }
    }
    std::size_t broken = 0;
    for (auto& [cell, list] : parts) {
      std::sort(list.begin(), list.end());
      u32 end = 0;
      for (const auto& [from, to] : list) {
        broken += from != end || to <= from;
        end = to;
      }
      broken += end != 65536u || cell >= view.grid * view.grid;
    }
    CHECK(broken == 0);
    CHECK(parts.size() > view.grid * view.grid / 20);
  }
}

TEST_CASE("the device finds the stratum of a number as a search from the first would") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const clray::PassPlan plan = plan_of(c.scene);
    const ClrayView& view = plan.beams.views.front();
    std::vector<std::pair<u32, u32>> lists = {{view.first_stratum, view.strips}};
    for (u32 s = 0; s < view.strips; s += 37)
      lists.push_back({plan.beams.strata.at(view.first_stratum + s).a, plan.beams.strata.at(view.first_stratum + s).b});
    Random random(3);
    cl::Kernel kernel = kernel_of(kChoose);
    std::size_t wrong = 0;
    for (const auto& [first, count] : lists) {
      std::vector<double> numbers;
      for (int i = 0; i < 500; ++i) numbers.push_back((random.word() + 0.5) * 0x1p-32);
      for (u32 k = 0; k < count; k += 1 + count / 100)  // the last number of a stratum, and the next
        for (u32 bits : {plan.beams.strata[first + k].last, plan.beams.strata[first + k].last + 1u})
          numbers.push_back((bits + 0.5) * 0x1p-32);
      const cl::Buffer result = out<double>(3 * numbers.size());
      run(kernel, numbers.size(), in(plan.beams.strata), first, count, in(numbers), result);
      const std::vector<double> found = read<double>(result, 3 * numbers.size());
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const double bits = numbers[i] * 0x1p32 - 0.5;
        u32 k = 0;
        while (static_cast<double>(plan.beams.strata[first + k].last) < bits) ++k;
        const double start = k == 0 ? 0.0 : plan.beams.strata[first + k - 1].last + 1.0;
        const double size = plan.beams.strata[first + k].last + 1.0 - start;
        wrong += found[3 * i] != first + k || found[3 * i + 2] != size;
        wrong += std::fabs(found[3 * i + 1] - (bits + 0.5 - start) / size) > 1e-15;
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("weighted, rays fill the beam evenly: the areas of rectangles in it") {
  const std::uint32_t n = 2048;
  const std::vector<double> points = spread(n, 5);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const clray::PassPlan plan = plan_of(c.scene);
    const ClrayView& view = plan.beams.views.front();
    std::vector<std::uint8_t> filled(view.grid * view.grid, 0);
    for (u32 s = 0; s < view.strips; ++s) {
      const ClrayStratum& strip = plan.beams.strata.at(view.first_stratum + s);
      for (u32 k = 0; k < strip.b; ++k) filled[plan.beams.strata[strip.a + k].a & CLRAY_PIECE_CELL] = 1;
    }
    cl::Kernel kernel = kernel_of(kPlace);
    const std::size_t count = points.size() / 2;
    const cl::Buffer result = out<double>(3 * count);
    run(kernel, count, in(plan.beams.strata), in(plan.beams.views), in(points), result);
    const std::vector<double> found = read<double>(result, 3 * count);
    // Rectangles whose edges are no cells' edges; their area is that of the filled cells in them.
    const double edges[6] = {0.0, 0.1003, 0.3337, 0.5419, 0.8011, 1.0};
    const auto part = [&](double x) { return static_cast<int>(std::upper_bound(edges, edges + 6, x) - edges) - 1; };
    double got[25] = {}, squares[25] = {}, exact[25] = {};
    double inside[16] = {}, inside_squares[16] = {};  // of cells, by sixteenths of a cell
    std::size_t outside = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = found[3 * i], y = found[3 * i + 1], share = found[3 * i + 2];
      outside += !(x >= 0.0 && x <= 1.0 && y >= 0.0 && y <= 1.0 && share > 0.0 && share <= 1.0);
      const int k = 5 * std::min(part(y), 4) + std::min(part(x), 4);
      got[k] += share;
      squares[k] += share * share;
      const auto quarter = [&](double z) {
        return std::min(static_cast<int>(4.0 * (z * view.grid - std::floor(z * view.grid))), 3);
      };
      inside[4 * quarter(y) + quarter(x)] += share;
      inside_squares[4 * quarter(y) + quarter(x)] += share * share;
    }
    const double cell = 1.0 / view.grid;
    for (u32 at = 0; at < filled.size(); ++at)
      for (int j = 0; filled[at] && j < 5; ++j)
        for (int i = 0; i < 5; ++i) {
          const double x = at % view.grid * cell, y = at / view.grid * cell;
          const double w = std::min(x + cell, edges[i + 1]) - std::max(x, edges[i]);
          const double h = std::min(y + cell, edges[j + 1]) - std::max(y, edges[j]);
          if (w > 0.0 && h > 0.0) exact[5 * j + i] += w * h;
        }
    CHECK(outside == 0);
    double all = 0.0;
    for (double part : inside) all += part;
    for (int k = 0; k < 16; ++k) {
      CAPTURE(k);
      CHECK(std::fabs(inside[k] - all / 16.0) <= 5.0 * std::sqrt(inside_squares[k]));  // as below
    }
    const double* u = view.edge_u;
    const double* v = view.edge_v;
    const double rectangle =
        std::sqrt((u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    const double scale = plan.beams.area_m2.front() / rectangle / static_cast<double>(count);
    for (int k = 0; k < 25; ++k) {
      CAPTURE(k);
      // Five standard errors of independent points, which these, one in each square of a grid, beat.
      CHECK(std::fabs(got[k] * scale - exact[k]) <= 5.0 * std::sqrt(squares[k]) * scale + 1e-12);
    }
  }
}
