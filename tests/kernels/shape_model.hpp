// SPDX-License-Identifier: Apache-2.0
// The shapes once more, for the tests: implicit functions, z limits and parametrisations in any number type, written
// without the kernels' formulas. A quadratic along a ray is found from three values of the implicit function and
// solved by the textbook formula; in __float128 that leaves 1e-34, so it stands for the exact answer.
#ifndef CLRAY_TESTS_SHAPE_MODEL_HPP
#define CLRAY_TESTS_SHAPE_MODEL_HPP

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "shape/shape.h"
#include "shape/span.h"
#include "shared/abi.h"

namespace shape_kernels {
// clang-format off: the shapes come before what chooses among them
#define SHAPE(id, ...) CLRAY_SHAPE_##id,
enum ShapeRow : u32 {
#include "shape/shape.def"
};
#undef SHAPE
#include "shape/box.cl"
#include "shape/cone.cl"
#include "shape/cylinder.cl"
#include "shape/disk.cl"
#include "shape/paraboloid.cl"
#include "shape/rectangle.cl"
#include "shape/sphere.cl"
#define CLRAY_SHAPES(X) X(sphere) X(cylinder) X(disk) X(cone) X(paraboloid) X(rectangle) X(box)
#include "shape/dispatch.cl"
// clang-format on
}  // namespace shape_kernels

namespace shape_model {

constexpr double kEps = 0x1p-53;
__extension__ typedef __float128 Quad;

template <class T>
struct Vec {
  T x, y, z;
};
template <class T>
Vec<T> lift(vec3 a) {
  return {T(a.x), T(a.y), T(a.z)};
}
template <class T>
T inner(Vec<T> a, Vec<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec<T> along(Vec<T> o, T t, Vec<T> d) {
  return {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z};
}
template <class T>
T root(T x) {
  if (!(x > 0)) return 0;
  T s = T(std::sqrt((long double)x));
  for (int k = 0; k < 2; ++k) s = (s + x / s) / 2;
  return s;
}
template <class T>
T magnitude(T x) {
  return x < 0 ? -x : x;
}

struct Case {
  std::string name;
  u32 row;
  std::vector<double> p;
  double size;  // radius of a sphere about the origin that holds it
  bool capped;  // ends (or, for the box, faces) close it
  bool plane;
};

inline std::vector<Case> cases() {
  using namespace shape_kernels;
  return {{"sphere", CLRAY_SHAPE_sphere, {0.7}, 0.7, true, false},
          {"cylinder", CLRAY_SHAPE_cylinder, {0.3, 1.7, 1}, 0.91, true, false},
          {"open cylinder", CLRAY_SHAPE_cylinder, {0.6, 0.9, 0}, 0.76, false, false},
          {"flat cylinder", CLRAY_SHAPE_cylinder, {1.1, 0.01, 1}, 1.11, true, false},
          {"cone", CLRAY_SHAPE_cone, {0.8, 1.3, 0, 1}, 1.3, true, false},
          {"open cone", CLRAY_SHAPE_cone, {0.8, 0.5, 0, 0}, 0.8, false, false},
          {"frustum", CLRAY_SHAPE_cone, {0.9, 0.7, 0.31, 1}, 0.9, true, false},
          {"open frustum", CLRAY_SHAPE_cone, {0.4, 1.1, 0.7, 0}, 1.31, false, false},
          {"straight frustum", CLRAY_SHAPE_cone, {0.5, 0.7, 0.5, 1}, 0.87, true, false},
          {"needle", CLRAY_SHAPE_cone, {0.003, 1.0, 0, 1}, 1.0, true, false},
          {"dish", CLRAY_SHAPE_paraboloid, {0.6, 0.2}, 0.64, false, false},
          {"deep dish", CLRAY_SHAPE_paraboloid, {0.3, 1.4}, 1.44, false, false},
          {"disk", CLRAY_SHAPE_disk, {0.9, 0}, 0.9, false, true},
          {"annulus", CLRAY_SHAPE_disk, {0.9, 0.4}, 0.9, false, true},
          {"rectangle", CLRAY_SHAPE_rectangle, {1.2, 0.3}, 0.62, false, true},
          {"box", CLRAY_SHAPE_box, {0.5, 1.1, 0.8}, 0.73, true, false},
          {"thin box", CLRAY_SHAPE_box, {1.3, 0.001, 0.4}, 0.69, true, false}};
}

/// The curved part {f = 0, low <= z <= high} of a shape; gradient of f for distances.
template <class T>
struct Curved {
  u32 row;
  T p0, p1, p2;
  T low, high;
  explicit Curved(const Case& c)
      : row(c.row), p0(c.p[0]), p1(c.p.size() > 1 ? c.p[1] : 0), p2(c.p.size() > 2 ? c.p[2] : 0) {
    using namespace shape_kernels;
    low = row == CLRAY_SHAPE_cylinder ? -p1 / 2 : (row == CLRAY_SHAPE_cone ? T(0) : T(-1e30));
    high = row == CLRAY_SHAPE_cylinder ? p1 / 2
                                       : (row == CLRAY_SHAPE_cone || row == CLRAY_SHAPE_paraboloid ? p1 : T(1e30));
  }
  T radius(T z) const { return row == shape_kernels::CLRAY_SHAPE_cone ? p0 + (p2 - p0) * z / p1 : p0; }
  T f(Vec<T> x) const {
    using namespace shape_kernels;
    const T rho2 = x.x * x.x + x.y * x.y;
    if (row == CLRAY_SHAPE_sphere) return rho2 + x.z * x.z - p0 * p0;
    if (row == CLRAY_SHAPE_paraboloid) return rho2 - p0 * p0 / p1 * x.z;
    return rho2 - radius(x.z) * radius(x.z);
  }
  Vec<T> gradient(Vec<T> x) const {
    using namespace shape_kernels;
    if (row == CLRAY_SHAPE_sphere) return {2 * x.x, 2 * x.y, 2 * x.z};
    if (row == CLRAY_SHAPE_paraboloid) return {2 * x.x, 2 * x.y, -p0 * p0 / p1};
    const T slope = row == CLRAY_SHAPE_cone ? (p2 - p0) / p1 : T(0);
    return {2 * x.x, 2 * x.y, -2 * radius(x.z) * slope};
  }
  /// Signed distance to first order, positive outside.
  T distance(Vec<T> x) const {
    const Vec<T> g = gradient(x);
    const T length = root(inner(g, g));
    return length > 0 ? f(x) / length : T(0);
  }
};

template <class T>
struct Crossing {
  T t;
  u32 part;
};

/// All crossings of a line with a shape, by increasing t, and how near (m) any decision about them was.
template <class T>
struct Crossings {
  std::vector<Crossing<T>> list;
  T margin = 1e30;
  void near(T m) { margin = std::min(margin, magnitude(m)); }
  const Crossing<T>* first_after_zero() const {
    for (const auto& c : list)
      if (c.t > 0) return &c;
    return nullptr;
  }
};

template <class T>
void cross_curved(const Case& c, Vec<T> o, Vec<T> d, Crossings<T>* out) {
  const Curved<T> s(c);
  const T step = 1 + magnitude(o.x) + magnitude(o.y) + magnitude(o.z);  // as far as the origin: a keeps its digits
  const T f0 = s.f(o), f1 = s.f(along(o, step, d)), f2 = s.f(along(o, -step, d));
  const T a = ((f1 + f2) / 2 - f0) / (step * step), b = (f1 - f2) / (4 * step);
  std::vector<T> roots;
  if (magnitude(a) < T(1e-26)) {
    if (b != 0) roots = {-f0 / (2 * b)};
    out->near(a == 0 ? T(1e30) : a);  // the formula below would lose the far root: leave such rays out
  } else {
    const T disc = b * b - a * f0;
    out->near(s.distance(along(o, -b / a, d)));
    if (disc >= 0) roots = {(-b - root(disc)) / a, (-b + root(disc)) / a};
  }
  for (const T t : roots) {
    const Vec<T> x = along(o, t, d);
    out->near(x.z - s.low);
    out->near(x.z - s.high);
    if (x.z < s.low || x.z > s.high || s.radius(x.z) < 0) continue;
    out->list.push_back({t, 0});
  }
}

template <class T>
void cross_disk(T z, T radius, T inner_radius, u32 part, Vec<T> o, Vec<T> d, Crossings<T>* out) {
  if (d.z == 0) return;
  const T t = (z - o.z) / d.z;
  const Vec<T> x = along(o, t, d);
  const T rho = root(x.x * x.x + x.y * x.y);
  out->near(rho - radius);
  if (inner_radius > 0) out->near(rho - inner_radius);
  if (rho <= radius && rho >= inner_radius) out->list.push_back({t, part});
}

template <class T>
void cross_face(int axis, T at, Vec<T> half, u32 part, Vec<T> o, Vec<T> d, Crossings<T>* out) {
  const T oo[3] = {o.x, o.y, o.z}, dd[3] = {d.x, d.y, d.z}, hh[3] = {half.x, half.y, half.z};
  if (dd[axis] == 0) return;
  const T t = (at - oo[axis]) / dd[axis];
  bool in = true;
  for (int k = 0; k < 3; ++k) {
    if (k == axis) continue;
    const T x = oo[k] + t * dd[k];
    out->near(magnitude(x) - hh[k]);
    in = in && magnitude(x) <= hh[k];
  }
  if (in) out->list.push_back({t, part});
}

template <class T>
Crossings<T> crossings(const Case& c, Vec<T> o, Vec<T> d) {
  using namespace shape_kernels;
  Crossings<T> out;
  if (c.row == CLRAY_SHAPE_disk) {
    cross_disk(T(0), T(c.p[0]), T(c.p[1]), 0, o, d, &out);
  } else if (c.row == CLRAY_SHAPE_rectangle) {
    cross_face(2, T(0), Vec<T>{T(c.p[0]) / 2, T(c.p[1]) / 2, T(0)}, 0, o, d, &out);
  } else if (c.row == CLRAY_SHAPE_box) {
    const Vec<T> half{T(c.p[0]) / 2, T(c.p[1]) / 2, T(c.p[2]) / 2};
    const T h[3] = {half.x, half.y, half.z};
    for (u32 k = 0; k < 6; ++k) cross_face(int(k / 2), k & 1 ? h[k / 2] : -h[k / 2], half, k, o, d, &out);
  } else {
    cross_curved(c, o, d, &out);
    if (c.capped && c.row != CLRAY_SHAPE_sphere) {
      const Curved<T> s(c);
      cross_disk(s.low, s.radius(s.low), T(-1), 1, o, d, &out);
      if (s.radius(s.high) > 0) cross_disk(s.high, s.radius(s.high), T(-1), 2, o, d, &out);
    }
  }
  std::sort(out.list.begin(), out.list.end(), [](auto a, auto b) { return a.t < b.t; });
  return out;
}

/// Signed distance (positive on the side of the outward normal) of x from the part of the surface it belongs to.
template <class T>
T signed_distance(const Case& c, u32 part, Vec<T> x) {
  using namespace shape_kernels;
  if (c.row == CLRAY_SHAPE_disk || c.row == CLRAY_SHAPE_rectangle) return x.z;
  if (c.row == CLRAY_SHAPE_box) {
    const T v[3] = {x.x, x.y, x.z};
    const T h = T(c.p[part / 2]) / 2;
    return part & 1 ? v[part / 2] - h : -v[part / 2] - h;
  }
  const Curved<T> s(c);
  if (part == 0) return s.distance(x);
  return part == 1 ? s.low - x.z : x.z - s.high;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return double(engine_() >> 11) * 0x1p-53; }
  double between(double a, double b) { return a + (b - a) * uniform(); }
  vec3 direction() {
    const double z = between(-1, 1), phi = between(0, 2 * CLRAY_PI), s = std::sqrt(1 - z * z);
    return v3_unit(v3(s * std::cos(phi), s * std::sin(phi), z));
  }
  vec3 inside_ball(double r) {
    for (;;) {
      const vec3 x = v3(between(-r, r), between(-r, r), between(-r, r));
      if (v3_length(x) <= r) return x;
    }
  }

 private:
  std::mt19937_64 engine_;
};

struct RayOf {
  vec3 o, d;
};

/// A point of face `face` (0 side or only one, then ends; six of a box) at u, v in [0,1].
inline vec3 surface_at(const Case& c, int face, double u, double v) {
  using namespace shape_kernels;
  const double phi = 2 * CLRAY_PI * v, cp = std::cos(phi), sp = std::sin(phi);
  const auto& p = c.p;
  if (c.row == CLRAY_SHAPE_sphere) {
    const double theta = CLRAY_PI * u;
    return v3(p[0] * std::sin(theta) * cp, p[0] * std::sin(theta) * sp, p[0] * std::cos(theta));
  }
  if (c.row == CLRAY_SHAPE_disk) {
    const double rho = p[1] + (p[0] - p[1]) * u;
    return v3(rho * cp, rho * sp, 0);
  }
  if (c.row == CLRAY_SHAPE_rectangle) return v3(p[0] * (u - 0.5), p[1] * (v - 0.5), 0);
  if (c.row == CLRAY_SHAPE_box) {
    double x[3];
    const int axis = face / 2;
    x[axis] = (face & 1 ? 0.5 : -0.5) * p[axis];
    x[(axis + 1) % 3] = (u - 0.5) * p[(axis + 1) % 3];
    x[(axis + 2) % 3] = (v - 0.5) * p[(axis + 2) % 3];
    return v3(x[0], x[1], x[2]);
  }
  if (c.row == CLRAY_SHAPE_paraboloid) return v3(p[0] * u * cp, p[0] * u * sp, p[1] * u * u);
  const double low = c.row == CLRAY_SHAPE_cone ? 0 : -0.5 * p[1];
  const double bottom = p[0], top = c.row == CLRAY_SHAPE_cone ? p[2] : p[0];
  const double rho = face == 0 ? bottom + (top - bottom) * u : (face == 1 ? bottom : top) * u;
  return v3(rho * cp, rho * sp, face == 0 ? low + p[1] * u : (face == 1 ? low : low + p[1]));
}

inline int faces(const Case& c) {
  if (c.row == shape_kernels::CLRAY_SHAPE_box) return 6;
  if (c.row == shape_kernels::CLRAY_SHAPE_cone && c.capped && c.p[2] == 0) return 2;  // no disk at an apex
  return c.capped && c.row != shape_kernels::CLRAY_SHAPE_sphere ? 3 : 1;
}

/// A ray from within `reach` sizes that passes within 1.1 sizes of the origin; every other one is aimed at the surface.
inline RayOf random_ray(Random& random, const Case& c, double reach) {
  vec3 target = random.inside_ball(1.1 * c.size);
  if (random.uniform() < 0.5)
    target = surface_at(c, int(random.uniform() * faces(c)), random.uniform(), random.uniform());
  const vec3 o = v3_scale(c.size * std::exp2(random.between(0.2, std::log2(reach))), random.direction());
  return {o, v3_unit(v3_sub(target, o))};
}

}  // namespace shape_model

#endif
