// SPDX-License-Identifier: Apache-2.0
// See draw.hpp. A key's range is all that is known of it: no name of a model, shape or detector occurs here.
#include "laws/draw.hpp"

#include <algorithm>
#include <cmath>

namespace clray_test {

clray::Vec3 Draw::direction() {
  const double z = between(-1.0, 1.0), phi = between(0.0, 6.283185307179586), r = std::sqrt(1.0 - z * z);
  const double x = r * std::cos(phi), y = r * std::sin(phi), l = std::sqrt(x * x + y * y + z * z);
  return {x / l, y / l, z / l};
}

double Draw::key(const clray::TableKey& key) {
  constexpr double kMostWhole = 12.0;  // bins, pixels, steps of a grid: what a small run can carry
  constexpr double kWide = 10.0;       // a finite range longer than this is drawn by its logarithm
  constexpr double kMostWide = 300.0;  // exponents: a few thousand rays still meet such a peak
  constexpr double kEnd = 0.15;        // probability of an end of the range
  const double low = key.low, high = key.high;
  double value = 0.0;
  if (key.is_switch) {
    value = chance(0.5) ? 1.0 : 0.0;
  } else if (key.is_whole) {
    value = whole(static_cast<int>(low), static_cast<int>(std::min(high, low + kMostWhole)));
  } else if (!std::isfinite(high)) {
    // A size: about 1 where it must not vanish, else nothing or a small part of that.
    const bool may_vanish = std::isfinite(low) && key.low_included;
    value = !std::isfinite(low) ? between(-10.0, 10.0)
            : may_vanish        ? (chance(0.5) ? low : low + between(0.05, 0.25))
                                : low + between(0.3, 1.2);
  } else if (chance(kEnd) && key.low_included && low <= 0.0) {
    value = low;
  } else if (chance(kEnd) && key.high_included && high - low <= kWide) {
    value = high;
  } else if (high - low > kWide) {
    value = std::pow(10.0, between(0.0, std::log10(std::min(high, kMostWide))));
  } else {
    // Off an end that is not 0, which stands for a limit (a mirror's smoothness) that few rays cannot sample.
    const double margin = 0.05 * (high - low);
    value = between(low == 0.0 ? low : low + margin, key.high_included ? high : high - margin);
  }
  return clray::key_accepts(key, value) ? value : key.default_value;
}

}  // namespace clray_test
