// SPDX-License-Identifier: Apache-2.0
// Ray against shape: the kernels' fp64 answer against the textbook quadratic in __float128 (shape_model.hpp). Distances
// are judged by what a rounding of the ray may do (backward error): the point at the computed t lies within
// K·2^-53·(|o| + size) of the surface; t itself within that over the cosine of incidence.
#include <doctest/doctest.h>

#include "kernels/shape_model.hpp"

namespace {
using namespace shape_model;

struct Outcome {
  double residual = 0;  // worst distance from the surface at t, in 2^-53·(|o| + size)
  double t_error = 0;   // worst |t - exact|·cos in the same unit, where cos > 1e-4
  long hits = 0, wrong = 0, excluded = 0;
};

/// Hit or miss, part, residual and t of one ray. `sure`: decisions nearer than this (m) are left out and counted.
void check_ray(const Case& c, const RayOf& ray, double sure, Outcome* out) {
  const auto exact = crossings(c, lift<Quad>(ray.o), lift<Quad>(ray.d));
  if (exact.margin < Quad(sure)) {
    ++out->excluded;
    return;
  }
  double t = -1;
  u32 part = 99;
  const int hit = shape_kernels::shape_intersect(c.row, c.p.data(), ray.o, ray.d, 1e300, &t, &part);
  const auto* first = exact.first_after_zero();
  if (hit != (first != nullptr) || (hit && part != first->part)) {
    ++out->wrong;
    return;
  }
  if (!hit) return;
  ++out->hits;
  const double unit = kEps * (v3_length(ray.o) + c.size);
  const Vec<Quad> d = lift<Quad>(ray.d), x = along(lift<Quad>(ray.o), Quad(t), d);
  out->residual = std::max(out->residual, double(magnitude(signed_distance(c, part, x))) / unit);
  const double step = 1e-3 * c.size;  // cosine from the surface's own function, by a central difference
  const double cosine = std::fabs(double(signed_distance(c, part, along(x, Quad(step), d)) -
                                         signed_distance(c, part, along(x, Quad(-step), d)))) /
                        (2 * step);
  if (cosine > 1e-2) out->t_error = std::max(out->t_error, double(magnitude(Quad(t) - first->t)) * cosine / unit);
}

}  // namespace

TEST_CASE("shapes: random rays agree with the quadratic in 113 bits") {
  // 8 ulp-halves of the ray's own magnitude: three roundings of origin, moment and root, with room for their sum.
  for (const Case& c : cases()) {
    Random random(11);
    Outcome out;
    for (int k = 0; k < 20000; ++k) check_ray(c, random_ray(random, c, 100), 1e-13 * 100 * c.size, &out);
    for (int k = 0; k < 5000; ++k) {  // from within
      check_ray(c, {random.inside_ball(c.size), random.direction()}, 1e-13 * c.size, &out);
    }
    INFO(c.name << ": hits " << out.hits << ", residual " << out.residual << ", t " << out.t_error);
    CHECK(out.wrong == 0);
    CHECK(out.hits > (1000));
    CHECK(out.excluded < 25);
    CHECK(out.residual < 8.0);
    CHECK(out.t_error < 12.0);
    MESSAGE(c.name << ": residual " << out.residual << ", t error " << out.t_error << " (2^-53 (|o|+size)), hits "
                   << out.hits << ", excluded " << out.excluded);
  }
}

TEST_CASE("shapes: grazing rays are decided and placed right") {
  // Tangents of the curved surfaces, moved off by 1e-3 to 1e-12 of the size either way.
  for (const Case& c : cases()) {
    if (c.plane || c.row == shape_kernels::CLRAY_SHAPE_box || c.name == "needle") continue;
    Random random(12);
    Outcome out;
    const Curved<double> s(c);
    for (int k = 0; k < 20000; ++k) {
      const vec3 x = surface_at(c, 0, random.between(0.02, 0.98), random.uniform());
      const Vec<double> g = s.gradient({x.x, x.y, x.z});
      const vec3 n = v3_unit(v3(g.x, g.y, g.z));
      vec3 t1, t2;
      v3_frame(n, &t1, &t2);
      const double phi = random.between(0, 2 * CLRAY_PI);
      const vec3 d = v3_unit(v3_add(v3_scale(std::cos(phi), t1), v3_scale(std::sin(phi), t2)));
      const double off = c.size * std::pow(10, random.between(-12, -3)) * (random.uniform() < 0.5 ? -1 : 1);
      const vec3 o = v3_fma(-c.size * random.between(1.5, 10), d, v3_fma(off, n, x));
      check_ray(c, {o, d}, 1e-14 * c.size, &out);
    }
    INFO(c.name << ": residual " << out.residual << ", excluded " << out.excluded << ", hits " << out.hits);
    CHECK(out.wrong == 0);
    CHECK(out.hits > 5000);
    CHECK(out.residual < 8.0);
    MESSAGE(c.name << ": grazing residual " << out.residual << ", excluded " << out.excluded << " of 20000");
  }
}

TEST_CASE("sphere: 1 mm at 10 m, and 10 m at 10 m off-centre") {
  // t's error times the cosine of incidence, in 2^-53 of the distance from the centre.
  struct Setting {
    double radius, nearest, farthest;
    double bound;
  };
  for (const Setting& s : {Setting{1e-3, 10, 10, 6}, Setting{10, 10, 20, 6}, Setting{10, 9.99999, 10.00001, 6},
                           Setting{10, 0, 10, 6}, Setting{1e-3, 1e6, 1e6, 6}}) {
    const Case c{"sphere", shape_kernels::CLRAY_SHAPE_sphere, {s.radius}, s.radius, true, false};
    Random random(13);
    double worst = 0, worst_grazing = 0;
    long wrong = 0, hits = 0, excluded = 0;
    for (int k = 0; k < 100000; ++k) {
      const vec3 o = v3_scale(random.between(s.nearest, s.farthest), random.direction());
      vec3 target = random.inside_ball(s.radius);
      // Every second ray passes within 1e-2 to 1e-12 radii of tangent.
      if (k & 1) {
        const vec3 across = v3_unit(v3_cross(o, random.direction()));
        const double b = 1 + std::pow(10, random.between(-12, -2)) * (k & 2 ? 1 : -1);
        const double dist = v3_length(o);
        if (dist > 1.01 * s.radius) {
          const double sine = b * s.radius / dist;
          target = v3_add(v3_scale(1 - sine * sine, o),  // foot of the line with that moment
                          v3_scale(-1.0, o));
          target = v3_add(v3_scale(sine * sine, o),
                          v3_scale(dist * sine * std::sqrt(std::max(0.0, 1 - sine * sine)), across));
        }
      }
      const vec3 d = v3_unit(v3_sub(target, o));
      const auto exact = crossings(c, lift<Quad>(o), lift<Quad>(d));
      // The moment form's own limit: 8 half-ulps of the radius, whatever the distance.
      if (exact.margin < Quad(8 * kEps * s.radius)) {
        ++excluded;
        continue;
      }
      double t;
      u32 part;
      const int hit = shape_kernels::shape_intersect(c.row, c.p.data(), o, d, 1e300, &t, &part);
      const auto* first = exact.first_after_zero();
      wrong += hit != (first != nullptr);
      if (!hit || !first) continue;
      ++hits;
      const Vec<Quad> x = along(lift<Quad>(o), first->t, lift<Quad>(d));
      const double cosine = std::fabs(double(inner(x, lift<Quad>(d)))) / s.radius;
      const double error = std::fabs(double(Quad(t) - first->t));
      // Rounding of b costs 2^-53·|o|, rounding of the half chord 2^-53·r/cos.
      const double unit = kEps * (v3_length(o) + s.radius / cosine);
      (cosine > 1e-2 ? worst : worst_grazing) = std::max(cosine > 1e-2 ? worst : worst_grazing, error / unit);
    }
    INFO("radius " << s.radius << " from " << s.nearest << " to " << s.farthest);
    CHECK(wrong == 0);
    CHECK(hits > 40000);
    CHECK(excluded < 20);
    CHECK(worst < s.bound);
    CHECK(worst_grazing < s.bound);
    MESSAGE("sphere " << s.radius << " m at " << s.nearest << "-" << s.farthest << " m: worst " << worst
                      << " x 2^-53 (|o| + r/cos), grazing " << worst_grazing << ", hits " << hits << ", excluded "
                      << excluded);
  }
}

TEST_CASE("shapes: rays along the axis, through apex, rim and ends") {
  using namespace shape_kernels;
  double t;
  u32 part;
  const auto hit = [&](u32 row, std::vector<double> p, vec3 o, vec3 d, double t_max = 1e300) {
    t = -1;
    part = 99;
    return shape_intersect(row, p.data(), o, v3_unit(d), t_max, &t, &part);
  };
  // Cylinder, ray parallel to the axis: the ends if capped, nothing if open.
  CHECK(hit(CLRAY_SHAPE_cylinder, {1, 2, 1}, v3(0.5, 0, 5), v3(0, 0, -1)));
  CHECK((t == 4.0 && part == 2));
  CHECK(hit(CLRAY_SHAPE_cylinder, {1, 2, 1}, v3(0.5, 0, 0), v3(0, 0, -1)));
  CHECK((t == 1.0 && part == 1));
  CHECK_FALSE(hit(CLRAY_SHAPE_cylinder, {1, 2, 0}, v3(0.5, 0, 5), v3(0, 0, -1)));
  CHECK_FALSE(hit(CLRAY_SHAPE_cylinder, {1, 2, 1}, v3(1.5, 0, 5), v3(0, 0, -1)));
  // Through an open end onto the far side from within.
  CHECK(hit(CLRAY_SHAPE_cylinder, {1, 2, 0}, v3(-1, 0, 3), v3(1, 0, -1)));
  CHECK(t == doctest::Approx(2 * std::sqrt(2.0)).epsilon(1e-15));
  CHECK(part == 0);
  // Exactly through the rim: one hit.
  CHECK(hit(CLRAY_SHAPE_cylinder, {1, 2, 1}, v3(2, 0, 2), v3(-1, 0, -1)));
  CHECK(t == doctest::Approx(std::sqrt(2.0)).epsilon(1e-15));
  // Cone: down the axis onto the apex, up through the base, through the apex sideways, above the apex.
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 1}, v3(0, 0, 5), v3(0, 0, -1)));
  CHECK((t == 4.0 && part == 0));
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 0}, v3(0, 0, 5), v3(0, 0, -1)));
  CHECK(t == 4.0);
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 1}, v3(0.25, 0, -1), v3(0, 0, 1)));
  CHECK((t == 1.0 && part == 1));
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 0}, v3(0.25, 0, -1), v3(0, 0, 1)));
  CHECK((t == 1.75 && part == 0));
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 1}, v3(3, 0, 1), v3(-1, 0, 0)));
  CHECK(t == 3.0);
  CHECK_FALSE(hit(CLRAY_SHAPE_cone, {1, 1, 0, 1}, v3(3, 0, 1.001), v3(-1, 0, 0)));
  CHECK_FALSE(hit(CLRAY_SHAPE_cone, {1, 1, 0, 0}, v3(3, 0.5, 2), v3(-1, 0, 0)));  // the other nappe is not there
  CHECK(hit(CLRAY_SHAPE_cone, {1, 1, 0, 0}, v3(-1.5, 0.25, -1), v3(1, 0, 1)));    // parallel to a generator
  CHECK(t == doctest::Approx(1.6875 * std::sqrt(2.0)).epsilon(1e-15));
  CHECK_FALSE(hit(CLRAY_SHAPE_cone, {1, 1, 0, 0}, v3(-2, 0.25, -1), v3(1, 0, 1)));  // beside that generator
  // Paraboloid along its axis, from above (inside) and below (outside); over the rim.
  CHECK(hit(CLRAY_SHAPE_paraboloid, {1, 0.5}, v3(0.5, 0, 3), v3(0, 0, -1)));
  CHECK(t == 2.875);
  CHECK(hit(CLRAY_SHAPE_paraboloid, {1, 0.5}, v3(0.5, 0, -3), v3(0, 0, 1)));
  CHECK(t == 3.125);
  CHECK_FALSE(hit(CLRAY_SHAPE_paraboloid, {1, 0.5}, v3(1.5, 0, 3), v3(0, 0, -1)));
  CHECK_FALSE(hit(CLRAY_SHAPE_paraboloid, {1, 0.5}, v3(-3, 0, 0.5001), v3(1, 0, 0)));
  // Planes edge-on are not hit; a ray that starts on one does not hit it.
  CHECK_FALSE(hit(CLRAY_SHAPE_disk, {1, 0}, v3(-3, 0, 0), v3(1, 0, 0)));
  CHECK_FALSE(hit(CLRAY_SHAPE_rectangle, {1, 1}, v3(0.1, 0, 0), v3(0, 0, 1)));
  // t_max is included, what lies beyond it is not.
  CHECK(hit(CLRAY_SHAPE_box, {2, 2, 2}, v3(0, 0, 3), v3(0, 0, -1), 2.0));
  CHECK((t == 2.0 && part == 5));
  CHECK_FALSE(hit(CLRAY_SHAPE_box, {2, 2, 2}, v3(0, 0, 3), v3(0, 0, -1), 1.999));
}

TEST_CASE("open cone: rays steeper than the side, aimed at the apex from above, all hit") {
  // A steep ray near an apex crosses the nappe below it whatever its rounding, so not one may slip through.
  using namespace shape_kernels;
  const std::vector<double> p = {0.8, 0.5, 0, 0};
  Random random(15);
  long lost = 0;
  for (int k = 0; k < 20000; ++k) {
    const double angle = random.between(0, 1.0), phi = random.between(0, 2 * CLRAY_PI);  // side: 1.01 rad off the axis
    const vec3 d = v3(std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi), -std::cos(angle));
    double t;
    u32 part;
    lost += !shape_intersect(CLRAY_SHAPE_cone, p.data(), v3_fma(-random.between(0.1, 9), d, v3(0, 0, 0.5)), d, 1e300,
                             &t, &part);
  }
  CHECK(lost == 0);
}

TEST_CASE("shapes: scaling by 2^40 and 2^-40 changes no bit") {
  for (const Case& c : cases()) {
    for (const double scale : {0x1p40, 0x1p-40}) {
      Random random(14);
      Case scaled = c;
      const bool flag = c.row == shape_kernels::CLRAY_SHAPE_cylinder || c.row == shape_kernels::CLRAY_SHAPE_cone;
      for (std::size_t k = 0; k < c.p.size() - (flag ? 1 : 0); ++k) scaled.p[k] *= scale;
      long different = 0;
      for (int k = 0; k < 3000; ++k) {
        const RayOf ray = random_ray(random, c, 10);
        double t = 0, t_scaled = 0;
        u32 part = 0, part_scaled = 0;
        const int hit = shape_kernels::shape_intersect(c.row, c.p.data(), ray.o, ray.d, 1e300, &t, &part);
        const int hit_scaled = shape_kernels::shape_intersect(c.row, scaled.p.data(), v3_scale(scale, ray.o), ray.d,
                                                              1e300, &t_scaled, &part_scaled);
        different += hit != hit_scaled || part != part_scaled || t * scale != t_scaled;
      }
      INFO(c.name);
      CHECK(different == 0);
    }
  }
}
