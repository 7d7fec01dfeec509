// SPDX-License-Identifier: Apache-2.0
// The tracer against the brute-force reference on the same sample points, bin by bin: the paper's three bodies, both
// materials, monostatic and bistatic. Tolerance per bin: 1e-12 of it (fp64 weights), half a unit of the integer sums
// per hit, and what the excluded samples could bring.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "reference/from_scene.hpp"
#include "reference/sobol.hpp"
#include "support/checks.hpp"

using namespace clray_test;
namespace ref = clray_reference;

namespace {

std::uint64_t key_of(const clray::Result& result) {
  const clray::Orientation& view = result.orientations.at(0);
  std::vector<std::array<double, 3>> directions{{view.source.x, view.source.y, view.source.z}};
  for (const clray::Vec3& o : view.observers) directions.push_back({o.x, o.y, o.z});
  return ref::view_key(directions);
}

struct Tally {
  std::uint64_t samples = 0, excluded = 0;
};

/// Upper bound of f·mu_o for this source and observer (docs/physics.md, section 7: W).
double weight_bound(const clray::Scene& scene, clray::Vec3 s, clray::Vec3 o) {
  double bound = 0.0;
  const double u = 0.5 * std::sqrt(2.0 + 2.0 * (s.x * o.x + s.y * o.y + s.z * o.z));
  for (const clray::Material& m : scene.materials) {
    double w = 1.0 / kPi;
    if (m.model != "lambert") w = 28.0 / (23.0 * kPi) + (m.parameters.at("n") + 1.0) / (8.0 * kPi * u);
    bound = std::max(bound, w);
  }
  return bound;
}

void compare(clray::Scene scene, clray::Vec3 s, clray::Vec3 o, bool same, Tally* tally, const std::string& what) {
  CAPTURE(what);
  CAPTURE(same);
  same ? monostatic(scene, s) : bistatic(scene, s, o);
  if (same) o = s;
  many_rays(scene, 17);
  scene.trace.sampler = clray::SamplerKind::sobol;  // the documented points, cells apart
  const clray::Result result = run(scene);
  REQUIRE(result.delay.size() == 1);
  const clray::DelayResult& found = result.delay[0];
  REQUIRE(result.rays == (1u << 17));
  const ref::Body body = ref::body_of(scene);
  const ref::V3 rs = ref::vector_of(s), ro = ref::vector_of(o);
  const ref::Window window{found.first_bin_start_s, found.bin_width_s, found.bin_m2_per_sr.size()};
  const auto points = ref::beam_points({scene.trace.seed ^ key_of(result), 0, true}, 16, result.rays);
  const auto h = ref::trace(body, rs, ro, !same, ref::bounding_beam(body, rs), window, points);
  tally->samples += h.samples;
  tally->excluded += h.excluded;
  const double unit = std::exp2(-37.0 + std::ceil(std::log2(weight_bound(scene, s, o))));
  int wrong = 0;
  double worst = 0.0;
  ref::Real undecided = 0;
  double rounding = 0.0;  // of the total: half a unit per hit, inside the window and out
  for (std::size_t i = 0; i < window.bins; ++i) {
    const double exact = static_cast<double>(h.bin[i]);
    const double slack = 1e-12 * exact +
                         static_cast<double>(h.hits[i]) * 0.5 * unit * static_cast<double>(h.sample_m2) +
                         static_cast<double>(h.undecided[i]);
    const double off = std::fabs(found.bin_m2_per_sr[i] - exact);
    worst = std::max(worst, exact > 0.0 ? off / exact : 0.0);
    wrong += !(off <= slack);
    undecided += h.undecided[i];
    rounding += static_cast<double>(h.hits[i]) * 0.5 * unit * static_cast<double>(h.sample_m2);
    if (h.undecided[i] == 0) wrong += found.hits[i] != h.hits[i];
  }
  CAPTURE(worst);
  CAPTURE(h.excluded);
  CHECK(wrong == 0);
  const double total = static_cast<double>(h.total);
  CHECK(total > 0.0);
  CHECK(std::fabs(found.intensity_m2_per_sr.value - total) <=
        1e-12 * total + rounding + static_cast<double>(undecided));
}

clray::Scene box_wing(const clray::Material& bus, const clray::Material& wings) {
  clray::Scene scene = scene_of(box_mesh(1.0, 1.0, 2.0), bus);
  for (double side : {-1.0, 1.0}) add(scene, moved(plate_mesh(3.0, 1.0), {2.2 * side, 0.0, 0.1}), wings);
  return scene;
}

}  // namespace

TEST_CASE("tracer and brute-force reference agree to rounding, bin by bin") {
  Tally tally;
  const clray::Material diffuse = lambert(0.5), shiny = ashikhmin_shirley(0.5, 0.2, 50),
                        sharp = ashikhmin_shirley(0.3, 0.7, 500);
  // Directions with no facet face-on: there every sample would lie on one delay and the window has an edge there or
  // not.
  const clray::Vec3 s = toward(0.7, 0.4), o = toward(1.1, -0.9), back = toward(2.3, 2.9);
  for (const bool same : {true, false}) {
    compare(scene_of(prism_mesh(6, 1.0, 1.0), diffuse), s, o, same, &tally, "hexagonal prism, Lambert");
    compare(scene_of(prism_mesh(6, 1.0, 1.0), shiny), back, s, same, &tally, "hexagonal prism, A-S");
    compare(scene_of(prism_mesh(48, 1.0, 3.0), shiny), s, o, same, &tally, "cylinder, A-S");
    compare(scene_of(prism_mesh(48, 1.0, 3.0), diffuse), back, o, same, &tally, "cylinder, Lambert");
    compare(box_wing(diffuse, sharp), s, o, same, &tally, "box-wing");
    compare(box_wing(shiny, diffuse), back, toward(1.9, 2.0), same, &tally, "box-wing from behind");
  }
  INFO("excluded ", tally.excluded, " of ", tally.samples);
  CHECK(static_cast<double>(tally.excluded) <= 1e-6 * static_cast<double>(tally.samples));
}

TEST_CASE("tracer and reference agree face-on, where delays pile up inside a bin") {
  // The automatic window begins and ends bins on the faces of a symmetrical body; an odd number of bins does not.
  Tally tally;
  clray::Scene scene = scene_of(box_mesh(1.0, 1.0, 1.0), lambert(0.5));
  window(scene, -4.1e-9, 4e-9, 63);
  clray::Scene plate = scene_of(plate_mesh(2.0, 1.0), lambert(0.9));
  compare(scene, {0, 0, 1}, {0, 0, 1}, true, &tally, "box from +z");
  compare(scene, {0, 0, -1}, {0, 0, -1}, true, &tally, "box from -z");
  compare(window(plate, -4.1e-9, 4e-9, 63), {0, 0, 1}, {0, 0, 1}, true, &tally, "plate from +z");
  CHECK(tally.excluded <= 1);
}

TEST_CASE("one-sided faces are black from behind") {
  clray::Material m = lambert(0.5);
  m.two_sided = false;
  Tally tally;
  clray::Scene wing = box_wing(lambert(0.5), m);
  compare(wing, toward(2.3, 2.9), toward(1.1, -0.9), true, &tally, "box-wing, black backs");
  clray::Scene plate = scene_of(plate_mesh(1, 1), m);
  monostatic(plate, {0, 0, -1});
  CHECK(run(plate).delay.at(0).intensity_m2_per_sr.value == 0.0);
}

TEST_CASE("random sampling draws the same Philox points as documented") {
  clray::Scene scene = scene_of(box_mesh(1.0, 2.0, 3.0), lambert(0.5));
  const clray::Vec3 s = toward(0.7, 0.4);
  monostatic(scene, s);
  scene.trace.sampler = clray::SamplerKind::random;
  rays(scene, 14, 0x123456789abcdefull);
  const clray::Result result = run(scene);
  const ref::Body body = ref::body_of(scene);
  const ref::V3 rs = ref::vector_of(s);
  const auto h = ref::trace(body, rs, rs, false, ref::bounding_beam(body, rs), {-1e-6L, 2e-6L, 1},
                            ref::beam_points({scene.trace.seed ^ key_of(result), 0, false}, 16, result.rays));
  const double total = static_cast<double>(h.total);
  CHECK(std::fabs(result.delay.at(0).intensity_m2_per_sr.value - total) <=
        kQuantum * total + static_cast<double>(h.undecided[0]));
}
