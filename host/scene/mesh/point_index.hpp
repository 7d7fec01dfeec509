// SPDX-License-Identifier: Apache-2.0
// Numbers points by their coordinates: points of equal value get one number. An open hash table, since a mesh of
// 10^6 faces asks 3·10^6 times.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// The distinct points met so far, in the order of their first coming.
class PointIndex {
 public:
  /// `expected`: how many distinct points may come; more may.
  explicit PointIndex(std::size_t expected = 0) {
    std::size_t size = 16;
    while (size < 2 * expected) size *= 2;
    slots_.assign(size, kFree);
    points_.reserve(expected);
  }

  /// The number of `point`; -0 equals 0.
  std::uint32_t number(const Vec3& point) {
    std::size_t at = place_of(point);
    if (slots_[at] != kFree) return slots_[at];
    if (2 * points_.size() >= slots_.size()) {
      grow();
      at = place_of(point);
    }
    slots_[at] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    return slots_[at];
  }

  const std::vector<Vec3>& points() const { return points_; }
  std::vector<Vec3> take() { return std::move(points_); }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;

  std::size_t place_of(const Vec3& point) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      const double value = point[k] + 0.0;
      std::uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
      hash ^= hash >> 32;
    }
    std::size_t at = hash & (slots_.size() - 1);
    while (slots_[at] != kFree && points_[slots_[at]] != point) at = (at + 1) & (slots_.size() - 1);
    return at;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kFree);
    for (std::uint32_t i = 0; i < points_.size(); ++i) slots_[place_of(points_[i])] = i;
  }

  std::vector<std::uint32_t> slots_;
  std::vector<Vec3> points_;
};

}  // namespace clray
