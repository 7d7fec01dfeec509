// SPDX-License-Identifier: Apache-2.0
// See shared_planes.hpp. Planes are sorted by a generic combination of their coefficients, and only neighbours in that
// order are compared. Within a plane, plane_overlaps.hpp finds the faces that overlap.
#include "body/shared_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "body/in_parts.hpp"

namespace clray {
namespace {

using Point3 = std::array<double, 3>;

constexpr double kWindow = 1e-9;        // of sort keys: far above the rounding of a sound face's normal
constexpr double kSame = 32 * 0x1p-52;  // of the coordinates, for a corner to lie on a plane

/// A direction that no plane of a model is likely to contain: its components have no simple ratio.
constexpr double kGeneric[4] = {0.5377, 0.6803, 0.4981, 0.2719};

struct Plane {
  Point3 normal{{0.0, 0.0, 0.0}};
  double offset = 0.0, size = 0.0;  // of coordinates
  bool front = true;                // the face looks along the normal
};

double dot(const Point3& a, const Point3& b) {
  return std::fma(a[0], b[0], std::fma(a[1], b[1], a[2] * b[2]));
}

/// The plane of an outline. Its normal is turned to the side of kGeneric, so two faces back to back have the same
/// plane.
Plane plane_of(const FaceOutline& outline) {
  Plane plane;
  // It begins at the smallest corner, so that the bits do not depend on the corner that a face starts with.
  const std::vector<Point3>& p = outline.corners;
  const std::size_t count = p.size();
  const auto first = static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
  const Point3& origin = p[first];
  const auto from_origin = [&](std::size_t k) {
    const std::size_t at = first + k < count ? first + k : first + k - count;
    return Point3{{p[at][0] - origin[0], p[at][1] - origin[1], p[at][2] - origin[2]}};
  };
  Point3 sum{{0.0, 0.0, 0.0}};
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const Point3 a = from_origin(k), b = from_origin(k + 1);
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
  }
  const double length = std::sqrt(dot(sum, sum));
  if (!(length > 0.0)) return plane;
  plane.front = kGeneric[0] * sum[0] + kGeneric[1] * sum[1] + kGeneric[2] * sum[2] > 0.0;
  for (int i = 0; i < 3; ++i) plane.normal[i] = (plane.front ? sum[i] : -sum[i]) / length + 0.0;
  plane.offset = dot(plane.normal, origin);
  for (const Point3& x : p) {
    for (const double c : x) plane.size = std::max(plane.size, std::fabs(c));
  }
  return plane;
}

bool lies_on(const FaceOutline& face, const Plane& plane, double tolerance) {
  return std::all_of(face.corners.begin(), face.corners.end(),
                     [&](const Point3& x) { return std::fabs(dot(plane.normal, x) - plane.offset) <= tolerance; });
}

class Finder {
 public:
  Finder(const std::vector<FlatFace>& faces, const FaceSource& source) : faces_(faces), source_(source) {}

  SharedPlanes find() {
    sort_planes();
    join_neighbours();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> members;  // the first face of a plane, and each of its faces
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      if (joined_[f]) members.emplace_back(root(f), f);
    }
    std::sort(members.begin(), members.end());
    std::vector<std::uint32_t> plane;
    for (std::size_t k = 0; k < members.size(); ++k) {
      plane.push_back(members[k].second);
      if (k + 1 < members.size() && members[k + 1].first == members[k].first) continue;
      sweep(plane);
      plane.clear();
    }
    std::sort(out_.faces.begin(), out_.faces.end(), [](const SharedPlane& a, const SharedPlane& b) {
      return a.primitive != b.primitive ? a.primitive < b.primitive : a.part < b.part;
    });
    return std::move(out_);
  }

 private:
  struct Key {
    double value;
    std::uint32_t frame, face;
  };

  void sort_planes() {
    planes_.resize(faces_.size());
    keys_.resize(faces_.size());
    const unsigned threads = threads_for(faces_.size());
    in_parts(faces_.size(), threads, [&](std::size_t first, std::size_t end) {
      FaceOutline outline;
      for (std::size_t f = first; f < end; ++f) {
        source_.outline(faces_[f], &outline);
        planes_[f] = plane_of(outline);
      }
    });
    double size = 0.0;
    for (const Plane& plane : planes_) size = std::max(size, plane.size);
    in_parts(faces_.size(), threads, [&](std::size_t first, std::size_t end) {
      for (std::size_t f = first; f < end; ++f) {
        const double* n = planes_[f].normal.data();
        const double offset = kGeneric[3] * planes_[f].offset / std::max(size, 1e-300);
        keys_[f] = {kGeneric[0] * n[0] + kGeneric[1] * n[1] + kGeneric[2] * n[2] + offset, faces_[f].frame,
                    static_cast<std::uint32_t>(f)};
      }
    });
    sort_in_parts(&keys_, [](const Key& a, const Key& b) {
      if (a.frame != b.frame) return a.frame < b.frame;
      return a.value != b.value ? a.value < b.value : a.face < b.face;
    });
  }

  bool one_plane(std::uint32_t a, std::uint32_t b) {
    const double tolerance = kSame * std::max(planes_[a].size, planes_[b].size);
    source_.outline(faces_[a], &first_);
    if (lies_on(first_, planes_[b], tolerance)) return true;
    source_.outline(faces_[b], &first_);
    return lies_on(first_, planes_[a], tolerance);
  }

  void join_neighbours() {
    parent_.resize(faces_.size());
    joined_.assign(faces_.size(), false);
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      for (std::size_t j = i + 1; j < keys_.size() && keys_[j].frame == keys_[i].frame; ++j) {
        if (keys_[j].value - keys_[i].value > kWindow) break;
        if (!one_plane(keys_[i].face, keys_[j].face)) continue;
        join(keys_[i].face, keys_[j].face);
        break;  // the other faces of this plane join through the one found
      }
    }
  }

  std::uint32_t root(std::uint32_t f) {
    while (parent_[f] != f) f = parent_[f] = parent_[parent_[f]];
    return f;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    joined_[a] = joined_[b] = true;
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// Finds overlaps among the faces of one plane, whose coefficients are those of its first face.
  void sweep(const std::vector<std::uint32_t>& members) {
    if (held_.size() < members.size()) held_.resize(members.size());  // their memory serves the next plane, too
    for (std::size_t m = 0; m < members.size(); ++m) {
      source_.outline(faces_[members[m]], &held_[m].outline);
      held_[m].front = planes_[members[m]].front;
      held_[m].material = faces_[members[m]].material;
    }
    const Plane& plane = planes_[members.front()];
    const PlaneOverlaps found = find_overlaps(held_.data(), members.size(), plane.normal);
    out_.conflicts += static_cast<std::uint64_t>(std::count(found.conflicting.begin(), found.conflicting.end(), 1));
    out_.compared += found.compared;
    record(members, plane, found.shared);
  }

  void record(const std::vector<std::uint32_t>& members, const Plane& plane, const std::vector<char>& shared) {
    if (std::none_of(shared.begin(), shared.end(), [](char s) { return s != 0; })) return;
    ++number_;
    for (std::size_t m = 0; m < members.size(); ++m) {
      if (!shared[m]) continue;
      SharedPlane face;
      face.primitive = faces_[members[m]].primitive;
      face.part = faces_[members[m]].part;
      std::copy(plane.normal.begin(), plane.normal.end(), face.record.begin());
      face.record[CLRAY_PLANE_OFFSET] = plane.offset;
      face.record[CLRAY_PLANE_NUMBER] = number_;
      face.record[CLRAY_PLANE_FACING] = held_[m].front ? 1.0 : -1.0;
      out_.faces.push_back(face);
    }
  }

  const std::vector<FlatFace>& faces_;
  const FaceSource& source_;
  std::vector<Plane> planes_;  // of each face
  std::vector<Key> keys_;
  FaceOutline first_;            // that is looked at
  std::vector<PlaneFace> held_;  // of a plane
  std::vector<std::uint32_t> parent_;
  std::vector<bool> joined_;
  SharedPlanes out_;
  std::uint32_t number_ = 0;
};

}  // namespace

SharedPlanes find_shared_planes(const std::vector<FlatFace>& faces, const FaceSource& source) {
  return Finder(faces, source).find();
}

}  // namespace clray
