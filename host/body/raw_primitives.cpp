// SPDX-License-Identifier: Apache-2.0
// See raw_primitives.hpp.
#include "body/raw_primitives.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "body/in_parts.hpp"
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

bool are_triangles(const std::vector<RawPrimitive>& raw) {
  for (std::size_t k = 0; k < raw.size(); ++k) {
    if (raw[k].size != kTriangleSize || raw[k].data != kTriangleSize * k) return false;
  }
  return true;
}

namespace {

/// Copies moved[k] = items[order[k]] of `size` numbers each, by all cores. The places that come next are fetched ahead:
/// they lie anywhere in memory, and waiting for each would be most of the time.
template <std::size_t size, class T>
std::vector<T> gathered(const T* items, const std::vector<std::uint32_t>& order) {
  constexpr std::size_t kAhead = 16;
  std::vector<T> moved(size * order.size());
  in_parts(order.size(), threads_for(order.size()), [&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      if (k + kAhead < end) __builtin_prefetch(items + size * order[k + kAhead]);
      std::copy_n(items + size * order[k], size, moved.begin() + static_cast<std::ptrdiff_t>(size * k));
    }
  });
  return moved;
}

}  // namespace

std::vector<double> in_order(const std::vector<double>& numbers, const std::vector<RawPrimitive>& raw,
                             const std::vector<std::uint32_t>& order) {
  if (are_triangles(raw)) return gathered<kTriangleSize>(numbers.data(), order);
  std::vector<double> moved;
  moved.reserve(numbers.size());
  for (const std::uint32_t k : order) {
    const auto first = numbers.begin() + raw[k].data;
    moved.insert(moved.end(), first, first + raw[k].size);
  }
  return moved;
}

std::vector<RawPrimitive> in_order(const std::vector<RawPrimitive>& raw, const std::vector<std::uint32_t>& order) {
  return gathered<1>(raw.data(), order);
}

int compared(const RawPrimitive& a, const RawPrimitive& b, const std::vector<double>& numbers) {
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  for (std::uint32_t k = 0; k < a.size; ++k) {
    if (numbers[a.data + k] != numbers[b.data + k]) return numbers[a.data + k] < numbers[b.data + k] ? -1 : 1;
  }
  if (a.shape != b.shape) return a.shape < b.shape ? -1 : 1;
  if (a.part != b.part) return a.part < b.part ? -1 : 1;
  return 0;
}

void drop_copies(std::vector<RawPrimitive>* raw, std::vector<double>* numbers) {
  std::size_t kept = 0;
  std::uint32_t from = 0, end = 0;
  for (RawPrimitive one : *raw) {
    one.data = from;
    from += one.size;
    if (kept != 0 && (*raw)[kept - 1].material == one.material && compared((*raw)[kept - 1], one, *numbers) == 0)
      continue;
    const auto first = numbers->begin() + one.data;
    if (end != one.data) std::copy(first, first + one.size, numbers->begin() + end);
    one.data = end;
    end += one.size;
    (*raw)[kept++] = one;
  }
  raw->resize(kept);
  numbers->resize(end);
}

SharedPlanes shared_planes_of(const std::vector<RawPrimitive>& primitives, const std::vector<double>& numbers) {
  const Faces faces(primitives, numbers);
  return find_shared_planes(faces.all(), faces);
}

}  // namespace clray
