// SPDX-License-Identifier: Apache-2.0
// See beams.hpp. The beam is a rectangle across the direction to the source: the fp64 bound of the
// body; for a source at +z or -z its axes are x and y (docs/physics.md, section 1).
#include "beam/beams.hpp"

#include <algorithm>
#include <cmath>

#include "shared/elementary.h"
#include "text/hash.hpp"

namespace clray {
namespace {

constexpr double kPictureMargin = 1.06;

Point point_of(const Vec3& v) {
  return {{v.x, v.y, v.z}};
}
Vec3 vec_of(const vec3& v) {
  return {v.x, v.y, v.z};
}
vec3 v3_of(const Vec3& v) {
  return v3(v.x, v.y, v.z);
}
void store(double* out, const vec3& v) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

void set_frame(const BoxFrame& frame, ClrayView* view) {
  std::copy(frame.centre.begin(), frame.centre.end(), view->box_centre);
  view->box_scale = frame.scale;
}

/// Instances and top-level tree of one view.
void place_parts(const Geometry& geometry, const std::vector<RigidMotion>& motions, Beams* out, ClrayView* view) {
  std::vector<Box> boxes;
  std::vector<std::size_t> members;
  for (std::size_t p = 0; p < geometry.parts.size(); ++p) {
    const Part& part = geometry.parts[p];
    if (part.box.empty()) continue;
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
      Point x;
      for (int k = 0; k < 3; ++k) x[k] = corner >> k & 1 ? part.box.high[k] : part.box.low[k];
      box.add(motions[p].back(x));
    }
    for (int k = 0; k < 3; ++k) {
      const double pad = 1e-14 * (std::fabs(box.low[k]) + std::fabs(box.high[k]) + geometry.radius);
      box.low[k] -= pad;
      box.high[k] += pad;
    }
    boxes.push_back(box);
    members.push_back(p);
  }
  const LinearBvh top = build_bvh(boxes);
  view->root = static_cast<std::uint32_t>(out->nodes.size());
  const auto first_instance = static_cast<std::uint32_t>(out->instances.size());
  for (const std::uint32_t position : top.order) {
    const Part& part = geometry.parts[members[position]];
    const RigidMotion& motion = motions[members[position]];
    ClrayInstance instance{};
    std::copy(motion.rotation.begin(), motion.rotation.end(), instance.rotation);
    std::copy(motion.translation.begin(), motion.translation.end(), instance.translation);
    std::copy(part.frame.centre.begin(), part.frame.centre.end(), instance.box_centre);
    instance.box_scale = part.frame.scale;
    instance.root = part.root;
    instance.moved = part.hinged_component >= 0 ? 1u : 0u;
    out->instances.push_back(instance);
  }
  append_tree(top, first_instance, &out->nodes);
  set_frame(top.frame, view);
}

ClrayConnection connection_to(const Vec3& direction, double acceptance_rad, bool shadow) {
  ClrayConnection row{};
  row.direction[0] = direction.x;
  row.direction[1] = direction.y;
  row.direction[2] = direction.z;
  if (acceptance_rad > 0.0) {
    double s, c;
    el_sincos(0.5 * acceptance_rad, &s, &c);
    row.acceptance_chord2 = 4.0 * s * s;
    row.inv_solid_angle = 1.0 / (CLRAY_PI * row.acceptance_chord2);  // 2π(1 − cos a) = π·chord²
  }
  row.shadow = shadow ? 1u : 0u;
  return row;
}

/// The key of a view's scrambles: a hash of the directions that decide what is traced. So a view has the same points
/// alone and among others, and two views have independent ones.
void set_key(const Orientation& orientation, ClrayView* view) {
  std::uint64_t key = kFnvStart;
  const auto add = [&](const Vec3& direction) {
    const double numbers[3] = {direction.x + 0.0, direction.y + 0.0, direction.z + 0.0};  // no negative zeros
    key = fnv1a(key, numbers, sizeof numbers);
  };
  add(orientation.source);
  for (const Vec3& observer : orientation.observers) add(observer);
  view->key0 = static_cast<std::uint32_t>(key);
  view->key1 = static_cast<std::uint32_t>(key >> 32);
}

/// Sets where the beam's rays start; returns the area of its rectangle.
double beam_rectangle(const Geometry& geometry, const std::vector<RigidMotion>& motions, ClrayView* view) {
  const vec3 s = v3(view->toward[0], view->toward[1], view->toward[2]);
  vec3 t, b;
  v3_frame(s, &t, &b);
  double u0, u1, v0, v1, w0, w1;
  body_extent(geometry, motions, {{t.x, t.y, t.z}}, &u0, &u1);
  body_extent(geometry, motions, {{b.x, b.y, b.z}}, &v0, &v1);
  body_extent(geometry, motions, {{s.x, s.y, s.z}}, &w0, &w1);
  const double start = w1 + std::ldexp(geometry.radius, -4);
  store(view->corner, v3_fma(u0, t, v3_fma(v0, b, v3_scale(start, s))));
  store(view->edge_u, v3_scale(u1 - u0, t));
  store(view->edge_v, v3_scale(v1 - v0, b));
  return (u1 - u0) * (v1 - v0);
}

/// Image axes: up is the space frame's +y as seen in the body frame (or -z/+z where the view is along it).
void picture_axes(const Orientation& orientation, const Vec3& toward, PictureFrame* frame) {
  const Quaternion q = orientation.body_to_space;
  const auto to_body = [&](const Vec3& v) {
    const Vec3 u(-q.x, -q.y, -q.z);
    const Vec3 c(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    const Vec3 d(u.y * c.z - u.z * c.y, u.z * c.x - u.x * c.z, u.x * c.y - u.y * c.x);
    return v + 2.0 * (q.w * c + d);
  };
  const vec3 o = v3_of(toward);
  vec3 up = v3_of(to_body(Vec3(0.0, 1.0, 0.0)));
  if (std::fabs(v3_dot(up, o)) > 0.999) up = v3_of(to_body(Vec3(0.0, 0.0, v3_dot(up, o) > 0.0 ? -1.0 : 1.0)));
  const vec3 right = v3_unit(v3_cross(up, o));
  frame->right.push_back(vec_of(right));
  frame->up.push_back(vec_of(v3_unit(v3_cross(o, right))));
}

/// Frames the body in every view with the same pixel size. Returns, per view, how far it reaches toward the observer.
std::vector<double> frame_pictures(const Geometry& geometry, const std::vector<std::vector<RigidMotion>>& motions,
                                   const std::vector<Vec3>& toward, const Vec3& reference, const PictureSize& size,
                                   PictureFrame* frame) {
  std::vector<double> nearest;
  double half_right = 0.0, half_up = 0.0;
  for (std::size_t v = 0; v < motions.size(); ++v) {
    double a, b, c, d, e, f;
    body_extent(geometry, motions[v], point_of(frame->right[v]), &a, &b);
    body_extent(geometry, motions[v], point_of(frame->up[v]), &c, &d);
    body_extent(geometry, motions[v], point_of(toward[v]), &e, &f);
    frame->middle_right_m.push_back(0.5 * (a + b));
    frame->middle_up_m.push_back(0.5 * (c + d));
    const vec3 origin = v3_of(reference);
    frame->centre_right_m.push_back(frame->middle_right_m[v] - v3_dot(v3_of(frame->right[v]), origin));
    frame->centre_up_m.push_back(frame->middle_up_m[v] - v3_dot(v3_of(frame->up[v]), origin));
    nearest.push_back(f);
    half_right = std::max(half_right, 0.5 * (b - a));
    half_up = std::max(half_up, 0.5 * (d - c));
  }
  const double width = size.width, height = size.height;
  frame->pixel_m = kPictureMargin * 2.0 * std::max({half_right / width, half_up / height, 1e-6 * geometry.radius});
  return nearest;
}

/// Rays of pixels start just before the body; row 0 is on top.
void pixel_rays(const Geometry& geometry, const PictureSize& size, const std::vector<double>& nearest, Beams* out) {
  const PictureFrame& frame = out->frame;
  const double width = size.width, height = size.height;
  for (std::size_t v = 0; v < out->views.size(); ++v) {
    ClrayView& view = out->views[v];
    const vec3 right = v3_of(frame.right[v]), up = v3_of(frame.up[v]);
    const vec3 o = v3(view.toward[0], view.toward[1], view.toward[2]);
    const double left = frame.middle_right_m[v] - 0.5 * width * frame.pixel_m;
    const double top = frame.middle_up_m[v] + 0.5 * height * frame.pixel_m;
    const double start = nearest[v] + std::ldexp(geometry.radius, -4);
    store(view.corner, v3_fma(left, right, v3_fma(top, up, v3_scale(start, o))));
    store(view.edge_u, v3_scale(width * frame.pixel_m, right));
    store(view.edge_v, v3_scale(-height * frame.pixel_m, up));
    out->area_m2.push_back(frame.pixel_m * frame.pixel_m);
  }
}

}  // namespace

std::vector<RigidMotion> motions_of(const Scene& scene, const Geometry& geometry, const Orientation& orientation) {
  std::vector<RigidMotion> motions;
  for (const Part& part : geometry.parts)
    motions.push_back(part_motion(scene, part, orientation.source,
                                  orientation.observers.empty() ? orientation.source : orientation.observers[0]));
  return motions;
}

Beams build_beams(const Scene& scene, const Geometry& geometry, const BeamRequest& request) {
  Beams out;
  const bool instanced =
      !scene.trace.specialise || std::any_of(geometry.parts.begin(), geometry.parts.end(),
                                             [](const Part& part) { return part.hinged_component >= 0; });
  if (instanced) out.nodes = geometry.nodes;
  std::vector<std::vector<RigidMotion>> all_motions;
  std::vector<Vec3> looks;  // toward the observer of a picture
  for (const Orientation& orientation : request.orientations) {
    const std::vector<RigidMotion> motions = motions_of(scene, geometry, orientation);
    const auto observer = static_cast<std::size_t>(request.observers.front());
    const Vec3& toward = request.pixels ? orientation.observers[observer] : orientation.source;
    ClrayView view{};
    store(view.toward, v3_of(toward));
    set_key(orientation, &view);
    view.root = geometry.parts[0].root;
    set_frame(geometry.parts[0].frame, &view);
    if (instanced) place_parts(geometry, motions, &out, &view);
    if (request.pixels) {
      const bool monostatic = at_source(scene.observers[observer], scene.source) && !scene.trace.force_bistatic;
      out.connections.push_back(connection_to(orientation.source, 0.0, !monostatic));
    } else {
      for (const int o : request.observers) {
        const Vec3& direction = orientation.observers[static_cast<std::size_t>(o)];
        const bool shadow = !(direction == orientation.source) || scene.trace.force_bistatic;
        out.connections.push_back(
            connection_to(direction, scene.observers[static_cast<std::size_t>(o)].acceptance_rad, shadow));
      }
      out.area_m2.push_back(beam_rectangle(geometry, motions, &view));
    }
    looks.push_back(orientation.observers[observer]);
    if (request.paints()) picture_axes(orientation, looks.back(), &out.frame);
    out.views.push_back(view);
    all_motions.push_back(motions);
  }
  if (!request.paints()) return out;
  const std::vector<double> nearest =
      frame_pictures(geometry, all_motions, looks, scene.reference_point, request.picture, &out.frame);
  if (request.pixels) pixel_rays(geometry, request.picture, nearest, &out);
  return out;
}

void PathRange::add(const PathRange& other) {
  low_m = std::min(low_m, other.low_m);
  high_m = std::max(high_m, other.high_m);
}

PathRange PathRanges::view(std::size_t view) const {
  PathRange all;
  for (std::size_t c = 0; c < connections; ++c) all.add(of[view * connections + c]);
  return all;
}

PathRange PathRanges::connection(std::size_t connection) const {
  PathRange all;
  for (std::size_t k = connection; k < of.size(); k += connections) all.add(of[k]);
  return all;
}

PathRanges path_ranges(const Scene& scene, const Geometry& geometry, const BeamRequest& request, const Beams& beams) {
  PathRanges ranges;
  ranges.connections = beams.connections.size() / beams.views.size();
  const Vec3& r = scene.reference_point;
  for (std::size_t v = 0; v < beams.views.size(); ++v) {
    const std::vector<RigidMotion> motions = motions_of(scene, geometry, request.orientations[v]);
    for (std::size_t c = 0; c < ranges.connections; ++c) {
      const double *s = beams.views[v].toward, *o = beams.connections[v * ranges.connections + c].direction;
      const Point sum{{s[0] + o[0], s[1] + o[1], s[2] + o[2]}};
      double a, b;
      body_extent(geometry, motions, sum, &a, &b);
      const double reference = std::fma(sum[0], r.x, std::fma(sum[1], r.y, sum[2] * r.z));
      ranges.of.push_back({reference - b, reference - a});
    }
  }
  return ranges;
}

}  // namespace clray
