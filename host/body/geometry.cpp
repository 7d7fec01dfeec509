// SPDX-License-Identifier: Apache-2.0
// Packing components into parts: transforms, canonical order, trees, bounds. Body frame, metres.
#include "body/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "body/face_pieces.hpp"
#include "body/in_parts.hpp"
#include "body/mesh_convexity.hpp"
#include "body/portable_tables.hpp"
#include "body/raw_primitives.hpp"
#include "clray/error.hpp"
#include "scene/motion.hpp"
#include "scene/tables.hpp"
#include "shape/shape.h"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr std::uint32_t kNowhere = 0xffffffffu;

/// Rotation about a unit axis by an angle (Rodrigues), by rows.
std::array<double, 9> rotation_about(const Vec3& axis, double angle) {
  if (angle == 0.0) return {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  double s, c;
  el_sincos(angle, &s, &c);
  const double l = std::sqrt(std::fma(axis.x, axis.x, std::fma(axis.y, axis.y, axis.z * axis.z)));
  const double x = axis.x / l, y = axis.y / l, z = axis.z / l, k = 1.0 - c;
  return {{std::fma(k * x, x, c), std::fma(k * x, y, -s * z), std::fma(k * x, z, s * y), std::fma(k * x, y, s * z),
           std::fma(k * y, y, c), std::fma(k * y, z, -s * x), std::fma(k * x, z, -s * y), std::fma(k * y, z, s * x),
           std::fma(k * z, z, c)}};
}

Point to_body(const Transform& transform, const std::array<double, 9>& rotation, const Vec3& v) {
  Point x{{v.x, v.y, v.z}};
  if (transform.scale != 1.0) x = {{x[0] * transform.scale, x[1] * transform.scale, x[2] * transform.scale}};
  if (transform.angle_rad != 0.0) x = rotated(rotation, x);
  // Adding zero turns -0 into +0, so that equal points have equal bits.
  return {{x[0] + transform.translate.x + 0.0, x[1] + transform.translate.y + 0.0, x[2] + transform.translate.z + 0.0}};
}

/// A material's spectra as numbers and names that can be compared.
std::vector<std::tuple<std::string, std::vector<double>, std::vector<double>>> spectra_of(const Material& material) {
  std::vector<std::tuple<std::string, std::vector<double>, std::vector<double>>> all;
  for (const auto& [key, spectrum] : material.spectra) all.emplace_back(key, spectrum.wavelength_nm, spectrum.value);
  return all;
}

class Packer {
 public:
  Packer(const Scene& scene, TreeFaces faces) : scene_(scene), faces_(faces) { g_.trees = faces != TreeFaces::none; }

  Geometry pack() {
    make_parts();
    for (std::size_t c = 0; c < scene_.components.size(); ++c) {
      const Component& component = scene_.components[c];
      if (component.mesh) {
        pack_mesh(component, static_cast<std::uint32_t>(c));
      } else {
        pack_shape(component, static_cast<std::uint32_t>(c));
      }
    }
    if (raw_.empty()) throw Error(ErrorCode::input, "nothing to trace: every face has zero area", scene_.path);
    rank();
    share_planes();
    place();
    bound();
    g_.single = g_.parts.size() == 1 && scene_.components.size() == 1 && !g_.shared_planes;
    return std::move(g_);
  }

 private:
  void make_parts() {
    g_.part_of_component.assign(scene_.components.size(), 0);
    const bool any_static =
        std::any_of(scene_.components.begin(), scene_.components.end(), [](const Component& c) { return !c.hinge; });
    if (any_static) g_.parts.emplace_back();
    for (std::size_t c = 0; c < scene_.components.size(); ++c) {
      if (!scene_.components[c].hinge) continue;
      g_.part_of_component[c] = static_cast<std::uint32_t>(g_.parts.size());
      g_.parts.emplace_back();
      g_.parts.back().hinged_component = static_cast<int>(c);
    }
  }

  void pack_mesh(const Component& component, std::uint32_t index) {
    const Mesh& mesh = *component.mesh;
    const std::array<double, 9> rotation = rotation_about(component.transform.axis, component.transform.angle_rad);
    std::vector<Point> points(mesh.vertices.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = to_body(component.transform, rotation, mesh.vertices[i]);
    RawPrimitive raw;
    raw.size = 9;
    raw.shape = static_cast<std::uint32_t>(table_index("shape", component.shape));
    raw.component = index;
    raw.part = g_.part_of_component[index];
    std::vector<std::uint8_t> used(points.size(), 0);
    numbers_.reserve(numbers_.size() + 9 * mesh.triangles.size());
    raw_.reserve(raw_.size() + mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<std::uint32_t, 3> v = mesh.triangles[t];
      const int first = points[v[0]] <= points[v[1]] ? (points[v[0]] <= points[v[2]] ? 0 : 2)
                                                     : (points[v[1]] <= points[v[2]] ? 1 : 2);
      std::rotate(v.begin(), v.begin() + first, v.end());
      if (has_no_area(points[v[0]], points[v[1]], points[v[2]])) continue;
      raw.material = component.materials.at(mesh.triangle_slot.empty() ? 0 : mesh.triangle_slot[t]);
      raw.data = static_cast<std::uint32_t>(numbers_.size());
      for (const std::uint32_t corner : v) {
        numbers_.insert(numbers_.end(), points[corner].begin(), points[corner].end());
        used[corner] = 1;
      }
      raw_.push_back(raw);
    }
    Part& part = g_.parts[raw.part];
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (used[i]) part.points.push_back(points[i]);
    }
    const double square = component.transform.scale * component.transform.scale;
    g_.report.faces += mesh.report.faces;
    g_.report.triangles += mesh.report.triangles;
    g_.report.area_m2 += mesh.report.area_m2 * square;
    g_.report.degenerate += mesh.report.degenerate;
    g_.report.boundary_edges += mesh.report.boundary_edges;
    g_.report.non_manifold_edges += mesh.report.non_manifold_edges;
  }

  // Such a triangle has no normal; no ray can hit it.
  static bool has_no_area(const Point& a, const Point& b, const Point& c) {
    const vec3 n = v3_cross(v3(b[0] - a[0], b[1] - a[1], b[2] - a[2]), v3(c[0] - a[0], c[1] - a[1], c[2] - a[2]));
    return n.x == 0.0 && n.y == 0.0 && n.z == 0.0;
  }

  void pack_shape(const Component& component, std::uint32_t index) {
    RawPrimitive raw;
    const int row = table_index("shape", component.shape);
    if (row < 0) throw Error(ErrorCode::input, "unknown shape \"" + component.shape + "\"", component.name);
    raw.shape = static_cast<std::uint32_t>(row);
    raw.component = index;
    raw.part = g_.part_of_component[index];
    raw.material = component.materials.at(0);
    raw.data = static_cast<std::uint32_t>(numbers_.size());
    const std::array<double, 9> m = rotation_about(component.transform.axis, component.transform.angle_rad);
    const std::array<double, 9> back{{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}};
    numbers_.insert(numbers_.end(), back.begin(), back.end());
    const Vec3& origin = component.transform.translate;
    numbers_.insert(numbers_.end(), {origin.x + 0.0, origin.y + 0.0, origin.z + 0.0, component.transform.scale});
    const std::vector<double> keys = row_values(table("shape")[row], component.parameters);
    numbers_.insert(numbers_.end(), keys.begin(), keys.end());
    raw.size = static_cast<std::uint32_t>(numbers_.size()) - raw.data;
    raw_.push_back(raw);
    g_.report.area_m2 += shape_area_of(row, keys.data()) * component.transform.scale * component.transform.scale;
  }

  // Sorts raw_ and its numbers into canonical order and drops copies. What follows reads them in turn.
  void rank() {
    struct Key {
      double first;
      std::uint32_t index;
    };
    std::vector<Key> keys(raw_.size());
    for (std::uint32_t i = 0; i < raw_.size(); ++i) keys[i] = {numbers_[raw_[i].data], i};
    const std::vector<std::uint32_t> material_rank = material_ranks(scene_);
    // By their first numbers alone: the others lie anywhere in memory. Few have the same first number as another.
    sort_in_parts(
        &keys, [](const Key& x, const Key& y) { return x.first != y.first ? x.first < y.first : x.index < y.index; });
    const auto less = [&](const Key& x, const Key& y) {
      const RawPrimitive &a = raw_[x.index], &b = raw_[y.index];
      if (const int order = compared(a, b, numbers_)) return order < 0;
      if (a.material != b.material) return material_rank[a.material] < material_rank[b.material];
      if (a.component != b.component) return a.component < b.component;
      return x.index < y.index;
    };
    sort_equals_in_parts(
        &keys, [](const Key& x, const Key& y) { return x.first == y.first; }, less);
    std::vector<std::uint32_t> order(keys.size());
    std::transform(keys.begin(), keys.end(), order.begin(), [](const Key& key) { return key.index; });
    keys = {};
    numbers_ = in_order(numbers_, raw_, order);
    raw_ = in_order(raw_, order);
    drop_copies(&raw_, &numbers_);
  }

  void share_planes() {
    const SharedPlanes found = shared_planes_of(raw_, numbers_);
    g_.shared_planes = !found.faces.empty();
    g_.conflicts = found.conflicts;
    for (const SharedPlane& face : found.faces) {
      RawPrimitive& raw = raw_[face.primitive];
      if (raw.planes == CLRAY_NO_PLANES) {
        raw.planes = static_cast<std::uint32_t>(planes_.size());
        planes_.resize(planes_.size() + CLRAY_PLANE_SIZE * parts_of(raw), 0.0);
      }
      std::copy(face.record.begin(), face.record.end(), planes_.begin() + raw.planes + CLRAY_PLANE_SIZE * face.part);
    }
  }

  // Places the primitives of each part in the order of its tree, or, without one, in that of their ranks.
  void place() {
    const std::vector<TableRow>& rows = table("shape");
    std::vector<bool> used(rows.size(), false);
    g_.primitives.reserve(raw_.size());
    std::vector<std::uint32_t> order;  // of all primitives
    order.reserve(raw_.size());
    bool listed = false;  // what leaves hold
    for (std::uint32_t p = 0; p < g_.parts.size(); ++p) {
      std::vector<std::uint32_t> members;
      for (std::uint32_t i = 0; i < raw_.size(); ++i) {
        if (raw_[i].part != p) continue;
        members.push_back(i);
        g_.parts[p].box.add(box_of(raw_[i], numbers_));
      }
      if (members.empty()) continue;
      if (!g_.trees) {
        for (const std::uint32_t member : members) append(raw_[member], member, rows[raw_[member].shape].faces, used);
        order.insert(order.end(), members.begin(), members.end());
        continue;
      }
      const FacePieces pieces({members.size(), [&](std::size_t i) { return box_of(raw_[members[i]], numbers_); },
                               [&](std::size_t i) { return corners_of(raw_[members[i]], numbers_); }},
                              g_.parts[p].box, faces_ == TreeFaces::pieces);
      LinearBvh tree = build_bvh(pieces.count(), [&](std::size_t k) { return pieces.box(k); });
      g_.parts[p].root = static_cast<std::uint32_t>(g_.nodes.size());
      g_.parts[p].frame = tree.frame;
      g_.stack_needed = std::max(g_.stack_needed, tree.stack_needed);
      // Until a part has pieces, a leaf's places are those of its primitives.
      const bool cut = pieces.count() > members.size();
      if (cut) list_leaves(&g_);
      listed = listed || cut;
      const auto first_leaf = static_cast<std::uint32_t>(listed ? g_.leaves.size() : g_.primitives.size());
      std::vector<std::uint32_t> place(cut ? members.size() : 0, kNowhere);  // of each member, once a leaf holds it
      for (const std::uint32_t box : tree.order) {
        const std::uint32_t k = pieces.face(box), member = members[k];
        const auto next = static_cast<std::uint32_t>(g_.primitives.size());
        const std::uint32_t found = cut && place[k] != kNowhere ? place[k] : next;
        if (found == next) {
          append(raw_[member], member, rows[raw_[member].shape].faces, used);
          order.push_back(member);
        }
        if (cut) place[k] = found;
        if (listed) g_.leaves.push_back(found);
      }
      append_tree(std::move(tree), first_leaf, &g_.nodes);
    }
    if (are_triangles(raw_)) raw_ = {};  // numbers in turn need none; of many triangles they are much memory
    g_.shapes = in_order(numbers_, raw_, order);
    numbers_ = {};
    append_planes();
    for (std::size_t row = 0; row < used.size(); ++row) {
      if (used[row]) g_.shape_rows.push_back(static_cast<int>(row));
    }
  }

  void append(const RawPrimitive& raw, std::uint32_t id, bool face, std::vector<bool>& used) {
    ClrayPrimitive primitive{};
    primitive.shape = raw.shape;
    primitive.data = placed_;
    placed_ += raw.size;
    primitive.material = raw.material;
    primitive.id = id;
    primitive.component = raw.component;
    const double* d = numbers_.data() + raw.data;
    if (face) {
      primitive.flags = CLRAY_PRIMITIVE_PLANE;
    } else {
      if (shape_traits_of(static_cast<int>(raw.shape), d + CLRAY_SHAPE_KEYS) & CLRAY_SHAPE_PLANE)
        primitive.flags = CLRAY_PRIMITIVE_PLANE;
      g_.parts[raw.part].shapes.push_back(primitive.data);
      g_.parts[raw.part].shape_rows.push_back(static_cast<int>(raw.shape));
    }
    primitive.planes = raw.planes;
    g_.primitives.push_back(primitive);
    used[raw.shape] = true;
  }

  // Behind all shapes: where these are triangles alone, the place of one's numbers follows from its own
  // (test_primitive() of stage/intersect.cl).
  void append_planes() {
    const auto base = static_cast<std::uint32_t>(g_.shapes.size());
    g_.shapes.insert(g_.shapes.end(), planes_.begin(), planes_.end());
    for (ClrayPrimitive& primitive : g_.primitives) {
      if (primitive.planes != CLRAY_NO_PLANES) primitive.planes += base;
    }
  }

  // A sphere about the middle of the boxes that holds every part at every hinge angle.
  void bound() {
    Box all;
    for (const Part& part : g_.parts) {
      if (part.box.empty()) continue;
      if (part.hinged_component < 0) {
        all.add(part.box);
        continue;
      }
      const Hinge& hinge = *scene_.components[part.hinged_component].hinge;
      const double reach = farthest(part.box, {{hinge.point.x, hinge.point.y, hinge.point.z}});
      for (const double sign : {-1.0, 1.0})
        all.add(Point{{hinge.point.x + sign * reach, hinge.point.y + sign * reach, hinge.point.z + sign * reach}});
    }
    for (int k = 0; k < 3; ++k) g_.centre[k] = 0.5 * all.low[k] + 0.5 * all.high[k];
    g_.radius = farthest(all, g_.centre);
    for (int k = 0; k < 3; ++k) g_.extent = std::max(g_.extent, all.high[k] - all.low[k]);
  }

  static double farthest(const Box& box, const Point& from) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double d = std::max(std::fabs(box.low[k] - from[k]), std::fabs(box.high[k] - from[k]));
      sum = std::fma(d, d, sum);
    }
    return std::sqrt(sum);
  }

  const Scene& scene_;
  const TreeFaces faces_;
  Geometry g_;
  std::vector<RawPrimitive> raw_;
  std::vector<double> numbers_;
  std::vector<double> planes_;
  std::uint32_t placed_ = 0;  // numbers of the primitives that have their places
};

}  // namespace

bool Geometry::convex() const {
  if (!single) return false;
  if (convex_) return *convex_;
  convex_ = parts[0].shapes.empty()
                ? convex_triangles(shapes)
                : (shape_traits_of(parts[0].shape_rows[0], shapes.data() + parts[0].shapes[0] + CLRAY_SHAPE_KEYS) &
                   CLRAY_SHAPE_CONVEX) != 0;
  return *convex_;
}

// By content, so that neither names nor places in a file matter.
std::vector<std::uint32_t> material_ranks(const Scene& scene) {
  std::vector<std::uint32_t> order(scene.materials.size()), rank(scene.materials.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) {
    const Material &a = scene.materials[x], &b = scene.materials[y];
    if (a.model != b.model) return a.model < b.model;
    if (a.two_sided != b.two_sided) return a.two_sided;
    if (a.parameters != b.parameters) return a.parameters < b.parameters;
    if (a.infrared_reflectance != b.infrared_reflectance) return a.infrared_reflectance < b.infrared_reflectance;
    return spectra_of(a) < spectra_of(b);
  });
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  return rank;
}

void list_leaves(Geometry* geometry) {
  if (!geometry->leaves.empty()) return;
  geometry->leaves.resize(geometry->primitives.size());
  std::iota(geometry->leaves.begin(), geometry->leaves.end(), 0u);
}

Geometry build_geometry(const Scene& scene, TreeFaces faces) {
  return Packer(scene, faces).pack();
}

Point RigidMotion::back(const Point& part) const {
  const std::array<double, 9>& m = rotation;
  Point x, body;
  for (int k = 0; k < 3; ++k) x[k] = part[k] - translation[k];
  for (int k = 0; k < 3; ++k) body[k] = std::fma(m[k], x[0], std::fma(m[3 + k], x[1], m[6 + k] * x[2]));
  return body;
}

RigidMotion part_motion(const Scene& scene, const Part& part, const Vec3& source, const Vec3& observer) {
  RigidMotion motion;
  if (part.hinged_component < 0) return motion;
  const Component& component = scene.components[part.hinged_component];
  const double angle = hinge_angle(*component.hinge, component.transform, source, observer);
  motion.rotation = rotation_about(component.hinge->axis, -angle);
  const Point pivot{{component.hinge->point.x, component.hinge->point.y, component.hinge->point.z}};
  const Point turned = rotated(motion.rotation, pivot);
  motion.translation = {{pivot[0] - turned[0], pivot[1] - turned[1], pivot[2] - turned[2]}};
  return motion;
}

}  // namespace clray
