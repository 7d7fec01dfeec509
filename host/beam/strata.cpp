// SPDX-License-Identifier: Apache-2.0
// See strata.hpp. Lengths in m, in the beam's axes (u, v, toward the source); path lengths relative to the origin.
#include "beam/strata.hpp"

#include <algorithm>
#include <cmath>

#include "beam/beams.hpp"
#include "beam/cell_weights.hpp"
#include "beam/silhouette.hpp"

namespace clray {
namespace {

constexpr double kMostStrips = 1024.0;      // over the body, of path length
constexpr double kSmallestExtent = 1e-300;  // m; paths of a body seen face-on are all alike
constexpr int kMostCuts = 32;               // parts of a cell
constexpr double kMostPieces = 1 << 27;     // over all views; cells are rarely cut into so many
constexpr std::size_t kStretch = 4;         // intervals of path on either side that share one probability
// These shares of the probability follow area and path length; the rest follows what the surface sends.
constexpr double kByArea = 0.25;
constexpr double kByPath = 0.375;

/// A part of a cell: the area between two lines across its direction of steepest path.
struct Piece {
  std::int64_t path;       // the interval of path length that it lies in
  std::uint32_t column;    // 0: its strip is that whole interval; else 1 + the column of cells that is its strip
  std::uint32_t place;     // CLRAY_PIECE_*
  std::uint32_t from, to;  // shares of the cell's area below its two lines, in 1/CLRAY_PIECE_PARTS
  double weight;           // of the surface there
  double probability;
};

/// Share of the unit square with x + r·y <= s, 0 <= r <= 1.
double share_below(double s, double r) {
  if (s <= 0.0) return 0.0;
  if (s >= 1.0 + r) return 1.0;
  if (s < r) return s * s / (2.0 * r);
  if (s <= 1.0) return s - 0.5 * r;
  return 1.0 - (1.0 + r - s) * (1.0 + r - s) / (2.0 * r);
}

/// Cells of an n × n grid, sorted by their direction from its middle, then by their distance from it.
std::vector<std::uint32_t> cells_by_direction(std::uint32_t n) {
  struct Key {
    double turn, size;
    std::uint32_t cell;
  };
  std::vector<Key> keys;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double x = 2.0 * i + 1.0 - n, y = 2.0 * j + 1.0 - n;  // odd: never the middle itself
      const double slope = y / (std::fabs(x) + std::fabs(y));
      keys.push_back({x > 0.0 ? slope : 2.0 - slope, std::fabs(x) + std::fabs(y), j * n + i});
    }
  }
  std::sort(keys.begin(), keys.end(),
            [](const Key& a, const Key& b) { return a.turn != b.turn ? a.turn < b.turn : a.size < b.size; });
  std::vector<std::uint32_t> order;
  for (const Key& key : keys) order.push_back(key.cell);
  return order;
}

/// The strata of one view.
class Stratifier {
 public:
  Stratifier(const Geometry& geometry, const Steering& steering, const Beams& beams, std::size_t v,
             const BeamGrid& grid)
      : geometry_(geometry), steering_(steering), beams_(beams), v_(v), grid_(grid), n_(grid.cells) {}

  /// Appends the strata to *strata and notes their place in the view. Where there is nothing to stratify it does
  /// neither.
  void run(const std::vector<BeamCell>& cells, const std::vector<std::uint32_t>& order, const Vec3& reference,
           std::vector<ClrayStratum>* strata, ClrayView* view, double* area_m2) {
    cells_ = &cells;
    cell_u_ = grid_.size_u / n_;
    cell_v_ = grid_.size_v / n_;
    const CellsOfView all{geometry_, steering_, beams_, v_, grid_, cells};
    if (steering_.by == Steering::By::direct) weights_ = direct_weights(all);
    if (steering_.by == Steering::By::exchange) weights_ = exchange_weights(all);
    weights_.resize(cells.size());
    by_path_ = steering_.bins.has_value();
    if (by_path_) plan_strips(reference);
    for (const std::uint32_t cell : order) {
      if (cells[cell].state == BeamCell::empty) continue;
      by_path_ ? cut(cell) : whole(cell);
    }
    if (pieces_.empty()) return;
    probabilities();
    write(strata, view, area_m2);
  }

 private:
  vec3 to_beam(const double* x) const {
    const vec3 body = v3_load(x);
    return v3(v3_dot(body, grid_.u), v3_dot(body, grid_.v), v3_dot(body, grid_.toward));
  }

  /// Strips end at edges of the first histogram's bins. A strip is some bins, or a whole part of one; a body has 256 to
  /// 1024 of them.
  void plan_strips(const Vec3& reference) {
    const double* o = beams_.connections[v_ * (beams_.connections.size() / beams_.views.size())].direction;
    way_ = to_beam(o);
    way_.z += 1.0;
    width_ = steering_.bins->bin_m;
    const PathRange paths = steering_.paths.view(v_);
    const double extent = paths.high_m - paths.low_m;
    while (extent > kMostStrips * width_) width_ *= 2.0;
    while (extent > kSmallestExtent && extent < 0.25 * kMostStrips * width_) width_ *= 0.5;
    // Strips end where bins do, unless the window is so far off that bins up to the body cannot be counted.
    double origin = steering_.bins->first_m;
    const double off = std::max(std::fabs(paths.low_m - origin), std::fabs(paths.high_m - origin));
    if (!(off < 0x1p52 * width_)) origin = paths.low_m;
    first_ = origin - v3_dot(way_, to_beam(&reference[0]));
    const double cells = static_cast<double>(beams_.views.size() * cells_->size());
    lowest_ = static_cast<std::int64_t>(std::floor((paths.low_m - origin) / width_));
    highest_ = static_cast<std::int64_t>(std::floor((paths.high_m - origin) / width_));
    cuts_ = std::clamp(static_cast<int>(kMostPieces / cells), 1, kMostCuts);  // few cells need as many
  }

  /// Cuts a cell where its surface crosses from one strip to the next.
  void cut(std::uint32_t at) {
    const BeamCell& cell = (*cells_)[at];
    const std::uint32_t i = at % n_, j = at / n_;
    const double u = grid_.u0 + (i + 0.5) * cell_u_, v = grid_.v0 + (j + 0.5) * cell_v_;
    // Along a surface with normal n, w falls by n.x/n.z per unit of u.
    const double nz = std::max(cell.normal.z, std::max(1e-6 * v3_length(cell.normal), 1e-300));
    const double gu = -(way_.x - way_.z * cell.normal.x / nz) * cell_u_;
    const double gv = -(way_.y - way_.z * cell.normal.y / nz) * cell_v_;
    const bool swap = std::fabs(gv) > std::fabs(gu);
    const double high = swap ? std::fabs(gv) : std::fabs(gu), low = swap ? std::fabs(gu) : std::fabs(gv);
    const auto steps =
        static_cast<std::uint32_t>(high > 0.0 ? std::floor(low / high * CLRAY_PIECE_STEEPNESS + 0.5) : 0.0);
    const double r = steps / static_cast<double>(CLRAY_PIECE_STEEPNESS);
    // Pieces go round the middle of the beam, within a cell as well.
    const double x = 2.0 * i + 1.0 - n_, y = 2.0 * j + 1.0 - n_;
    const double along_u = swap ? (gu < 0.0 ? -1.0 : 1.0) : (gu < 0.0 ? r : -r);
    const double along_v = swap ? (gv < 0.0 ? r : -r) : (gv < 0.0 ? -1.0 : 1.0);
    const bool reverse = along_v * x - along_u * y < 0.0;
    const std::uint32_t place = (reverse ? CLRAY_PIECE_REVERSE : 0u) | at | steps << CLRAY_PIECE_STEEPNESS_SHIFT |
                                (gu < 0.0 ? CLRAY_PIECE_FLIP_U : 0u) | (gv < 0.0 ? CLRAY_PIECE_FLIP_V : 0u) |
                                (swap ? CLRAY_PIECE_SWAP : 0u);
    const double middle = -(way_.x * u + way_.y * v + way_.z * cell.w);
    const double start = middle - 0.5 * high * (1.0 + r), span = high * (1.0 + r);
    const std::int64_t k0 = interval_of(start), k1 = interval_of(start + span);
    if (span * n_ < width_) {  // face-on: all paths are alike, so columns make the strata
      add(interval_of(middle), i + 1, at | (x < 0.0 ? CLRAY_PIECE_REVERSE : 0u), 0.0, 1.0, weights_[at]);
      return;
    }
    if (k1 - k0 >= cuts_) {  // too steep to be cut at every strip: even parts
      for (int k = 0; k < cuts_; ++k)
        add(interval_of(start + span * (k + 0.5) / cuts_), 0, place, share_below((1.0 + r) * k / cuts_, r),
            share_below((1.0 + r) * (k + 1.0) / cuts_, r), weights_[at]);
      return;
    }
    for (std::int64_t k = k0; k <= k1; ++k) {
      const double from = k == k0 ? 0.0 : share_below((first_ + static_cast<double>(k) * width_ - start) / high, r);
      const double to = k == k1 ? 1.0 : share_below((first_ + static_cast<double>(k + 1) * width_ - start) / high, r);
      add(k, 0, place, from, to, weights_[at]);
    }
  }

  /// The interval that a path length lies in. The plane of a steep cell may reach beyond the body; its paths there
  /// count as the body's last.
  std::int64_t interval_of(double path) const {
    const double k = std::floor((path - first_) / width_);
    return static_cast<std::int64_t>(std::clamp(k, static_cast<double>(lowest_), static_cast<double>(highest_)));
  }

  void whole(std::uint32_t at) { add(0, at % n_ + 1, at, 0.0, 1.0, weights_[at]); }

  void add(std::int64_t path, std::uint32_t column, std::uint32_t place, double from, double to, double weight) {
    const auto a = static_cast<std::uint32_t>(std::floor(from * CLRAY_PIECE_PARTS + 0.5));
    const auto b = static_cast<std::uint32_t>(std::floor(to * CLRAY_PIECE_PARTS + 0.5));
    if (a >= b) return;
    pieces_.push_back({path, column, place, a, b, weight, 0.0});
  }

  std::size_t interval(const Piece& piece) const { return static_cast<std::size_t>(piece.path - lowest_); }
  std::size_t strip(const Piece& piece) const { return interval(piece) * (n_ + 1) + piece.column; }

  void probabilities() {
    std::vector<double> area(static_cast<std::size_t>(highest_ - lowest_ + 1), 0.0);
    double all = 0.0, weight = 0.0;
    for (const Piece& piece : pieces_) {
      const double size = piece.to - piece.from;
      area[interval(piece)] += size;
      all += size;
      weight += piece.weight * size;
    }
    // Stretches of path length have equal shares, but less where there is little area. A sliver beside full intervals
    // must not have a share of its own: its few rays would have another weight than the rest, and most replicates would
    // miss them.
    double filled = 0.0, shares = 0.0;
    for (const double a : area) filled += a > 0.0 ? 1.0 : 0.0;
    const double little = all / (16.0 * filled);
    std::vector<double> about(area.size());
    for (std::size_t k = 0; k < area.size(); ++k) {
      const std::size_t first = k < kStretch ? 0 : k - kStretch, last = std::min(k + kStretch, area.size() - 1);
      double sum = 0.0;
      for (std::size_t m = first; m <= last; ++m) sum += area[m];
      about[k] = sum / static_cast<double>(last - first + 1) + little;
      shares += area[k] / about[k];
    }
    const double by_path = by_path_ ? kByPath : 0.0;
    const double by_weight = weight > 0.0 ? 1.0 - kByArea - kByPath : 0.0;
    const double by_area = 1.0 - by_path - by_weight;
    for (Piece& piece : pieces_) {
      const double size = piece.to - piece.from;
      piece.probability = by_area * size / all + by_path * size / (about[interval(piece)] * shares);
      if (weight > 0.0) piece.probability += by_weight * piece.weight * size / weight;
    }
  }

  /// Ends of intervals that fill [0, 2^32) one after the other, in proportion to `probabilities`. Each is at least 1
  /// long.
  static std::vector<std::uint32_t> intervals(const std::vector<double>& probabilities) {
    double sum = 0.0;
    for (const double p : probabilities) sum += p;
    const double room = 4294967296.0 - static_cast<double>(probabilities.size());
    std::vector<std::uint32_t> last;
    double so_far = 0.0;
    for (const double p : probabilities) {
      so_far += p;
      const double end = std::floor(std::min(so_far / sum, 1.0) * room) + static_cast<double>(last.size() + 1);
      last.push_back(static_cast<std::uint32_t>(end - 1.0));
    }
    last.back() = 0xffffffffu;
    return last;
  }

  /// The choice among `last.size()` strata, with a guide to where each part of [0, 2^32) begins.
  static void append(const std::vector<std::uint32_t>& last, std::vector<ClrayStratum>* strata) {
    const auto count = static_cast<double>(last.size());
    std::uint32_t k = 0;
    for (std::size_t g = 0; g < last.size(); ++g) {
      while (last[k] + 1.0 < static_cast<double>(g) / count * 4294967296.0 - 1.0) ++k;
      strata->push_back({last[g], k, 0u, 0u});
    }
  }

  /// Sorts the pieces by strip and keeps their order within each. Returns where each strip starts, and the end.
  std::vector<std::size_t> sort_by_strip(std::vector<Piece>* sorted) const {
    std::vector<std::size_t> next(static_cast<std::size_t>(highest_ - lowest_ + 1) * (n_ + 1) + 1, 0), starts;
    for (const Piece& piece : pieces_) ++next[strip(piece) + 1];
    for (std::size_t s = 0; s + 1 < next.size(); ++s) {
      if (next[s + 1] != 0) starts.push_back(next[s]);
      next[s + 1] += next[s];
    }
    starts.push_back(pieces_.size());
    sorted->resize(pieces_.size());
    for (const Piece& piece : pieces_) (*sorted)[next[strip(piece)]++] = piece;
    return starts;
  }

  void write(std::vector<ClrayStratum>* strata, ClrayView* view, double* area_m2) const {
    std::vector<Piece> pieces;
    const std::vector<std::size_t> starts = sort_by_strip(&pieces);
    const std::size_t strips = starts.size() - 1;
    std::vector<double> each, of_strip(strips, 0.0);
    for (std::size_t s = 0; s < strips; ++s) {
      for (std::size_t k = starts[s]; k < starts[s + 1]; ++k) of_strip[s] += pieces[k].probability;
    }
    const std::vector<std::uint32_t> strip_last = intervals(of_strip);
    view->first_stratum = static_cast<std::uint32_t>(strata->size());
    view->strips = static_cast<std::uint32_t>(strips);
    view->grid = n_;
    append(strip_last, strata);
    double largest = 0.0;
    for (std::size_t s = 0; s < strips; ++s) {
      each.clear();
      for (std::size_t k = starts[s]; k < starts[s + 1]; ++k) each.push_back(pieces[k].probability);
      const std::vector<std::uint32_t> last = intervals(each);
      ClrayStratum& strip = (*strata)[view->first_stratum + s];
      strip.a = static_cast<std::uint32_t>(strata->size());
      strip.b = static_cast<std::uint32_t>(last.size());
      const std::size_t first = strata->size();
      append(last, strata);
      for (std::size_t k = 0; k < last.size(); ++k) {
        const Piece& piece = pieces[starts[s] + k];
        (*strata)[first + k].a = piece.place;
        (*strata)[first + k].b = piece.from | (piece.to - 1u) << 16;
        largest = std::max(largest, (piece.to - piece.from) / (size(strip_last, s) * size(last, k)));
      }
    }
    int exponent;
    std::frexp(largest, &exponent);
    view->share_scale = std::ldexp(1.0, -exponent);  // shares stay below 1
    *area_m2 = grid_.size_u * grid_.size_v / (1.0 * CLRAY_PIECE_PARTS * n_ * n_) * std::ldexp(1.0, 64 + exponent);
  }

  static double size(const std::vector<std::uint32_t>& last, std::size_t k) {
    return static_cast<double>(last[k]) - (k == 0 ? -1.0 : static_cast<double>(last[k - 1]));
  }

  const Geometry& geometry_;
  const Steering& steering_;
  const Beams& beams_;
  std::size_t v_;
  const BeamGrid& grid_;
  std::uint32_t n_;
  const std::vector<BeamCell>* cells_ = nullptr;
  bool by_path_ = false;
  int cuts_ = 1;
  double cell_u_ = 0.0, cell_v_ = 0.0, first_ = 0.0, width_ = 1.0;
  vec3 way_{};  // path length by way of x is -way·x
  std::int64_t lowest_ = 0, highest_ = 0;
  std::vector<Piece> pieces_;
  std::vector<double> weights_;
};

}  // namespace

Beams stratified(Beams beams, const Scene& scene, const Geometry& geometry, const BeamRequest& request,
                 const Steering& steering) {
  if (request.pixels || scene.trace.sampler != SamplerKind::strata) return beams;
  const std::uint32_t n = grid_cells(beams.views.size());
  std::vector<std::uint32_t> order;
  if (steering.bins) {
    constexpr std::uint32_t kUsual = 64;  // most beams have as many cells along an edge
    static const std::vector<std::uint32_t> usual = cells_by_direction(kUsual);
    order = n == kUsual ? usual : cells_by_direction(n);
  } else {
    for (std::uint32_t k = 0; k < n * n; ++k) order.push_back(k);
  }
  for (std::size_t v = 0; v < beams.views.size(); ++v) {
    ClrayView& view = beams.views[v];
    const vec3 s = v3_load(view.toward), corner = v3_load(view.corner);
    BeamGrid grid{{}, {}, s, 0.0, 0.0, v3_length(v3_load(view.edge_u)), v3_length(v3_load(view.edge_v)), n};
    if (!(grid.size_u * grid.size_v > 0.0)) continue;
    v3_frame(s, &grid.u, &grid.v);
    grid.u0 = v3_dot(corner, grid.u);
    grid.v0 = v3_dot(corner, grid.v);
    const std::vector<BeamCell> cells =
        silhouette_cells(geometry, motions_of(scene, geometry, request.orientations[v]), grid);
    if (cells.empty()) continue;
    Stratifier(geometry, steering, beams, v, grid)
        .run(cells, order, scene.reference_point, &beams.strata, &view, &beams.area_m2[v]);
    if (v == 0) beams.strata.reserve(beams.strata.size() * (beams.views.size() + beams.views.size() / 8));
  }
  return beams;
}

}  // namespace clray
