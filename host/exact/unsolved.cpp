// SPDX-License-Identifier: Apache-2.0
// See unsolved.hpp.
#include "exact/unsolved.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "body/portable_tables.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr int kCells = 64;        // of the grid, along a side
constexpr double kMargin = 1e-9;  // of the body's size, beside and before a shape: far above rounding

/// Asked of every primitive: the table is looked up once.
const TableRow& shape_row(const ClrayPrimitive& primitive) {
  static const std::vector<TableRow>& rows = table("shape");
  return rows[primitive.shape];
}

/// What a primitive covers across a beam, and its depths toward where the beam comes from.
struct Extent {
  double low[3], high[3];  // along the two axes across the beam, and along it
};

/// The greatest depth of curved shapes in each cell of a grid across a beam.
class CurvedDepths {
 public:
  CurvedDepths(const Geometry& geometry, const std::vector<RigidMotion>& motions, const vec3& toward)
      : geometry_(geometry), motions_(motions), margin_(kMargin * geometry.radius) {
    v3_frame(toward, &axes_[0], &axes_[1]);
    axes_[2] = toward;
    depths_.fill(-HUGE_VAL);
    for (int k = 0; k < 2; ++k) {
      const Point& c = geometry.centre;
      start_[k] = v3_dot(axes_[k], v3(c[0], c[1], c[2])) - geometry.radius;
    }
    inv_cell_ = kCells / (2.0 * geometry.radius);
  }

  void add(const ClrayPrimitive& shape) {
    const Extent e = extent_of(shape);
    each_cell(e, [&](double* depth) { *depth = std::max(*depth, e.high[2] + margin_); });
  }

  /// Whether a curved shape may stand before any of a primitive.
  bool may_hide(const ClrayPrimitive& primitive) {
    const Extent e = extent_of(primitive);
    bool hidden = false;
    each_cell(e, [&](const double* depth) { hidden = hidden || *depth >= e.low[2]; });
    return hidden;
  }

 private:
  Extent extent_of(const ClrayPrimitive& primitive) const {
    const RigidMotion& motion = motions_[geometry_.part_of_component[primitive.component]];
    Extent e;
    const bool triangle = shape_row(primitive).faces;
    for (int axis = 0; axis < 3; ++axis) {
      const Point along{{axes_[axis].x, axes_[axis].y, axes_[axis].z}};
      if (!triangle) {
        shape_extent(geometry_, static_cast<int>(primitive.shape), primitive.data, motion, along, &e.low[axis],
                     &e.high[axis]);
        continue;
      }
      e.low[axis] = HUGE_VAL;
      e.high[axis] = -HUGE_VAL;
      for (int corner = 0; corner < 3; ++corner) {
        const double* x = geometry_.shapes.data() + primitive.data + 3 * corner;
        const Point body = motion.back({{x[0], x[1], x[2]}});
        const double at = along[0] * body[0] + along[1] * body[1] + along[2] * body[2];
        e.low[axis] = std::min(e.low[axis], at);
        e.high[axis] = std::max(e.high[axis], at);
      }
    }
    return e;
  }

  template <class Function>
  void each_cell(const Extent& e, const Function& function) {
    int first[2], last[2];
    for (int k = 0; k < 2; ++k) {
      first[k] = cell_at(e.low[k] - margin_, k);
      last[k] = cell_at(e.high[k] + margin_, k);
    }
    for (int y = first[1]; y <= last[1]; ++y) {
      for (int x = first[0]; x <= last[0]; ++x) function(&depths_[static_cast<std::size_t>(y * kCells + x)]);
    }
  }

  int cell_at(double x, int axis) const {
    return std::clamp(static_cast<int>(std::floor((x - start_[axis]) * inv_cell_)), 0, kCells - 1);
  }

  const Geometry& geometry_;
  const std::vector<RigidMotion>& motions_;
  const double margin_;
  vec3 axes_[3];
  double start_[2] = {0.0, 0.0}, inv_cell_ = 1.0;
  std::array<double, kCells * kCells> depths_{};
};

}  // namespace

bool made_of_polygons(const Geometry& geometry, const ClrayPrimitive& primitive) {
  const TableRow& row = shape_row(primitive);
  if (row.faces) return true;
  if (!row.flat) return false;
  const double* keys = geometry.shapes.data() + primitive.data + CLRAY_SHAPE_KEYS;
  FlatPart flat;
  for (std::uint32_t p = 0; p < kMostShapeParts; ++p) {
    if (shape_flat_part(static_cast<int>(primitive.shape), keys, p, &flat) && flat.round) return false;
  }
  return true;
}

bool any_polygons(const Geometry& geometry) {
  return std::any_of(geometry.primitives.begin(), geometry.primitives.end(),
                     [&](const ClrayPrimitive& p) { return made_of_polygons(geometry, p); });
}

bool all_polygons(const Geometry& geometry) {
  return std::all_of(geometry.primitives.begin(), geometry.primitives.end(),
                     [&](const ClrayPrimitive& p) { return made_of_polygons(geometry, p); });
}

void add_unsolved(const Geometry& geometry, const std::vector<RigidMotion>& motions, const std::vector<vec3>& toward,
                  UnsolvedPrimitives* out) {
  const std::vector<ClrayPrimitive>& all = geometry.primitives;
  out->words = static_cast<std::uint32_t>((all.size() + 31) / 32);
  const std::size_t first = out->bits.size();
  out->bits.resize(first + out->words);
  std::vector<std::uint32_t> polygons;
  const auto set = [&](std::uint32_t p) { out->bits[first + (p >> 5)] |= 1u << (p & 31u); };
  for (std::uint32_t p = 0; p < all.size(); ++p) {
    if (made_of_polygons(geometry, all[p])) {
      polygons.push_back(p);
    } else {
      set(p);
    }
  }
  for (const vec3& direction : toward) {
    CurvedDepths curved(geometry, motions, direction);
    for (std::uint32_t p = 0; p < all.size(); ++p) {
      if (!made_of_polygons(geometry, all[p])) curved.add(all[p]);
    }
    for (const std::uint32_t p : polygons) {
      if (curved.may_hide(all[p])) set(p);
    }
  }
}

}  // namespace clray
