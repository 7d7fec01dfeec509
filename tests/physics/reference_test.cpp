// SPDX-License-Identifier: Apache-2.0
// The judge judged: the brute-force reference tracer and its sample points against closed forms, published
// known answers and properties, before it is used to judge the tracer (traced_test.cpp).
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "reference/from_scene.hpp"
#include "reference/sobol.hpp"
#include "reference/tracer.hpp"
#include "support/checks.hpp"

using namespace clray_test;
namespace ref = clray_reference;

namespace {

ref::Histogram reference_of(const clray::Scene& scene, ref::V3 s, ref::V3 o, const ref::Window& window, int log2_rays) {
  const ref::Body body = ref::body_of(scene);
  return ref::trace(body, s, o, true, ref::bounding_beam(body, s), window, ref::beam_points({}, 16, 1ull << log2_rays));
}

double total(const ref::Histogram& h) {
  return static_cast<double>(h.total);
}

}  // namespace

TEST_CASE("Philox gives the known answers of its authors' kat_vectors") {
  using W = std::array<std::uint32_t, 4>;
  CHECK(ref::philox({0, 0}, {0, 0, 0, 0}) == W{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  const std::uint32_t f = 0xffffffffu;
  CHECK(ref::philox({f, f}, {f, f, f, f}) == W{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
}

TEST_CASE("scrambled beam points are a (0,2)-net: every elementary rectangle holds one point of 2^10") {
  for (std::uint32_t replicate : {0u, 5u}) {
    for (int split = 0; split <= 10; ++split) {
      std::set<std::pair<int, int>> cells;
      for (std::uint32_t i = 0; i < 1024; ++i) {
        const auto p = ref::beam_point({7, 0, true}, replicate, i);
        cells.insert({static_cast<int>(p[0] * (1 << split)), static_cast<int>(p[1] * (1 << (10 - split)))});
      }
      CHECK(cells.size() == 1024);
    }
  }
}

TEST_CASE("reference: Lambert plate at an angle, exact total and uniform depth") {
  for (double degrees : {0.0, 37.0, 80.0, 89.9}) {
    const clray::Vec3 s = toward(radians(degrees));
    const clray::Scene scene = scene_of(plate_mesh(2.0, 1.0), lambert(0.5));
    const double end = 2.0 * std::sin(radians(degrees)) / kLightSpeed + 1e-12;
    const ref::Window window{-end, 2 * end / 63, 63};  // an odd number: face-on, no edge is at the plate
    const auto h = reference_of(scene, ref::vector_of(s), ref::vector_of(s), window, 14);
    const Pulse exact = lambert_plate(0.5, 2.0, 1.0, radians(degrees));
    // Every ray hits; only rounding and the excluded samples are off.
    const double slack = 1e-12 + 2.0 * static_cast<double>(h.excluded) / 16384;
    CHECK(total(h) == relative(exact.total_m2_per_sr).epsilon(slack));
    CHECK(h.excluded <= 1);
    for (std::size_t i = 0; i < 63 && degrees > 0.0; ++i) {
      const double t = static_cast<double>(window.first_s + static_cast<ref::Real>(i) * window.bin_s);
      const double share = exact.share(t + static_cast<double>(window.bin_s)) - exact.share(t);
      // A (0,2)-net puts the right number into each interval, one more or less at each end, in every replicate.
      CHECK(std::fabs(static_cast<double>(h.bin[i]) / total(h) - share) <= 2.0 * 16 / 16384);
    }
  }
}

TEST_CASE("reference: polyhedra, monostatic and bistatic, against their facet sums") {
  for (const MeshPtr& mesh : {sphere_mesh(16, 8, 1.0), prism_mesh(6, 1.0, 1.0), box_mesh(1.0, 2.0, 3.0)}) {
    const clray::Scene scene = scene_of(mesh, lambert(0.7));
    const clray::Vec3 s = toward(0.6, 0.3);
    for (const clray::Vec3& o : {s, toward(1.7, 2.0)}) {
      const Pulse exact = convex_lambert(*mesh, 0.7, s, o);
      const ref::Window window{-3e-8L, 6e-8L / 50, 50};
      const auto h = reference_of(scene, ref::vector_of(s), ref::vector_of(o), window, 15);
      // Owen-Sobol totals of silhouettes: about 5·N^(-3/4) of the total (docs/physics.md, section 6) is 0.2 %; 1 % is 5
      // of these.
      CHECK(total(h) == relative(exact.total_m2_per_sr).epsilon(0.01));
      for (std::size_t i = 0; i < 50; ++i) {
        const double t = static_cast<double>(window.first_s + static_cast<ref::Real>(i) * window.bin_s);
        const double share = exact.share(t + static_cast<double>(window.bin_s)) - exact.share(t);
        const double found = static_cast<double>(h.bin[i]) / exact.total_m2_per_sr;
        // Binomial error of a bin with share p from 2^15 points, about half of which hit, five times over.
        CHECK(std::fabs(found - share) <= 5.0 * std::sqrt((share + 1e-4) / 1e4));
      }
    }
  }
}

TEST_CASE("reference: Ashikhmin-Shirley against the sphere's closed form, and reciprocal") {
  for (double n : {0.0, 50.0}) {
    const double exact = ashikhmin_shirley_sphere(0.5, 0.2, n, 1.0);
    const clray::Scene scene = scene_of(sphere_mesh(64, 32, 1.0), ashikhmin_shirley(0.5, 0.2, n));
    const ref::V3 s{0, 0, 1};
    const auto h = reference_of(scene, s, s, {-1e-8L, 2e-8L, 1}, 13);
    // 64 × 32 facets: a facet's normal is off by up to pi/64, which moves a peak of width 1/sqrt(n) by a few
    // per cent at n = 50; this test tells wrong formulas (factors of 2) from right ones.
    CHECK(total(h) == relative(exact).epsilon(0.06));
  }
  ref::Material m;
  m.model = ref::Material::Model::ashikhmin_shirley;
  m.rho = 0.4L, m.d = 0.3L, m.n = 80, m.f0 = 0.6L;
  const ref::V3 n{0, 0, 1}, a = ref::unit({0.3L, 0.1L, 0.6L}), b = ref::unit({-0.2L, 0.5L, 0.3L});
  CHECK(std::fabs(static_cast<double>(ref::reflect(m, n, a, b) - ref::reflect(m, n, b, a))) < 1e-17);
}

TEST_CASE("reference: a plate in another's shadow gets nothing, and a wall shades a floor by its height") {
  // Two plates 1 um apart at 10 m: the rear one is never first.
  clray::Scene scene = scene_of(moved(plate_mesh(1, 1), {0, 0, 10}), lambert(1));
  add(scene, moved(plate_mesh(1, 1), {0, 0, 10 - 1e-6}), lambert(0));
  const ref::V3 z{0, 0, 1};
  const auto h = reference_of(scene, z, z, {-1e-6L, 2e-6L, 1}, 12);
  CHECK(total(h) == relative(1.0 / kPi).epsilon(1e-12));
  // Floor 1 × 1 seen from above, lit at angle theta over a wall of height 1/2: lit share 1 − tan(theta)/2.
  const double theta = radians(40.0);
  clray::Scene shape = scene_of(plate_mesh(1, 1), lambert(1));
  clray::Component& wall = add(shape, plate_mesh(0.5, 1), lambert(0));
  wall.transform.axis = {0, 1, 0};
  wall.transform.angle_rad = radians(90.0);
  wall.transform.translate = {0.5, 0, 0.25};
  const clray::Vec3 s = toward(theta);
  const auto lit = reference_of(shape, ref::vector_of(s), z, {-1e-6L, 2e-6L, 1}, 15);
  const double exact = std::cos(theta) / kPi * (1.0 - 0.5 * std::tan(theta));
  CHECK(total(lit) == relative(exact).epsilon(2e-3));
  // The other way round the wall hides nothing from the light, but part of the floor from the observer.
  const auto seen = reference_of(shape, z, ref::vector_of(s), {-1e-6L, 2e-6L, 1}, 15);
  CHECK(total(seen) == relative(exact).epsilon(2e-3));
}
