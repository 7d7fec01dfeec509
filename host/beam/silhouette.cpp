// SPDX-License-Identifier: Apache-2.0
// A conservative rasteriser with a depth buffer (see silhouette.hpp).
#include "beam/silhouette.hpp"

#include <algorithm>
#include <cmath>

#include "body/portable_tables.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kMostTests = 1ull << 27;  // of primitives against cells: about a second of work
constexpr int kDirections = 32;                   // half-planes that bound an analytic shape's silhouette

/// A point in the beam's axes.
struct Corner {
  double u, v, w;
};

class Rasteriser {
 public:
  Rasteriser(const Geometry& geometry, const std::vector<RigidMotion>& motions, const BeamGrid& grid)
      : geometry_(geometry), motions_(motions), grid_(grid), n_(grid.cells) {
    cells_.resize(static_cast<std::size_t>(n_) * n_);
    cell_u_ = grid.size_u / n_;
    cell_v_ = grid.size_v / n_;
    // Larger than all rounding from here to the device's ray.
    margin_ = 1e-9 * (grid.size_u + grid.size_v) + 1e-14 * (std::fabs(grid.u0) + std::fabs(grid.v0) + geometry.radius);
  }

  std::vector<BeamCell> cells() {
    const std::vector<TableRow>& shapes = table("shape");
    for (std::size_t k = 0; k < geometry_.primitives.size(); ++k) {
      const ClrayPrimitive& primitive = geometry_.primitives[k];
      const double* data = geometry_.shapes.data() + primitive.data;
      const RigidMotion& motion = motions_[geometry_.part_of_component[primitive.component]];
      primitive_ = static_cast<std::uint32_t>(k);
      if (shapes[primitive.shape].faces) {
        triangle(corner(motion, data), corner(motion, data + 3), corner(motion, data + 6));
      } else {
        shape(primitive, motion, data);
      }
      if (tests_ > kMostTests) return {};
    }
    return std::move(cells_);
  }

 private:
  /// A point of a part, in the beam's axes.
  Corner corner(const RigidMotion& motion, const double* x) const {
    const Point p = motion.back({{x[0], x[1], x[2]}});
    const vec3 body = v3(p[0], p[1], p[2]);
    return {v3_dot(grid_.u, body), v3_dot(grid_.v, body), v3_dot(grid_.toward, body)};
  }

  int column(double u) const { return clamp_cell((u - grid_.u0) / cell_u_); }
  int row(double v) const { return clamp_cell((v - grid_.v0) / cell_v_); }
  int clamp_cell(double x) const {
    return static_cast<int>(std::clamp(std::floor(x), 0.0, static_cast<double>(n_ - 1)));
  }

  /// Of equally near surfaces the one that shows its front wins, then the smaller canonical id, as with hits.
  void mark(std::size_t at, BeamCell::State state, double w, const vec3& normal) {
    BeamCell& cell = cells_[at];
    if (state < cell.state) return;
    if (state == cell.state) {
      const double same = geometry_.shared_planes ? 1e-12 * geometry_.radius : 0.0;
      if (w < cell.w - same) return;
      if (w <= cell.w + same) {
        const bool back = normal.z < 0.0;
        if (back != cell.back ? back : geometry_.primitives[primitive_].id > geometry_.primitives[cell.primitive].id)
          return;
      }
    }
    cell.state = state;
    cell.primitive = primitive_;
    cell.w = w;
    cell.back = normal.z < 0.0;
    cell.normal = cell.back ? v3_neg(normal) : normal;
  }

  void triangle(const Corner& a, const Corner& b, const Corner& c) {
    const vec3 normal = v3_cross(v3(b.u - a.u, b.v - a.v, b.w - a.w), v3(c.u - a.u, c.v - a.v, c.w - a.w));
    if (v3_dot(normal, normal) == 0.0) return;  // without area: no ray can hit it
    const double low_u = std::min({a.u, b.u, c.u}) - margin_, high_u = std::max({a.u, b.u, c.u}) + margin_;
    const double low_v = std::min({a.v, b.v, c.v}) - margin_, high_v = std::max({a.v, b.v, c.v}) + margin_;
    const int i0 = column(low_u), i1 = column(high_u), j0 = row(low_v), j1 = row(high_v);
    tests_ += static_cast<std::uint64_t>(i1 - i0 + 1) * static_cast<std::uint64_t>(j1 - j0 + 1);
    if (tests_ > kMostTests) return;
    const Corner* p[3] = {&a, &b, &c};
    struct Axis {
      double x, y, low, high, half;
    } axes[3];
    for (int k = 0; k < 3; ++k) {
      const Corner &from = *p[k], &to = *p[(k + 1) % 3];
      Axis& axis = axes[k];
      axis.x = from.v - to.v;
      axis.y = to.u - from.u;
      double low = 1e300, high = -1e300;
      for (const Corner* q : p) {
        const double d = axis.x * q->u + axis.y * q->v;
        low = std::min(low, d);
        high = std::max(high, d);
      }
      const double slack = margin_ * (std::fabs(axis.x) + std::fabs(axis.y));
      axis.low = low - slack;
      axis.high = high + slack;
      axis.half = 0.5 * (std::fabs(axis.x) * cell_u_ + std::fabs(axis.y) * cell_v_);
    }
    const double w = (a.w + b.w + c.w) / 3.0;
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        const double u = grid_.u0 + (i + 0.5) * cell_u_, v = grid_.v0 + (j + 0.5) * cell_v_;
        bool apart = false;
        for (const Axis& axis : axes) {
          const double d = axis.x * u + axis.y * v;
          apart = apart || d + axis.half < axis.low || d - axis.half > axis.high;
        }
        if (apart) continue;
        const std::size_t cell = static_cast<std::size_t>(j) * n_ + i;
        const double x = (u - a.u) * (c.v - a.v) - (v - a.v) * (c.u - a.u);
        const double y = (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
        const double s = x / normal.z, t = y / normal.z;
        if (normal.z != 0.0 && s >= 0.0 && t >= 0.0 && s + t <= 1.0) {
          mark(cell, BeamCell::centred, a.w + s * (b.w - a.w) + t * (c.w - a.w), normal);
        } else {
          mark(cell, BeamCell::touched, w, normal);
        }
      }
    }
  }

  // A shape's silhouette lies in the half-planes that its support function gives; its depth comes from its own ray
  // test.
  void shape(const ClrayPrimitive& primitive, const RigidMotion& motion, const double* data) {
    const std::array<double, 9>& m = motion.rotation;
    const auto to_local = [&](const vec3& d) {  // direction: beam/body -> part -> shape
      const double p[3] = {m[0] * d.x + m[1] * d.y + m[2] * d.z, m[3] * d.x + m[4] * d.y + m[5] * d.z,
                           m[6] * d.x + m[7] * d.y + m[8] * d.z};
      return v3(data[0] * p[0] + data[1] * p[1] + data[2] * p[2], data[3] * p[0] + data[4] * p[1] + data[5] * p[2],
                data[6] * p[0] + data[7] * p[1] + data[8] * p[2]);
    };
    const Corner origin = corner(motion, data + CLRAY_SHAPE_ORIGIN);
    const double scale = data[CLRAY_SHAPE_SCALE];
    struct HalfPlane {
      double x, y, high, half;
    } planes[kDirections];
    for (int k = 0; k < kDirections; ++k) {
      // The directions need not be even, so points on the edge of a square will do; they need no trigonometry.
      const double f = 8.0 * k / kDirections;
      const int side = static_cast<int>(f) / 2;
      const double g = f - 2.0 * side - 1.0;
      const double x = side == 0 ? 1.0 : side == 1 ? -g : side == 2 ? -1.0 : g;
      const double y = side == 0 ? g : side == 1 ? 1.0 : side == 2 ? -g : -1.0;
      const vec3 local = to_local(v3_fma(x, grid_.u, v3_scale(y, grid_.v)));
      const double direction[3] = {local.x, local.y, local.z};
      HalfPlane& plane = planes[k];
      plane.x = x;
      plane.y = y;
      plane.high = x * origin.u + y * origin.v +
                   scale * shape_support_of(static_cast<int>(primitive.shape), data + CLRAY_SHAPE_KEYS, direction) +
                   2.0 * margin_;
      plane.half = 0.5 * (std::fabs(x) * cell_u_ + std::fabs(y) * cell_v_);
    }
    tests_ += static_cast<std::uint64_t>(n_) * n_ * 4;
    const vec3 d = to_local(v3_neg(grid_.toward)), lu = to_local(grid_.u), lv = to_local(grid_.v);
    const double start = 4.0 * geometry_.radius / scale;
    for (std::uint32_t j = 0; j < n_; ++j) {
      for (std::uint32_t i = 0; i < n_; ++i) {
        const double u = grid_.u0 + (i + 0.5) * cell_u_, v = grid_.v0 + (j + 0.5) * cell_v_;
        bool apart = false;
        for (const HalfPlane& plane : planes) {
          apart = plane.x * u + plane.y * v - plane.half > plane.high;
          if (apart) break;
        }
        if (apart) continue;
        const vec3 o = v3_fma((u - origin.u) / scale, lu, v3_fma((v - origin.v) / scale, lv, v3_scale(-start, d)));
        const std::size_t cell = static_cast<std::size_t>(j) * n_ + i;
        double t;
        vec3 normal;
        if (shape_hit_of(static_cast<int>(primitive.shape), data + CLRAY_SHAPE_KEYS, o, d, &t, &normal)) {
          mark(cell, BeamCell::centred, origin.w + scale * (start - t),
               v3(v3_dot(normal, lu), v3_dot(normal, lv), -v3_dot(normal, d)));
        } else {
          mark(cell, BeamCell::touched, origin.w, v3(0.0, 0.0, 0.0));
        }
      }
    }
  }

  const Geometry& geometry_;
  const std::vector<RigidMotion>& motions_;
  const BeamGrid& grid_;
  std::uint32_t n_, primitive_ = 0;
  double cell_u_ = 0.0, cell_v_ = 0.0, margin_ = 0.0;
  std::uint64_t tests_ = 0;
  std::vector<BeamCell> cells_;
};

}  // namespace

std::uint32_t grid_cells(std::size_t views) {
  std::uint32_t cells = 64;
  while (cells > 8 && static_cast<std::uint64_t>(views) * cells * cells > 1u << 24) cells /= 2;
  return cells;
}

std::vector<BeamCell> silhouette_cells(const Geometry& geometry, const std::vector<RigidMotion>& motions,
                                       const BeamGrid& grid) {
  return Rasteriser(geometry, motions, grid).cells();
}

}  // namespace clray
