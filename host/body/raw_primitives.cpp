// SPDX-License-Identifier: Apache-2.0
// See raw_primitives.hpp.
#include "body/raw_primitives.hpp"

#include <cmath>

#include "body/portable_tables.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr std::uint32_t kTriangleSize = 9;
constexpr std::uint32_t kMostParts = 6;  // of an analytic shape: a box
constexpr int kRoundCorners = 48;        // of the polygon inside a disk

using Point3 = std::array<double, 3>;

/// A point at `along` on an axis of a shape's local frame, u and v on the two axes after it; in its part's frame.
Point3 from_local(const double* d, int axis, double along, double u, double v) {
  Point3 x, y;
  x[axis] = along * d[CLRAY_SHAPE_SCALE];
  x[(axis + 1) % 3] = u * d[CLRAY_SHAPE_SCALE];
  x[(axis + 2) % 3] = v * d[CLRAY_SHAPE_SCALE];
  for (int k = 0; k < 3; ++k)
    y[k] = std::fma(d[k], x[0], std::fma(d[3 + k], x[1], d[6 + k] * x[2])) + d[CLRAY_SHAPE_ORIGIN + k];
  return y;
}

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
    out->corners.clear();
    out->hole_radius = 0.0;
    FlatPart flat;
    if (raw.size == kTriangleSize) {
      for (int k = 0; k < 3; ++k) out->corners.push_back({{d[3 * k], d[3 * k + 1], d[3 * k + 2]}});
      return;
    }
    flat_part(raw, face.part, &flat);
    const int corners = flat.round ? kRoundCorners : 4;
    for (int k = 0; k < corners; ++k) {
      double u = k == 0 || k == 3 ? flat.a : -flat.a, v = k < 2 ? flat.b : -flat.b;
      if (flat.round) {
        el_sincos(2.0 * CLRAY_PI / kRoundCorners * k, &v, &u);
        u *= flat.a;
        v *= flat.a;
      }
      out->corners.push_back(from_local(d, flat.axis, flat.offset, flat.side * u, v));
    }
    out->centre = from_local(d, flat.axis, flat.offset, 0.0, 0.0);
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
  return raw.size == kTriangleSize ? 1u : kMostParts;
}

SharedPlanes shared_planes_of(const std::vector<RawPrimitive>& primitives, const std::vector<double>& numbers) {
  const Faces faces(primitives, numbers);
  return find_shared_planes(faces.all(), faces);
}

}  // namespace clray
