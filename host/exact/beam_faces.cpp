// SPDX-License-Identifier: Apache-2.0
// See beam_faces.hpp.
#include "exact/beam_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "body/portable_tables.hpp"
#include "exact/unsolved.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr double kGrazing = 1e-9;     // below this sine a face is edge-on
constexpr double kSamePlace = 1e-12;  // of the body's size: distances within it are zero
constexpr int kSumBits = 61;          // of a face's sums
constexpr int kLeastExponent = -900;  // of a face's area: smaller ones have no scale in fp64

/// The least power of two that is not below |x|, as an exponent.
int exponent_above(double x) {
  int e = 0;
  std::frexp(x, &e);
  return std::max(e, kLeastExponent);
}

vec3 to_body(const RigidMotion& motion, const Point& part, const Point& centre) {
  const Point x = motion.back(part);
  return v3(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]);
}

void set_scales(double area, ClrayFace* f) {
  f->area_scale = std::ldexp(1.0, kSumBits - exponent_above(area));
  const double length = std::max(f->box[1] - f->box[0], f->box[3] - f->box[2]);
  f->inv_length = std::ldexp(1.0, -exponent_above(length));
}

class Builder {
 public:
  Builder(const Geometry& geometry, const MaterialTable& materials, const BeamSight& sight)
      : geometry_(geometry), materials_(materials), sight_(sight) {
    static_cast<BeamFrame&>(out_) = BeamFrame(sight.toward, 2.0 * geometry.radius);
    out_.faces.reserve(geometry.primitives.size());
    out_.origins.reserve(geometry.primitives.size());
    const Point& c = geometry.centre;
    reference_ = v3_sub(sight.reference, v3(c[0], c[1], c[2]));
  }

  void add(std::uint32_t primitive, const RigidMotion& motion, const std::array<double, 3>* corners, int count) {
    const vec3 a = to_body(motion, corners[0], geometry_.centre);
    vec3 b = to_body(motion, corners[1], geometry_.centre);
    for (int k = 2; k < count; ++k) {
      const vec3 c = to_body(motion, corners[k], geometry_.centre);
      triangle(primitive, a, b, c);
      b = c;
    }
  }

  BeamFaces done() {
    std::vector<std::uint32_t> by_depth = distinct();
    std::sort(by_depth.begin(), by_depth.end(), [&](std::uint32_t i, std::uint32_t k) {
      const ClrayFace &a = out_.faces[i], &b = out_.faces[k];
      if (a.nearest != b.nearest) return a.nearest > b.nearest;
      return a.order != b.order ? a.order < b.order : i < k;
    });
    std::vector<ClrayFace> faces;
    std::vector<FaceOrigin> origins;
    std::vector<double> areas;
    areas.reserve(by_depth.size());
    faces.reserve(by_depth.size());
    origins.reserve(by_depth.size());
    for (const std::uint32_t k : by_depth) {
      faces.push_back(out_.faces[k]);
      origins.push_back(out_.origins[k]);
      areas.push_back(out_.areas[k]);
    }
    out_.faces = std::move(faces);
    out_.origins = std::move(origins);
    out_.areas = std::move(areas);
    return std::move(out_);
  }

 private:
  using Corners = std::array<std::array<double, 3>, 3>;

  /// A face's corners in an order of their own.
  Corners corners_of(std::uint32_t face) const {
    const double* w = out_.faces[face].body;
    Corners corners{{{{w[0], w[1], w[2]}}, {{w[3], w[4], w[5]}}, {{w[6], w[7], w[8]}}}};
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  /// Every face but those that have the corners of one that comes first in the scene's order: that one hides them.
  std::vector<std::uint32_t> distinct() const {
    struct Known {
      double sum;  // of all coordinates: equal corners have equal sums
      std::uint32_t order, face;
    };
    std::vector<Known> all;
    all.reserve(out_.faces.size());
    for (std::uint32_t k = 0; k < out_.faces.size(); ++k) {
      const Corners c = corners_of(k);
      double sum = 0.0;
      for (const auto& corner : c) sum += corner[0] + 2.0 * corner[1] + 3.0 * corner[2];
      all.push_back({sum, out_.faces[k].order, k});
    }
    std::sort(all.begin(), all.end(), [](const Known& a, const Known& b) {
      if (a.sum != b.sum) return a.sum < b.sum;
      return a.order != b.order ? a.order < b.order : a.face < b.face;
    });
    std::vector<std::uint32_t> kept;
    std::map<Corners, std::uint32_t> alike;  // of one sum, where there are several
    for (std::size_t first = 0; first < all.size();) {
      std::size_t end = first + 1;
      while (end < all.size() && all[end].sum == all[first].sum) ++end;
      alike.clear();
      for (; first < end; ++first) {
        const bool single = alike.empty() && first + 1 == end;
        if (single || alike.emplace(corners_of(all[first].face), 0).second) kept.push_back(all[first].face);
      }
    }
    return kept;
  }

  void triangle(std::uint32_t primitive, const vec3& a, const vec3& b, const vec3& c) {
    const std::uint32_t number = number_++;
    ClrayFace f{};
    const std::optional<FaceSide> side = place_face(out_, a, b, c, &f);
    if (!side) return;
    set_path(out_, sight_.source, reference_, &f);
    f.view = sight_.view;
    push(number, primitive, *side, f);
  }

  void push(std::uint32_t number, std::uint32_t primitive, const FaceSide& side, ClrayFace f) {
    const ClrayPrimitive& p = geometry_.primitives[primitive];
    const bool two_sided = (materials_.rows[p.material].flags & CLRAY_MATERIAL_TWO_SIDED) != 0;
    const std::uint32_t rank = side.front ? 0u : two_sided ? 1u : 2u;
    f.order = rank << kFaceRankBits | p.id;
    const bool first = out_.faces.empty();
    out_.x0 = first ? f.box[0] : std::min(out_.x0, f.box[0]);
    out_.x1 = first ? f.box[1] : std::max(out_.x1, f.box[1]);
    out_.y0 = first ? f.box[2] : std::min(out_.y0, f.box[2]);
    out_.y1 = first ? f.box[3] : std::max(out_.y1, f.box[3]);
    out_.faces.push_back(f);
    out_.origins.push_back({number, primitive, p.material, side.front || two_sided, side.cosine});
    out_.areas.push_back(side.area_m2);
  }

  const Geometry& geometry_;
  const MaterialTable& materials_;
  const BeamSight sight_;
  vec3 reference_{};  // from the body's centre
  std::uint32_t number_ = 0;
  BeamFaces out_;
};

bool made_of_faces(std::uint32_t shape) {
  static const std::vector<TableRow>& rows = table("shape");
  return rows[shape].faces;
}

}  // namespace

BeamFrame::BeamFrame(const vec3& direction, double body_size)
    : toward(direction), size(body_size), margin(kSamePlace * body_size) {
  v3_frame(toward, &axis_x, &axis_y);
}

std::optional<FaceSide> place_face(const BeamFrame& frame, const vec3& a, vec3 b, vec3 c, ClrayFace* face) {
  const vec3 cross = v3_cross(v3_sub(b, a), v3_sub(c, a));
  const double length = v3_length(cross);
  if (!(length > 0.0)) return {};
  vec3 n = v3(cross.x / length, cross.y / length, cross.z / length);
  const double along = v3_dot(n, frame.toward), cosine = std::fabs(along);
  if (cosine < kGrazing) return {};
  const bool front = along > 0.0;
  if (!front) {
    std::swap(b, c);
    n = v3_neg(n);
  }
  ClrayFace& f = *face;
  const vec3 corners[3] = {a, b, c};
  double depth[3];
  for (int k = 0; k < 3; ++k) {
    f.x[k] = v3_dot(frame.axis_x, corners[k]);
    f.y[k] = v3_dot(frame.axis_y, corners[k]);
    depth[k] = v3_dot(frame.toward, corners[k]);
    f.body[3 * k] = corners[k].x;
    f.body[3 * k + 1] = corners[k].y;
    f.body[3 * k + 2] = corners[k].z;
  }
  const double area2 = difference_of_products(f.x[1] - f.x[0], f.y[2] - f.y[0], f.x[2] - f.x[0], f.y[1] - f.y[0]);
  if (!(area2 > 0.0)) return {};
  f.slope_x = -v3_dot(n, frame.axis_x) / cosine;
  f.slope_y = -v3_dot(n, frame.axis_y) / cosine;
  f.depth0 = depth[0];
  f.normal[0] = n.x;
  f.normal[1] = n.y;
  f.normal[2] = n.z;
  f.offset = v3_dot(n, a);
  f.box[0] = *std::min_element(f.x, f.x + 3);
  f.box[1] = *std::max_element(f.x, f.x + 3);
  f.box[2] = *std::min_element(f.y, f.y + 3);
  f.box[3] = *std::max_element(f.y, f.y + 3);
  f.nearest = *std::max_element(depth, depth + 3);
  f.margin = 4.0 * frame.margin / cosine;
  set_scales(0.5 * area2, &f);
  return FaceSide{front, cosine, 0.5 * area2};
}

void set_path(const BeamFrame& frame, const vec3& source, const vec3& reference, ClrayFace* face) {
  ClrayFace& f = *face;
  const vec3 d = frame.toward, corners[3] = {v3_load(f.body), v3_load(f.body + 3), v3_load(f.body + 6)};
  const vec3 apart = v3_sub(d, source);
  f.path_m = -(f.depth0 - v3_dot(d, reference));
  for (int k = 0; k < 3; ++k) f.path[k] = -(v3_dot(d, corners[k]) - f.depth0);
  f.path_x = -f.slope_x;
  f.path_y = -f.slope_y;
  if (v3_dot(apart, apart) == 0.0) {
    f.path_m *= 2.0;
    for (double& path : f.path) path *= 2.0;
    f.path_x *= 2.0;
    f.path_y *= 2.0;
  } else {
    // Over the face a step across the beam is a step (1, 0, slope_x) or (0, 1, slope_y) in the beam's frame.
    const double along = v3_dot(source, d);
    f.path_m -= v3_dot(source, v3_sub(corners[0], reference));
    for (int k = 0; k < 3; ++k) f.path[k] -= v3_dot(source, v3_sub(corners[k], corners[0]));
    f.path_x -= std::fma(f.slope_x, along, v3_dot(source, frame.axis_x));
    f.path_y -= std::fma(f.slope_y, along, v3_dot(source, frame.axis_y));
  }
  const double path = std::max(std::fabs(f.path[1]), std::fabs(f.path[2]));
  f.inv_path = path > 0.0 ? std::ldexp(1.0, -exponent_above(path)) : 1.0;
}

BeamFaces beam_faces(const Geometry& geometry, const MaterialTable& materials, const std::vector<RigidMotion>& motions,
                     const BeamSight& sight) {
  Builder builder(geometry, materials, sight);
  for (std::uint32_t i = 0; i < geometry.primitives.size(); ++i) {
    const ClrayPrimitive& p = geometry.primitives[i];
    if (!made_of_polygons(geometry, p)) continue;  // what it may shade is not solved (unsolved.hpp)
    const RigidMotion& motion = motions[geometry.part_of_component[p.component]];
    const double* data = geometry.shapes.data() + p.data;
    if (made_of_faces(p.shape)) {
      const std::array<double, 3> corners[3] = {
          {{data[0], data[1], data[2]}}, {{data[3], data[4], data[5]}}, {{data[6], data[7], data[8]}}};
      builder.add(i, motion, corners, 3);
      continue;
    }
    FlatPart flat;
    for (std::uint32_t part = 0; part < kMostShapeParts; ++part) {
      if (!shape_flat_part(static_cast<int>(p.shape), data + CLRAY_SHAPE_KEYS, part, &flat)) continue;
      const auto corners = flat_part_corners(data, flat);
      builder.add(i, motion, corners.data(), 4);
    }
  }
  return builder.done();
}

}  // namespace clray
