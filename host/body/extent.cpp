// SPDX-License-Identifier: Apache-2.0
// How far a body, or one shape of it, reaches in a direction; see geometry.hpp.
#include <algorithm>
#include <cmath>

#include "body/geometry.hpp"
#include "body/portable_tables.hpp"
#include "scene/tables.hpp"

namespace clray {

Point rotated(const std::array<double, 9>& m, const Point& x) {
  return {{std::fma(m[0], x[0], std::fma(m[1], x[1], m[2] * x[2])),
           std::fma(m[3], x[0], std::fma(m[4], x[1], m[5] * x[2])),
           std::fma(m[6], x[0], std::fma(m[7], x[1], m[8] * x[2]))}};
}

namespace {

/// direction·x_body = (R·direction)·(x_part − translation): R·direction, and what to take off.
Point direction_in_part(const RigidMotion& motion, const Point& direction, double* shift) {
  const Point u = rotated(motion.rotation, direction), &t = motion.translation;
  *shift = std::fma(u[0], t[0], std::fma(u[1], t[1], u[2] * t[2]));
  return u;
}

}  // namespace

void shape_extent(const Geometry& geometry, int row, std::uint32_t data, const RigidMotion& motion,
                  const Point& direction, double* low, double* high) {
  double shift = 0.0;
  const Point u = direction_in_part(motion, direction, &shift);
  const double* d = geometry.shapes.data() + data;
  const std::array<double, 9> m{{d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8]}};
  const Point local = rotated(m, u), away{{-local[0], -local[1], -local[2]}};
  const double origin = std::fma(u[0], d[CLRAY_SHAPE_ORIGIN],
                                 std::fma(u[1], d[CLRAY_SHAPE_ORIGIN + 1], u[2] * d[CLRAY_SHAPE_ORIGIN + 2])) -
                        shift;
  const double scale = d[CLRAY_SHAPE_SCALE];
  *high = std::fma(scale, shape_support_of(row, d + CLRAY_SHAPE_KEYS, local.data()), origin);
  *low = std::fma(-scale, shape_support_of(row, d + CLRAY_SHAPE_KEYS, away.data()), origin);
}

double primitive_area(const Geometry& geometry, const ClrayPrimitive& primitive) {
  static const std::vector<TableRow>& shapes = table("shape");  // looked up once: bodies have millions of primitives
  const double* d = geometry.shapes.data() + primitive.data;
  if (!shapes[primitive.shape].faces)
    return shape_area_of(static_cast<int>(primitive.shape), d + CLRAY_SHAPE_KEYS) * d[CLRAY_SHAPE_SCALE] *
           d[CLRAY_SHAPE_SCALE];
  return 0.5 * v3_length(v3_cross(v3_sub(v3_load(d + 3), v3_load(d)), v3_sub(v3_load(d + 6), v3_load(d))));
}

void body_extent(const Geometry& geometry, const std::vector<RigidMotion>& motions, const Point& direction, double* low,
                 double* high) {
  *low = 1e300;
  *high = -1e300;
  for (std::size_t p = 0; p < geometry.parts.size(); ++p) {
    const Part& part = geometry.parts[p];
    double shift = 0.0;
    const Point u = direction_in_part(motions[p], direction, &shift);
    for (const Point& x : part.points) {
      const double d = std::fma(u[0], x[0], std::fma(u[1], x[1], u[2] * x[2])) - shift;
      *low = std::min(*low, d);
      *high = std::max(*high, d);
    }
    for (std::size_t k = 0; k < part.shapes.size(); ++k) {
      double least = 0.0, greatest = 0.0;
      shape_extent(geometry, part.shape_rows[k], part.shapes[k], motions[p], direction, &least, &greatest);
      *low = std::min(*low, least);
      *high = std::max(*high, greatest);
    }
  }
}

}  // namespace clray
