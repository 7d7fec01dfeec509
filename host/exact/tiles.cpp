// SPDX-License-Identifier: Apache-2.0
// See tiles.hpp.
#include "exact/tiles.hpp"

#include <algorithm>
#include <array>
#include <deque>

#include "exact/seen_faces.hpp"

namespace clray {
namespace {

constexpr std::size_t kFewFaces = 128;  // of a leaf: fewer make more tiles, more make each face's list longer
constexpr int kMostStalled = 2;
constexpr std::size_t kMostLevels = 48;  // halvings of each side

/// What a tile holds.
struct Held {
  std::vector<std::uint32_t> faces, pieces;
};

class Cutter {
 public:
  /// `pieces`: null where whole faces are looked for.
  Cutter(const BeamFaces& beam, const std::vector<ClrayPiece>* pieces,
         const std::function<bool(const TileFaces&)>& leaf)
      : beam_(beam), seen_(beam), pieces_(pieces), leaf_(leaf), kept_in_(pieces == nullptr ? 0 : beam.faces.size()) {
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
    const std::array<Rectangle, 4> quarters = r.quarters();
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
    seen_.keep(r, held.faces, &kept->faces);
    if (pieces_ == nullptr) return;
    ++tile_;
    for (const std::uint32_t face : kept->faces) kept_in_[face] = tile_;
    for (const std::uint32_t piece : held.pieces) {
      const Rectangle& box = boxes_[piece];
      const bool meets = box.x0 < r.x1 && box.x1 > r.x0 && box.y0 < r.y1 && box.y1 > r.y0;
      if (meets && kept_in_[(*pieces_)[piece].face] == tile_) kept->pieces.push_back(piece);
    }
  }

  const BeamFaces& beam_;
  const SeenFaces seen_;
  const std::vector<ClrayPiece>* pieces_;
  const std::function<bool(const TileFaces&)>& leaf_;
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
