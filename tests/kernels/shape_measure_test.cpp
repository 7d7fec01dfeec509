// SPDX-License-Identifier: Apache-2.0
// Support, area and traits of the shapes against sampling, optimisation and polyhedra; choosing by row against calling
// directly.
#include <doctest/doctest.h>

#include "kernels/shape_model.hpp"
#include "scene/tables.hpp"

namespace {
using namespace shape_model;

bool flat_faces(const Case& c) {
  return c.row == shape_kernels::CLRAY_SHAPE_box || c.row == shape_kernels::CLRAY_SHAPE_rectangle;
}

/// A search uphill from a point of a face that halves its step to 1e-9 (quadratic maxima are then met to 1e-17).
double climb(const Case& c, vec3 u, int face, double a, double b) {
  // The azimuth first: off its maximum a wrong end of the shape may look higher.
  for (double step = 1.0 / 40; step > 1e-9; step *= 0.5) {
    for (const double to : {b - step, b + step, b - step, b + step}) {
      const double at = std::clamp(to, -0.5, 1.5);
      if (v3_dot(surface_at(c, face, a, at), u) > v3_dot(surface_at(c, face, a, b), u) && !flat_faces(c)) b = at;
    }
  }
  const bool round = !flat_faces(c);
  double best = v3_dot(surface_at(c, face, a, b), u);
  for (double step = 1.0 / 40; step > 1e-9;) {
    const double from_a = a, from_b = b;
    bool moved = false;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const double to_a = std::clamp(from_a + i * step, 0.0, 1.0);
        const double to_b = round ? from_b + j * step : std::clamp(from_b + j * step, 0.0, 1.0);
        const double value = v3_dot(surface_at(c, face, to_a, to_b), u);
        if (value > best) best = value, a = to_a, b = to_b, moved = true;
      }
    }
    if (!moved) step *= 0.5;
  }
  return best;
}

/// Largest x·u over the shape: uphill from the best azimuth of both ends and the middle of each face.
double sampled_support(const Case& c, vec3 u) {
  double best = -1e300;
  for (int face = 0; face < faces(c); ++face) {
    for (const double a : {0.0, 0.5, 1.0}) {
      double start = 0, most = -1e300;
      for (int j = 0; j <= 40; ++j) {
        const double value = v3_dot(surface_at(c, face, a, j / 40.0), u);
        if (value > most) most = value, start = j / 40.0;
      }
      best = std::max(best, climb(c, u, face, a, start));
    }
  }
  return best;
}

/// Area of the triangles on an n by n grid of each face.
double grid_area(const Case& c, int n) {
  double area = 0;
  for (int face = 0; face < faces(c); ++face) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double a = double(i) / n, b = double(i + 1) / n, e = double(j) / n, f = double(j + 1) / n;
        const vec3 x = surface_at(c, face, a, e), y = surface_at(c, face, b, e);
        const vec3 z = surface_at(c, face, b, f), w = surface_at(c, face, a, f);
        area +=
            0.5 * (v3_length(v3_cross(v3_sub(y, x), v3_sub(z, x))) + v3_length(v3_cross(v3_sub(z, x), v3_sub(w, x))));
      }
    }
  }
  return area;
}

}  // namespace

TEST_CASE("support is never exceeded and met to 1e-12") {
  for (const Case& c : cases()) {
    Random random(31);
    double over = 0, under = 0;
    for (int k = 0; k < 150; ++k) {
      vec3 u = random.direction();
      if (k < 6) u = v3(k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0, k == 4 ? 1 : k == 5 ? -1 : 0);
      if (k % 2) u = v3_scale(random.between(0.1, 10), u);
      const double length = v3_length(u) * c.size;
      const double h = shape_kernels::shape_support(c.row, c.p.data(), u);
      const double sampled = sampled_support(c, u);
      over = std::max(over, (sampled - h) / length);
      under = std::max(under, (h - sampled) / length);
    }
    INFO(c.name << ": over " << over << ", under " << under);
    CHECK(over < 8 * 2 * kEps);  // rounding of both sides
    CHECK(under < 1e-12);
  }
}

TEST_CASE("area agrees with refined polyhedra") {
  for (const Case& c : cases()) {
    // Polyhedra converge as h² (h⁴ after extrapolating twice the refinement): 1e-7 is what 256² leaves.
    const double coarse = grid_area(c, 128), fine = grid_area(c, 256);
    const double area = (4 * fine - coarse) / 3;
    INFO(c.name << ": " << area);
    CHECK(shape_kernels::shape_area(c.row, c.p.data()) == doctest::Approx(area).epsilon(1e-7));
  }
  // A nearly flat dish: the disk's area and the first term of its series, pi·(R² + D²).
  const double flat[2] = {1.0, 1e-5};
  CHECK(shape_kernels::shape_paraboloid_area(flat) == doctest::Approx(CLRAY_PI * (1 + 1e-10)).epsilon(4e-16));
}

TEST_CASE("traits: closed and convex only with ends, planes are planes") {
  for (const Case& c : cases()) {
    const int expected =
        c.plane ? CLRAY_SHAPE_CONVEX | CLRAY_SHAPE_PLANE : (c.capped ? CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX : 0);
    INFO(c.name);
    CHECK(shape_kernels::shape_traits(c.row, c.p.data()) == expected);
  }
}

TEST_CASE("a row states whether every face of its shape is flat") {
  for (const Case& c : cases()) {
    bool flat = true;
    for (int face = 0; face < faces(c); ++face) {
      const vec3 a = surface_at(c, face, 0.3, 0.1);
      const vec3 n =
          v3_unit(v3_cross(v3_sub(surface_at(c, face, 0.9, 0.2), a), v3_sub(surface_at(c, face, 0.8, 0.4), a)));
      for (int k = 0; k < 100; ++k) {
        const vec3 x = surface_at(c, face, (k % 10 + 0.5) / 10, (k / 10 + 0.5) / 10);
        // Of points within the size, by a normal made of differences of at least a hundredth of it: 1e-12 holds
        // their rounding. The flattest curved face, a cone's, bends by some 1e-3 of the size.
        flat = flat && std::fabs(v3_dot(v3_sub(x, a), n)) < 1e-12 * c.size;
      }
    }
    INFO(c.name);
    CHECK(clray::table("shape")[c.row].flat == flat);
  }
}

TEST_CASE("choosing by row calls the shape of that row, and none for a row that is not there") {
  using namespace shape_kernels;
  const vec3 o = v3(0.1, 0.05, 4), d = v3_unit(v3(0.01, -0.02, -1));
  for (const Case& c : cases()) {
    double t = 0, t_direct = 0;
    u32 part = 0, part_direct = 0;
    const double* p = c.p.data();
    const int hit = shape_intersect(c.row, p, o, d, 1e300, &t, &part);
    int direct = -1;
    switch (c.row) {
#define CLRAY_TEST_CASE(id)                                                   \
  case CLRAY_SHAPE_##id:                                                      \
    direct = shape_##id##_intersect(p, o, d, 1e300, &t_direct, &part_direct); \
    break;
      CLRAY_SHAPES(CLRAY_TEST_CASE)
#undef CLRAY_TEST_CASE
      default:
        break;
    }
    CHECK(hit == direct);
    CHECK(t == t_direct);
    CHECK(part == part_direct);
  }
  double t;
  u32 part;
  const double p[3] = {1, 1, 1};
  CHECK_FALSE(shape_intersect(CLRAY_SHAPE_triangle, p, o, d, 1e300, &t, &part));
}
