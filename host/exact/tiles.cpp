// SPDX-License-Identifier: Apache-2.0
// See tiles.hpp.
#include "exact/tiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "exact/portable_faces.hpp"

namespace clray {
namespace {

constexpr std::size_t kFewFaces = 128;  // of a leaf: fewer make more tiles, more make each face's list longer
constexpr int kMostStalled = 2;
constexpr std::size_t kMostLevels = 48;  // halvings of each side
constexpr double kRounding = 1e-15;      // of sides and depths, relative

struct Rectangle {
  double x0, x1, y0, y1;
};

/// What a tile holds.
struct Held {
  std::vector<std::uint32_t> faces, pieces;
};

/// A face's edges and depth as a tile asks for them.
struct Edges {
  std::array<double, 3> dx, dy, tiny;  // direction, and what rounding may add to a side
  double depth_error;
};

class Cutter {
 public:
  /// `pieces`: null where whole faces are looked for.
  Cutter(const BeamFaces& beam, const std::vector<ClrayPiece>* pieces,
         const std::function<bool(const TileFaces&)>& leaf)
      : beam_(beam), pieces_(pieces), leaf_(leaf), kept_in_(pieces == nullptr ? 0 : beam.faces.size()) {
    edges_.reserve(beam.faces.size());
    for (const ClrayFace& f : beam.faces) {
      Edges e;
      for (int k = 0; k < 3; ++k) {
        const int next = k == 2 ? 0 : k + 1;
        e.dx[k] = f.x[next] - f.x[k];
        e.dy[k] = f.y[next] - f.y[k];
        e.tiny[k] = kRounding * beam.size * (std::fabs(e.dx[k]) + std::fabs(e.dy[k]));
      }
      e.depth_error = kRounding * beam.size * (1.0 + std::fabs(f.slope_x) + std::fabs(f.slope_y));
      edges_.push_back(e);
    }
    if (pieces_ == nullptr) return;
    boxes_.reserve(pieces_->size());
    for (const ClrayPiece& p : *pieces_) {
      const auto [x0, x1] = std::minmax_element(p.x, p.x + p.corners);
      const auto [y0, y1] = std::minmax_element(p.y, p.y + p.corners);
      boxes_.push_back({*x0, *x1, *y0, *y1});
    }
  }

  bool run() {
    Held all, kept;
    for (std::uint32_t k = 0; k < beam_.faces.size(); ++k) all.faces.push_back(k);
    for (std::uint32_t k = 0; k < boxes_.size(); ++k) all.pieces.push_back(k);
    const Rectangle whole{beam_.x0, beam_.x1, beam_.y0, beam_.y1};
    keep(whole, all, &kept);
    return idle(kept) || cut(whole, kept, 0, 0);
  }

 private:
  /// `stalled`: cuts in a row, down to this tile, that were of no use.
  bool cut(const Rectangle& r, const Held& held, std::size_t level, int stalled) {
    const std::size_t looked_for = pieces_ == nullptr ? held.faces.size() : held.pieces.size();
    if (held.faces.size() <= kFewFaces || looked_for * held.faces.size() <= kFewFaces * kFewFaces ||
        level == kMostLevels)
      return leaf(r, held);
    if (level == pools_.size()) pools_.emplace_back();
    std::array<Held, 4>& children = pools_[level];
    const double mx = 0.5 * (r.x0 + r.x1), my = 0.5 * (r.y0 + r.y1);
    const Rectangle quarters[4] = {
        {r.x0, mx, r.y0, my}, {mx, r.x1, r.y0, my}, {r.x0, mx, my, r.y1}, {mx, r.x1, my, r.y1}};
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < 4; ++k) {
      keep(quarters[k], held, &children[k]);
      const auto n = static_cast<double>(children[k].faces.size());
      sum += n;
      squares += n * n;
    }
    // A cut is of use where pairs of faces become fewer, or where no face is taken twice (all lie in one quarter). Of
    // many sheets on top of one another, or a fan about a point, no cut is of use, but of a crowd the next one may be.
    const auto n = static_cast<double>(held.faces.size());
    stalled = squares > 0.75 * n * n && sum > 1.25 * n ? stalled + 1 : 0;
    if (stalled > kMostStalled) return leaf(r, held);
    for (int k = 0; k < 4; ++k) {
      if (!idle(children[k]) && !cut(quarters[k], children[k], level + 1, stalled)) return false;
    }
    return true;
  }

  bool leaf(const Rectangle& r, const Held& held) {
    largest_first_ = held.faces;
    std::sort(largest_first_.begin(), largest_first_.end(), [&](std::uint32_t i, std::uint32_t k) {
      return beam_.areas[i] != beam_.areas[k] ? beam_.areas[i] > beam_.areas[k] : i < k;
    });
    return leaf_({r.x0, r.x1, r.y0, r.y1, largest_first_, held.pieces});
  }

  /// Whether nothing in a tile is looked for.
  bool idle(const Held& held) const { return held.faces.empty() || (pieces_ != nullptr && held.pieces.empty()); }

  /// What of a tile may be seen in a part of it.
  void keep(const Rectangle& r, const Held& held, Held* kept) {
    kept->faces.clear();
    kept->pieces.clear();
    keep_seen(r, held.faces, &kept->faces);
    if (pieces_ == nullptr) return;
    ++tile_;
    for (const std::uint32_t face : kept->faces) kept_in_[face] = tile_;
    for (const std::uint32_t piece : held.pieces) {
      const Rectangle& box = boxes_[piece];
      const bool meets = box.x0 < r.x1 && box.x1 > r.x0 && box.y0 < r.y1 && box.y1 > r.y0;
      if (meets && kept_in_[(*pieces_)[piece].face] == tile_) kept->pieces.push_back(piece);
    }
  }

  enum Place { outside, meets, covers };

  Place place(std::uint32_t face, const Rectangle& r) const {
    const ClrayFace& f = beam_.faces[face];
    if (f.box[0] >= r.x1 || f.box[1] <= r.x0 || f.box[2] >= r.y1 || f.box[3] <= r.y0) return outside;
    const Edges& e = edges_[face];
    bool covering = true;
    for (int k = 0; k < 3; ++k) {
      const double dx = e.dx[k], dy = e.dy[k];
      const double high = dx * ((dx > 0.0 ? r.y1 : r.y0) - f.y[k]) - dy * ((dy > 0.0 ? r.x0 : r.x1) - f.x[k]);
      if (high <= -e.tiny[k]) return outside;
      const double low = dx * ((dx > 0.0 ? r.y0 : r.y1) - f.y[k]) - dy * ((dy > 0.0 ? r.x1 : r.x0) - f.x[k]);
      covering = covering && low >= e.tiny[k];
    }
    return covering ? covers : meets;
  }

  double depth_at(std::uint32_t face, double x, double y) const {
    const ClrayFace& f = beam_.faces[face];
    return f.depth0 + f.slope_x * (x - f.x[0]) + f.slope_y * (y - f.y[0]);
  }
  double least_depth(std::uint32_t face, const Rectangle& r) const {
    const ClrayFace& f = beam_.faces[face];
    return depth_at(face, f.slope_x > 0.0 ? r.x0 : r.x1, f.slope_y > 0.0 ? r.y0 : r.y1) - edges_[face].depth_error;
  }
  double greatest_depth(std::uint32_t face, const Rectangle& r) const {
    const ClrayFace& f = beam_.faces[face];
    const double there = depth_at(face, f.slope_x > 0.0 ? r.x1 : r.x0, f.slope_y > 0.0 ? r.y1 : r.y0);
    return std::min(f.nearest, there + edges_[face].depth_error);
  }

  /// Whether a face that covers the rectangle hides another in all of it.
  bool hidden(std::uint32_t face, std::uint32_t cover, const Rectangle& r) const {
    const ClrayFace &f = beam_.faces[face], &c = beam_.faces[cover];
    const double a = f.slope_x - c.slope_x, b = f.slope_y - c.slope_y;
    const double x = a > 0.0 ? r.x1 : r.x0, y = b > 0.0 ? r.y1 : r.y0;
    const double gap = depth_at(face, x, y) - depth_at(cover, x, y);
    if (gap < -(f.margin + c.margin + edges_[face].depth_error + edges_[cover].depth_error)) return true;
    return face_hides(c, f, beam_.margin);
  }

  /// The faces among `faces` that may be seen in a rectangle.
  void keep_seen(const Rectangle& r, const std::vector<std::uint32_t>& faces, std::vector<std::uint32_t>* kept) const {
    double covered = -HUGE_VAL;  // nothing farther is seen
    std::int64_t cover = -1;
    for (const std::uint32_t face : faces) {
      const ClrayFace& f = beam_.faces[face];
      if (f.nearest + f.margin < covered) continue;
      const Place where = place(face, r);
      if (where == outside || greatest_depth(face, r) + f.margin < covered) continue;
      if (where == covers) {
        const double least = least_depth(face, r);
        if (least > covered) {
          covered = least;
          cover = face;
        }
      }
      kept->push_back(face);
    }
    if (cover < 0) return;
    const auto last = std::remove_if(kept->begin(), kept->end(), [&](std::uint32_t face) {
      return face != cover && hidden(face, static_cast<std::uint32_t>(cover), r);
    });
    kept->erase(last, kept->end());
  }

  const BeamFaces& beam_;
  const std::vector<ClrayPiece>* pieces_;
  const std::function<bool(const TileFaces&)>& leaf_;
  std::vector<Edges> edges_;
  std::vector<Rectangle> boxes_;        // of the pieces
  std::vector<std::uint64_t> kept_in_;  // the last tile that kept a face
  std::uint64_t tile_ = 0;
  std::vector<std::uint32_t> largest_first_;
  std::deque<std::array<Held, 4>> pools_;
};

}  // namespace

bool cut_tiles(const BeamFaces& beam, const std::function<bool(const TileFaces&)>& leaf) {
  return beam.faces.empty() || Cutter(beam, nullptr, leaf).run();
}

bool cut_tiles(const BeamFaces& beam, const std::vector<ClrayPiece>& pieces,
               const std::function<bool(const TileFaces&)>& leaf) {
  return beam.faces.empty() || Cutter(beam, &pieces, leaf).run();
}

}  // namespace clray
