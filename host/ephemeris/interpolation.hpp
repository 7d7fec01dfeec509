// SPDX-License-Identifier: Apache-2.0
// Polynomials through a table of vectors by time: Lagrange through the nearest points, or Hermite through points and
// their rates. In Newton's form with the divided differences of each window made once (Press et al. 2007, section 3.2).
#pragma once

#include <cstddef>
#include <vector>

#include "clray/scene.hpp"

namespace clray::ephemeris {

/// A value and its rate.
struct Motion3 {
  Vec3 value{0.0}, rate{0.0};
};

class Interpolation {
 public:
  Interpolation() = default;

  /// Points at increasing times. With rates the polynomial takes on both (Hermite). A polynomial goes through `points`
  /// of them, as many on either side except near the ends, or through all if there are fewer.
  Interpolation(std::vector<double> times, std::vector<Vec3> values, std::vector<Vec3> rates, std::size_t points);

  /// Within the first and last time, and beyond them at the caller's risk. At a point the value is the point's own.
  Motion3 at(double time) const;

  const std::vector<double>& times() const { return times_; }
  const std::vector<Vec3>& values() const { return values_; }

 private:
  std::size_t order() const { return rates_.empty() ? points_ : 2 * points_; }
  std::size_t node(std::size_t first, std::size_t k) const { return first + (rates_.empty() ? k : k / 2); }
  void prepare(std::size_t first);

  std::vector<double> times_;
  std::vector<Vec3> values_, rates_;
  std::size_t points_ = 0;
  std::vector<Vec3> coefficients_;  ///< divided differences, order() for each first point of a window
};

}  // namespace clray::ephemeris
