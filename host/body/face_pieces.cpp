// SPDX-License-Identifier: Apache-2.0
// See face_pieces.hpp. Only operations that every host rounds alike.
#include "body/face_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "body/in_parts.hpp"

namespace clray {
namespace {

using Point = std::array<double, 3>;

constexpr int kLevels = 30;  // of planes: cells of 2^-30 of the cube are the finest
constexpr double kCells = 1 << kLevels;
constexpr double kMostCuts = 64.0;     // of one face
constexpr std::size_t kSample = 8192;  // faces, at least, that tell how often all are cut
constexpr std::uint32_t kWhole = 0xffffffffu;

/// Boxes of pieces are enlarged by this share of the cube's size: more than the few roundings that their corners have.
/// Boxes of the tree are widened by far more (kernels/walk/plain.cl).
constexpr double kRoom = 1e-14;

// Areas of larger or smaller bodies do not fit a double.
constexpr double kSmallest = 1e-100, kLargest = 1e100;

double half_area(const Box& b) {
  const double x = b.high[0] - b.low[0], y = b.high[1] - b.low[1], z = b.high[2] - b.low[2];
  return x * y + y * z + z * x;
}

double longest(const Box& b) {
  return std::max({b.high[0] - b.low[0], b.high[1] - b.low[1], b.high[2] - b.low[2]});
}

/// Half of the least area that boxes around small pieces of a triangle have together: its projections along the axes.
double least_area(const double* d) {
  const double e[3] = {d[3] - d[0], d[4] - d[1], d[5] - d[2]}, f[3] = {d[6] - d[0], d[7] - d[1], d[8] - d[2]};
  return 0.5 * (std::fabs(e[1] * f[2] - e[2] * f[1]) + std::fabs(e[2] * f[0] - e[0] * f[2]) +
                std::fabs(e[0] * f[1] - e[1] * f[0]));
}

/// A plane across an axis, with its level: 1 halves the cube, 2 the halves, and so on.
struct Plane {
  int level = kLevels + 1, axis = 0;
  double at = 0.0;

  bool cuts() const { return level <= kLevels; }
};

/// A convex polygon: a triangle cut by planes across the axes.
struct Polygon {
  std::array<Point, 12> corners;  // three sides and two planes for each axis; the rest is for rounding
  std::size_t count = 0;
  bool whole = true;  // all corners found room

  explicit Polygon(const double* triangle) : count(3) {
    for (std::size_t k = 0; k < 3; ++k) corners[k] = {{triangle[3 * k], triangle[3 * k + 1], triangle[3 * k + 2]}};
  }
  /// What of a polygon lies below a plane (sign 1) or above it (sign -1).
  Polygon(const Polygon& of, const Plane& plane, double sign) : whole(of.whole) {
    const auto axis = static_cast<std::size_t>(plane.axis);
    for (std::size_t k = 0; k < of.count; ++k) {
      const Point &a = of.corners[k], &b = of.corners[k + 1 < of.count ? k + 1 : 0];
      const double from = sign * (a[axis] - plane.at), to = sign * (b[axis] - plane.at);
      if (from <= 0.0) add(a);
      if (!((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0))) continue;
      Point crossing;
      const double share = from / (from - to);
      for (std::size_t i = 0; i < 3; ++i) crossing[i] = a[i] + share * (b[i] - a[i]);
      crossing[axis] = plane.at;
      add(crossing);
    }
  }

  Box box() const {
    Box b;
    for (std::size_t k = 0; k < count; ++k) b.add(corners[k]);
    return b;
  }

 private:
  void add(const Point& corner) {
    whole = whole && count < corners.size();
    if (whole) corners[count++] = corner;
  }
};

}  // namespace

/// The cube around the body, whose halves, their halves and so on give the planes to cut at.
struct FacePieces::Cube {
  Point low{};
  double size = 0.0, cell = 0.0;  // of the cube, and of a finest cell

  // A little larger than the body, so that its far side lies within the last cell.
  explicit Cube(const Box& body) : size(longest(body) * 1.0001) {
    for (std::size_t k = 0; k < 3; ++k) low[k] = 0.5 * body.low[k] + 0.5 * body.high[k] - 0.5 * size;
    cell = std::ldexp(size, -kLevels);
  }

  /// The finest cell of a coordinate. Far from the origin rounding may move a coordinate beyond the cube's sides.
  std::uint32_t cell_of(double x, std::size_t axis) const {
    return static_cast<std::uint32_t>(std::clamp((x - low[axis]) / cell, 0.0, kCells - 1.0));
  }

  /// The coarsest plane through a box, the one across its longer side where there are several.
  Plane plane_through(const Box& box) const {
    Plane coarsest;
    double width = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t first = cell_of(box.low[axis], axis), last = cell_of(box.high[axis], axis);
      if (first == last) continue;
      const int level = __builtin_clz(first ^ last) - (31 - kLevels);  // by the highest bit in which they differ
      const double own = box.high[axis] - box.low[axis];
      if (level > coarsest.level || (level == coarsest.level && own <= width)) continue;
      const double at = low[axis] + static_cast<double>(last >> (kLevels - level) << (kLevels - level)) * cell;
      if (!(at > box.low[axis] && at < box.high[axis])) continue;
      coarsest = {level, static_cast<int>(axis), at};
      width = own;
    }
    return coarsest;
  }

  /// How much it matters to cut a face, see face_pieces.hpp; 0: not at all. The paper has a cubic root, which hosts
  /// round each in their own way; a square root opens as few boxes.
  double priority(const double* corners, const Box& whole) const {
    const double spare = half_area(whole) - least_area(corners);
    if (!(spare > 0.0)) return 0.0;
    const Plane plane = plane_through(whole);
    return plane.cuts() ? std::sqrt(std::ldexp(spare / (size * size), -plane.level)) : 0.0;
  }

  /// Boxes of the pieces of a polygon that is cut so many times.
  void cut(const Polygon& polygon, int cuts, std::vector<Box>* boxes) const {
    const Box box = polygon.box();
    const Plane plane = cuts > 0 ? plane_through(box) : Plane();
    if (plane.cuts()) {
      const Polygon below(polygon, plane, 1.0), above(polygon, plane, -1.0);
      if (below.whole && above.whole) {
        const double a = longest(below.box()), b = longest(above.box());
        const auto of_below = static_cast<int>(std::lround(static_cast<double>(cuts - 1) * a / (a + b)));
        cut(below, of_below, boxes);
        cut(above, cuts - 1 - of_below, boxes);
        return;
      }
    }
    boxes->push_back(box);
  }
};

/// A face and its pieces.
struct FacePieces::Cut {
  Box whole;
  std::vector<Box> boxes;  // empty: it is not cut

  void make(const BoxSource& faces, const Cube& cube, double per_priority, std::size_t face) {
    whole = faces.box(face);
    boxes.clear();
    const double* corners = faces.corners(face);
    if (corners == nullptr) return;
    const double cuts = std::floor(per_priority * cube.priority(corners, whole));
    if (!(cuts >= 1.0)) return;
    cube.cut(Polygon(corners), static_cast<int>(std::min(cuts, kMostCuts)), &boxes);
    for (Box& box : boxes) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::max(whole.low[k], box.low[k] - kRoom * cube.size);
        box.high[k] = std::min(whole.high[k], box.high[k] + kRoom * cube.size);
      }
    }
  }
  double half_area_of_boxes() const {
    double all = boxes.empty() ? half_area(whole) : 0.0;
    for (const Box& box : boxes) all += half_area(box);
    return all;
  }
};

FacePieces::FacePieces(BoxSource faces, const Box& body, bool may_cut, unsigned threads) : faces_(std::move(faces)) {
  if (!may_cut) return;
  const Cube cube(body);
  if (!(cube.size > kSmallest && cube.size < kLargest)) return;
  const double per_priority = cuts_per_priority(cube);
  if (per_priority > 0.0) cut(cube, per_priority, threads_for(faces_.count, threads));
}

/// By what priorities are multiplied so that pieces are as many as they may be; 0 where cutting brings too little.
double FacePieces::cuts_per_priority(const Cube& cube) const {
  const std::size_t stride = std::max<std::size_t>(1, faces_.count / kSample);
  std::vector<double> priorities;
  for (std::size_t i = 0; i < faces_.count; i += stride) {
    const double* corners = faces_.corners(i);
    priorities.push_back(corners != nullptr ? cube.priority(corners, faces_.box(i)) : 0.0);
  }
  const double most = kFurther * static_cast<double>(priorities.size());
  const double greatest = *std::max_element(priorities.begin(), priorities.end());
  if (!(greatest > 0.0)) return 0.0;
  const auto pieces = [&](double factor) {
    double sum = 0.0;
    for (const double p : priorities) sum += std::min(kMostCuts, std::floor(factor * p));
    return sum;
  };
  double low = 0.0, high = 2.0 * kMostCuts / greatest;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * low + 0.5 * high;
    (pieces(middle) <= most ? low : high) = middle;
  }
  double before = 0.0, after = 0.0;
  Cut face;
  for (std::size_t i = 0; i < faces_.count; i += stride) {
    face.make(faces_, cube, low, i);
    before += half_area(face.whole);
    after += face.half_area_of_boxes();
  }
  return after <= (1.0 - kLeastGain) * before ? low : 0.0;
}

void FacePieces::cut(const Cube& cube, double per_priority, unsigned threads) {
  std::mutex mutex;
  std::map<std::size_t, std::pair<std::vector<Piece>, std::vector<Piece>>> parts;  // by their first face
  in_parts(faces_.count, threads, [&](std::size_t first, std::size_t end) {
    std::vector<Piece> own, further;
    Cut face;
    for (std::size_t i = first; i < end; ++i) {
      face.make(faces_, cube, per_priority, i);
      for (std::size_t k = 0; k < face.boxes.size(); ++k)
        (k == 0 ? own : further).push_back({static_cast<std::uint32_t>(i), face.boxes[k]});
    }
    const std::lock_guard<std::mutex> lock(mutex);
    parts.emplace(first, std::pair(std::move(own), std::move(further)));
  });
  for (const auto& [first, part] : parts) {
    first_.insert(first_.end(), part.first.begin(), part.first.end());
    further_.insert(further_.end(), part.second.begin(), part.second.end());
  }
  first_of_.assign(faces_.count, kWhole);
  for (std::size_t k = 0; k < first_.size(); ++k) first_of_[first_[k].face] = static_cast<std::uint32_t>(k);
}

Box FacePieces::box(std::size_t k) const {
  if (k >= faces_.count) return further_[k - faces_.count].box;
  return first_of_.empty() || first_of_[k] == kWhole ? faces_.box(k) : first_[first_of_[k]].box;
}

std::uint32_t FacePieces::face(std::size_t k) const {
  return k >= faces_.count ? further_[k - faces_.count].face : static_cast<std::uint32_t>(k);
}

}  // namespace clray
