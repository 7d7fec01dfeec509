// SPDX-License-Identifier: Apache-2.0
// Seeded random numbers for scenes: the same on every machine (the distributions of the standard library are not), and
// values for a key of the project's tables by the range that its row states.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "clray/scene.hpp"
#include "scene/tables.hpp"

namespace clray_test {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed * 0x9e3779b97f4a7c15u + 0x632be59bd9b4e019u) {}

  double share() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< in [0,1)
  double between(double low, double high) { return low + (high - low) * share(); }
  bool chance(double probability) { return share() < probability; }
  /// A whole number of low … high.
  int whole(int low, int high) { return low + static_cast<int>(share() * (high - low + 1)); }
  std::uint64_t word() { return engine_(); }

  template <class T>
  const T& of(const std::vector<T>& list) {
    return list[static_cast<std::size_t>(whole(0, static_cast<int>(list.size()) - 1))];
  }
  template <class T>
  void shuffle(std::vector<T>* list) {
    for (std::size_t i = list->size(); i > 1; --i)
      std::swap((*list)[i - 1], (*list)[static_cast<std::size_t>(whole(0, static_cast<int>(i) - 1))]);
  }

  clray::Vec3 direction();
  clray::Vec3 place(double reach) { return {between(-reach, reach), between(-reach, reach), between(-reach, reach)}; }

  /// A value that the key accepts: its ends now and then, sizes of about 1 where the range is open, small whole
  /// numbers.
  double key(const clray::TableKey& key);

 private:
  std::mt19937_64 engine_;
};

}  // namespace clray_test
