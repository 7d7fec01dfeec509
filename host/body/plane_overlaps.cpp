// SPDX-License-Identifier: Apache-2.0
// See plane_overlaps.hpp. Two outlines overlap where no edge of either separates them. Coordinates of the part's frame
// without the one along which the plane's normal is largest, metres.
#include "body/plane_overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace clray {
namespace {

constexpr double kTouch = 1e-12;  // of the sizes: outlines that overlap by less only touch
constexpr double kMostStripes = 1024.0;
constexpr std::size_t kFew = 8;  // faces of a plane that are compared pair by pair

/// A face's outline within its plane, counter-clockwise.
struct Flat {
  std::vector<std::array<double, 2>> corners;
  std::array<double, 2> low{{1e300, 1e300}}, high{{-1e300, -1e300}};
};

/// Drops the coordinate along which the normal is largest. The others keep their bits, so shared edges stay shared.
Flat flatten(const FaceOutline& outline, const std::array<double, 3>& normal) {
  int drop = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(normal[i]) > std::fabs(normal[drop])) drop = i;
  }
  Flat flat;
  double area = 0.0;
  for (const auto& x : outline.corners) flat.corners.push_back({{x[(drop + 1) % 3], x[(drop + 2) % 3]}});
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
  return std::all_of(inner.corners.begin(), inner.corners.end(), [&](const std::array<double, 3>& x) {
    const double u = x[0] - outer.centre[0], v = x[1] - outer.centre[1], w = x[2] - outer.centre[2];
    return std::sqrt(std::fma(u, u, std::fma(v, v, w * w))) <= outer.hole_radius * (1.0 + kTouch);
  });
}

/// What is known of a face. Comparing one that is `settled` with another can tell of the other only.
enum class Known { nothing, shared, settled };

/// The faces of a stripe that the sweep has begun and not yet left. Faces that look the same way with one material
/// stand together, since they need no comparison among themselves once they are known to be shared.
struct Stripe {
  using ByMaterial = std::unordered_map<std::uint32_t, std::vector<std::uint32_t>>;
  std::vector<std::uint32_t> nothing;
  std::array<ByMaterial, 2> shared, settled;  // by the way that they look
};

class Sweep {
 public:
  Sweep(const PlaneFace* faces, std::size_t count, const std::array<double, 3>& normal) : faces_(faces) {
    flats_.reserve(count);
    for (std::size_t k = 0; k < count; ++k) flats_.push_back(flatten(faces[k].outline, normal));
    found_.shared.assign(count, 0);
    found_.conflicting.assign(count, 0);
  }

  PlaneOverlaps find() {
    if (flats_.size() > kFew) {
      cut_into_stripes();
      sweep();
    } else {
      for (std::uint32_t a = 0; a < flats_.size(); ++a) {
        for (std::uint32_t b = a + 1; b < flats_.size(); ++b) compare(a, b);
      }
    }
    return std::move(found_);
  }

 private:
  void sweep() {
    std::vector<std::uint32_t> order(flats_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return flats_[a].low[0] != flats_[b].low[0] ? flats_[a].low[0] < flats_[b].low[0] : a < b;
    });
    for (const std::uint32_t face : order) {
      const int last = stripe_of(flats_[face].high[1]);
      for (int s = stripe_of(flats_[face].low[1]); s <= last; ++s) {
        Stripe& stripe = stripes_[static_cast<std::size_t>(s)];
        meet(face, s, stripe);
        put(face, stripe);
      }
    }
  }

  /// As many stripes as keep a face in about two of them.
  void cut_into_stripes() {
    double low = 1e300, high = -1e300, heights = 0.0;
    for (const Flat& flat : flats_) {
      low = std::min(low, flat.low[1]);
      high = std::max(high, flat.high[1]);
      heights += flat.high[1] - flat.low[1];
    }
    const auto count = static_cast<double>(flats_.size());
    const double most = std::min(std::sqrt(count), (high - low) / std::max(heights / count, 1e-300));
    stripes_.resize(static_cast<std::size_t>(std::clamp(most, 1.0, kMostStripes)));
    low_ = low;
    height_ = std::max(high - low, 1e-300);
  }

  int stripe_of(double y) const {
    const auto count = static_cast<int>(stripes_.size());
    return std::clamp(static_cast<int>((y - low_) / height_ * count), 0, count - 1);
  }

  Known known(std::uint32_t face) const {
    if (found_.conflicting[face]) return Known::settled;
    return found_.shared[face] ? Known::shared : Known::nothing;
  }

  void put(std::uint32_t face, Stripe& stripe) const {
    const Known state = known(face);
    if (state == Known::nothing) {
      stripe.nothing.push_back(face);
    } else {
      auto& lists = state == Known::shared ? stripe.shared : stripe.settled;
      lists[faces_[face].front][faces_[face].material].push_back(face);
    }
  }

  bool conflict(std::uint32_t face, bool front, std::uint32_t material) const {
    return faces_[face].front == front && faces_[face].material != material;
  }

  void compare(std::uint32_t a, std::uint32_t b) {
    ++found_.compared;
    const FaceOutline &first = faces_[a].outline, &second = faces_[b].outline;
    if (edge_separates(flats_[a], flats_[b]) || edge_separates(flats_[b], flats_[a]) || within_hole(first, second) ||
        within_hole(second, first))
      return;
    found_.shared[a] = found_.shared[b] = 1;
    if (conflict(a, faces_[b].front, faces_[b].material)) found_.conflicting[a] = found_.conflicting[b] = 1;
  }

  /// Compares a face with those of the stripe, wherever that can change what is known.
  void meet(std::uint32_t face, int number, Stripe& stripe) {
    visit(face, number, stripe, stripe.nothing, Known::nothing, [] { return true; });
    for (const Known state : {Known::shared, Known::settled}) {
      auto& lists = state == Known::shared ? stripe.shared : stripe.settled;
      for (const bool front : {faces_[face].front, !faces_[face].front}) {
        for (auto list = lists[front].begin(); list != lists[front].end();) {
          const bool opposed = conflict(face, front, list->first);
          const auto wanted = [&] {
            return known(face) == Known::nothing ||
                   (opposed && (state == Known::shared || known(face) == Known::shared));
          };
          visit(face, number, stripe, list->second, state, wanted);
          list = list->second.empty() ? lists[front].erase(list) : std::next(list);
          if (state == Known::settled && known(face) == Known::settled) return;
        }
        if (known(face) != Known::nothing && front == faces_[face].front) break;
      }
    }
  }

  /// Compares a face with those of a list while that is `wanted`. Drops from the list what the sweep has left and what
  /// is no longer of the list's state.
  template <typename Wanted>
  void visit(std::uint32_t face, int number, Stripe& stripe, std::vector<std::uint32_t>& list, Known state,
             const Wanted& wanted) {
    for (std::size_t i = 0; i < list.size();) {
      const std::uint32_t other = list[i];
      bool stays = flats_[other].high[0] > flats_[face].low[0];
      if (stays) {
        if (!wanted()) return;
        // A pair is compared in the first stripe that has both.
        const bool first = number == std::max(stripe_of(flats_[face].low[1]), stripe_of(flats_[other].low[1]));
        if (first && known(other) == state) compare(other, face);
        stays = known(other) == state;
        if (!stays) put(other, stripe);
      }
      if (stays) {
        ++i;
      } else {
        list[i] = list.back();
        list.pop_back();
      }
    }
  }

  const PlaneFace* faces_;
  std::vector<Flat> flats_;
  std::vector<Stripe> stripes_;
  double low_ = 0.0, height_ = 1.0;
  PlaneOverlaps found_;
};

}  // namespace

PlaneOverlaps find_overlaps(const PlaneFace* faces, std::size_t count, const std::array<double, 3>& normal) {
  return Sweep(faces, count, normal).find();
}

}  // namespace clray
