// SPDX-License-Identifier: Apache-2.0
// Newton's form; see interpolation.hpp.
#include "ephemeris/interpolation.hpp"

#include <algorithm>

namespace clray::ephemeris {

Interpolation::Interpolation(std::vector<double> times, std::vector<Vec3> values, std::vector<Vec3> rates,
                             std::size_t points)
    : times_(std::move(times)),
      values_(std::move(values)),
      rates_(std::move(rates)),
      points_(std::min(points, times_.size())) {
  coefficients_.reserve((times_.size() - points_ + 1) * order());
  for (std::size_t first = 0; first + points_ <= times_.size(); ++first) prepare(first);
}

void Interpolation::prepare(std::size_t first) {
  std::vector<Vec3> column;
  for (std::size_t k = 0; k < order(); ++k) column.push_back(values_[node(first, k)]);
  for (std::size_t level = 0; level < order(); ++level) {
    coefficients_.push_back(column.front());
    for (std::size_t k = 0; k + level + 1 < order(); ++k) {
      const std::size_t low = node(first, k), high = node(first, k + level + 1);
      // Between a point and itself the first difference is its rate.
      column[k] = low == high ? rates_[low] : (column[k + 1] - column[k]) / (times_[high] - times_[low]);
    }
    column.pop_back();
  }
}

Motion3 Interpolation::at(double time) const {
  const auto after = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
  const std::size_t half = points_ / 2;
  const std::size_t first = std::min(after > half ? after - half : 0, times_.size() - points_);
  const Vec3* c = &coefficients_[first * order()];
  Motion3 sum{c[order() - 1], Vec3(0.0)};
  for (std::size_t k = order() - 1; k-- > 0;) {
    const double since = time - times_[node(first, k)];
    sum.rate = sum.value + since * sum.rate;
    sum.value = c[k] + since * sum.value;
  }
  if (after > 0 && times_[after - 1] == time) sum.value = values_[after - 1];
  return sum;
}

}  // namespace clray::ephemeris
