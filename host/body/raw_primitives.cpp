// SPDX-License-Identifier: Apache-2.0
// See raw_primitives.hpp.
#include "body/raw_primitives.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "body/portable_tables.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr std::uint32_t kTriangleSize = 9;
constexpr int kRoundCorners = 48;  // of the polygon inside a disk

class Faces : public FaceSource {
 public:
  Faces(const std::vector<RawPrimitive>& primitives, const std::vector<double>& numbers)
      : primitives_(primitives), numbers_(numbers) {}

  std::vector<FlatFace> all() const {
    std::vector<FlatFace> faces;
    FlatPart flat;
    for (std::uint32_t i = 0; i < primitives_.size(); ++i) {
      const RawPrimitive& raw = primitives_[i];
      for (std::uint32_t part = 0; part < parts_of(raw); ++part) {
        if (raw.size == kTriangleSize || flat_part(raw, part, &flat))
          faces.push_back({i, part, raw.part, raw.material});
      }
    }
    return faces;
  }

  void outline(const FlatFace& face, FaceOutline* out) const override {
    const RawPrimitive& raw = primitives_[face.primitive];
    const double* d = numbers_.data() + raw.data;
    out->hole_radius = 0.0;
    if (raw.size == kTriangleSize) {
      out->corners.resize(3);
      for (int k = 0; k < 3; ++k) out->corners[k] = {{d[3 * k], d[3 * k + 1], d[3 * k + 2]}};
      return;
    }
    out->corners.clear();
    FlatPart flat;
    flat_part(raw, face.part, &flat);
    if (flat.round) {
      for (int k = 0; k < kRoundCorners; ++k) {
        double s, c;
        el_sincos(2.0 * CLRAY_PI / kRoundCorners * k, &s, &c);
        out->corners.push_back(shape_point(d, flat.axis, flat.offset, flat.side * (c * flat.a), s * flat.a));
      }
    } else {
      const auto corners = flat_part_corners(d, flat);
      out->corners.assign(corners.begin(), corners.end());
    }
    out->centre = shape_point(d, flat.axis, flat.offset, 0.0, 0.0);
    if (flat.round) out->hole_radius = flat.b * d[CLRAY_SHAPE_SCALE];
  }

 private:
  bool flat_part(const RawPrimitive& raw, std::uint32_t part, FlatPart* flat) const {
    return shape_flat_part(static_cast<int>(raw.shape), numbers_.data() + raw.data + CLRAY_SHAPE_KEYS, part, flat);
  }

  const std::vector<RawPrimitive>& primitives_;
  const std::vector<double>& numbers_;
};

}  // namespace

std::uint32_t parts_of(const RawPrimitive& raw) {
  return raw.size == kTriangleSize ? 1u : kMostShapeParts;
}

Box box_of(const RawPrimitive& raw, const std::vector<double>& numbers) {
  Box box;
  const double* d = numbers.data() + raw.data;
  if (raw.size == kTriangleSize) {
    for (int k = 0; k < 3; ++k) box.add(std::array<double, 3>{{d[3 * k], d[3 * k + 1], d[3 * k + 2]}});
    return box;
  }
  for (int axis = 0; axis < 3; ++axis) {
    // Support along +axis and -axis: the rotation's columns carry the axis into the local frame.
    const double u[3] = {d[axis], d[3 + axis], d[6 + axis]}, v[3] = {-u[0], -u[1], -u[2]};
    const double s = d[CLRAY_SHAPE_SCALE], o = d[CLRAY_SHAPE_ORIGIN + axis];
    const double high = s * shape_support_of(static_cast<int>(raw.shape), d + CLRAY_SHAPE_KEYS, u);
    const double low = s * shape_support_of(static_cast<int>(raw.shape), d + CLRAY_SHAPE_KEYS, v);
    const double pad = 1e-15 * (std::fabs(o) + std::fabs(low) + std::fabs(high));  // rounding of the two products
    box.low[axis] = o - low - pad;
    box.high[axis] = o + high + pad;
  }
  return box;
}

const double* corners_of(const RawPrimitive& raw, const std::vector<double>& numbers) {
  return raw.size == kTriangleSize ? numbers.data() + raw.data : nullptr;
}

namespace {

/// Whether all are triangles whose numbers follow one another.
bool are_triangles(const std::vector<RawPrimitive>& raw) {
  for (std::size_t k = 0; k < raw.size(); ++k) {
    if (raw[k].size != kTriangleSize || raw[k].data != kTriangleSize * k) return false;
  }
  return true;
}

/// Of a permutation, where each triangle of the new order stood.
std::vector<std::uint32_t> permutation(std::vector<std::uint32_t> order, std::size_t count) {
  if (order.size() == count) return order;
  std::vector<bool> taken(count, false);
  for (const std::uint32_t k : order) taken[k] = true;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (!taken[k]) order.push_back(k);
  }
  return order;
}

}  // namespace

std::vector<double> in_order(std::vector<double> numbers, const std::vector<RawPrimitive>& raw,
                             const std::vector<std::uint32_t>& order) {
  if (!are_triangles(raw)) {
    std::vector<double> moved;
    moved.reserve(numbers.size());
    for (const std::uint32_t k : order) {
      const auto first = numbers.begin() + raw[k].data;
      moved.insert(moved.end(), first, first + raw[k].size);
    }
    return moved;
  }
  // In place, cycle by cycle: a second copy of many triangles would be the most memory that a scene takes.
  using Triangle = std::array<double, kTriangleSize>;
  auto* triangles = reinterpret_cast<Triangle*>(numbers.data());
  const std::vector<std::uint32_t> from = permutation(order, raw.size());
  std::vector<bool> done(from.size(), false);
  for (std::uint32_t k = 0; k < from.size(); ++k) {
    if (done[k]) continue;
    const Triangle held = triangles[k];
    std::uint32_t to = k;
    for (; from[to] != k; to = from[to]) {
      triangles[to] = triangles[from[to]];
      done[to] = true;
    }
    triangles[to] = held;
    done[to] = true;
  }
  numbers.resize(kTriangleSize * order.size());
  return numbers;
}

SharedPlanes shared_planes_of(const std::vector<RawPrimitive>& primitives, const std::vector<double>& numbers) {
  const Faces faces(primitives, numbers);
  return find_shared_planes(faces.all(), faces);
}

}  // namespace clray
