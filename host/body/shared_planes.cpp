// SPDX-License-Identifier: Apache-2.0
// See shared_planes.hpp. Planes are sorted by a generic combination of their coefficients, and only neighbours in that
// order are compared. Within a plane, outlines are swept along one axis. Two of them overlap where no edge of either
// separates them.
#include "body/shared_planes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace clray {
namespace {

using Point3 = std::array<double, 3>;

constexpr double kWindow = 1e-9;        // of sort keys: far above the rounding of a sound face's normal
constexpr double kSame = 32 * 0x1p-52;  // of the coordinates, for a corner to lie on a plane
constexpr double kTouch = 1e-12;        // of the sizes: outlines that overlap by less only touch
constexpr int kMostStripes = 1024;

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
  std::vector<Point3> p = outline.corners;
  std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
  Point3 sum{{0.0, 0.0, 0.0}};
  for (std::size_t k = 1; k + 1 < p.size(); ++k) {
    Point3 a, b;
    for (int i = 0; i < 3; ++i) {
      a[i] = p[k][i] - p[0][i];
      b[i] = p[k + 1][i] - p[0][i];
    }
    for (int i = 0; i < 3; ++i) sum[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
  const double length = std::sqrt(dot(sum, sum));
  if (!(length > 0.0)) return plane;
  plane.front = kGeneric[0] * sum[0] + kGeneric[1] * sum[1] + kGeneric[2] * sum[2] > 0.0;
  for (int i = 0; i < 3; ++i) plane.normal[i] = (plane.front ? sum[i] : -sum[i]) / length + 0.0;
  plane.offset = dot(plane.normal, p[0]);
  for (const Point3& x : p) {
    for (const double c : x) plane.size = std::max(plane.size, std::fabs(c));
  }
  return plane;
}

bool lies_on(const FaceOutline& face, const Plane& plane, double tolerance) {
  return std::all_of(face.corners.begin(), face.corners.end(),
                     [&](const Point3& x) { return std::fabs(dot(plane.normal, x) - plane.offset) <= tolerance; });
}

/// A face's outline within its plane, counter-clockwise.
struct Flat {
  std::vector<std::array<double, 2>> corners;
  std::array<double, 2> low{{1e300, 1e300}}, high{{-1e300, -1e300}};
};

/// Drops the coordinate along which the normal is largest. The others keep their bits, so shared edges stay shared.
Flat flatten(const FaceOutline& outline, const Point3& normal) {
  int drop = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(normal[i]) > std::fabs(normal[drop])) drop = i;
  }
  Flat flat;
  double area = 0.0;
  for (const Point3& x : outline.corners) flat.corners.push_back({{x[(drop + 1) % 3], x[(drop + 2) % 3]}});
  const std::size_t n = flat.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto &a = flat.corners[k], &b = flat.corners[(k + 1) % n], &o = flat.corners[0];
    area += (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    for (int i = 0; i < 2; ++i) {
      flat.low[i] = std::min(flat.low[i], a[i]);
      flat.high[i] = std::max(flat.high[i], a[i]);
    }
  }
  if (area < 0.0) std::reverse(flat.corners.begin(), flat.corners.end());
  return flat;
}

/// Whether an edge of `a` has all of `b` on its outer side.
bool edge_separates(const Flat& a, const Flat& b) {
  const std::size_t n = a.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto &p = a.corners[k], &q = a.corners[(k + 1) % n];
    const double x = q[0] - p[0], y = q[1] - p[1], length = std::fabs(x) + std::fabs(y);
    const bool outside = std::all_of(b.corners.begin(), b.corners.end(), [&](const std::array<double, 2>& c) {
      const double u = c[0] - p[0], v = c[1] - p[1];
      return x * v - y * u <= kTouch * length * (std::fabs(u) + std::fabs(v) + length);
    });
    if (outside) return true;
  }
  return false;
}

bool within_hole(const FaceOutline& inner, const FaceOutline& outer) {
  if (outer.hole_radius <= 0.0) return false;
  return std::all_of(inner.corners.begin(), inner.corners.end(), [&](const Point3& x) {
    const Point3 d{{x[0] - outer.centre[0], x[1] - outer.centre[1], x[2] - outer.centre[2]}};
    return std::sqrt(dot(d, d)) <= outer.hole_radius * (1.0 + kTouch);
  });
}

class Finder {
 public:
  Finder(const std::vector<FlatFace>& faces, const FaceSource& source) : faces_(faces), source_(source) {}

  SharedPlanes find() {
    sort_planes();
    join_neighbours();
    std::map<std::uint32_t, std::vector<std::uint32_t>> planes;  // by the first face of each
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      if (parent_[f] != f || joined_[f]) planes[root(f)].push_back(f);
    }
    for (const auto& entry : planes) sweep(entry.second);
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

  FaceOutline outline(std::uint32_t face) const {
    FaceOutline out;
    source_.outline(faces_[face], &out);
    return out;
  }

  void sort_planes() {
    std::vector<double> offsets;
    double size = 0.0;
    FaceOutline face;
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      source_.outline(faces_[f], &face);
      const Plane plane = plane_of(face);
      const double* n = plane.normal.data();
      keys_.push_back({kGeneric[0] * n[0] + kGeneric[1] * n[1] + kGeneric[2] * n[2], faces_[f].frame, f});
      offsets.push_back(plane.offset);
      size = std::max(size, plane.size);
    }
    for (std::size_t k = 0; k < keys_.size(); ++k) keys_[k].value += kGeneric[3] * offsets[k] / std::max(size, 1e-300);
    std::sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) {
      if (a.frame != b.frame) return a.frame < b.frame;
      return a.value != b.value ? a.value < b.value : a.face < b.face;
    });
  }

  bool one_plane(std::uint32_t a, std::uint32_t b) const {
    const FaceOutline first = outline(a), second = outline(b);
    const Plane p = plane_of(first), q = plane_of(second);
    const double tolerance = kSame * std::max(p.size, q.size);
    return lies_on(first, q, tolerance) || lies_on(second, p, tolerance);
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
    const Plane plane = plane_of(outline(members.front()));
    std::vector<FaceOutline> outlines;
    std::vector<Flat> flats;
    std::vector<char> front, shared(members.size(), 0);
    for (const std::uint32_t f : members) {
      outlines.push_back(outline(f));
      flats.push_back(flatten(outlines.back(), plane.normal));
      front.push_back(plane_of(outlines.back()).front);
    }
    std::vector<std::uint32_t> order(members.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return flats[a].low[0] != flats[b].low[0] ? flats[a].low[0] < flats[b].low[0] : a < b;
    });
    double low = 1e300, high = -1e300;
    for (const Flat& flat : flats) {
      low = std::min(low, flat.low[1]);
      high = std::max(high, flat.high[1]);
    }
    const int stripes = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(members.size()))), 1, kMostStripes);
    const auto stripe = [&](double y) {
      return std::clamp(static_cast<int>((y - low) / std::max(high - low, 1e-300) * stripes), 0, stripes - 1);
    };
    std::vector<std::vector<std::uint32_t>> open(static_cast<std::size_t>(stripes));
    for (const std::uint32_t m : order) {
      const int first = stripe(flats[m].low[1]), last = stripe(flats[m].high[1]);
      for (int s = first; s <= last; ++s) {
        auto& list = open[static_cast<std::size_t>(s)];
        list.erase(std::remove_if(list.begin(), list.end(),
                                  [&](std::uint32_t k) { return flats[k].high[0] <= flats[m].low[0]; }),
                   list.end());
        for (const std::uint32_t k : list) {
          // A pair is compared in the first stripe that has both.
          if (s != std::max(first, stripe(flats[k].low[1])) || !overlap(flats[k], flats[m], outlines[k], outlines[m]))
            continue;
          shared[k] = shared[m] = 1;
          if (front[k] == front[m] && faces_[members[k]].material != faces_[members[m]].material) ++out_.conflicts;
        }
        list.push_back(m);
      }
    }
    record(members, plane, front, shared);
  }

  static bool overlap(const Flat& a, const Flat& b, const FaceOutline& face_a, const FaceOutline& face_b) {
    return !edge_separates(a, b) && !edge_separates(b, a) && !within_hole(face_a, face_b) &&
           !within_hole(face_b, face_a);
  }

  void record(const std::vector<std::uint32_t>& members, const Plane& plane, const std::vector<char>& front,
              const std::vector<char>& shared) {
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
      face.record[CLRAY_PLANE_FACING] = front[m] ? 1.0 : -1.0;
      out_.faces.push_back(face);
    }
  }

  const std::vector<FlatFace>& faces_;
  const FaceSource& source_;
  std::vector<Key> keys_;
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
