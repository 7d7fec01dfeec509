// SPDX-License-Identifier: Apache-2.0
// See words.hpp.
#include "io/detector/words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clray::io {

std::string more_rows(std::size_t count) {
  return count > kMostRows ? fmt::format("  … and {} more in the files\n", count - kMostRows) : "";
}

std::string record_name(const ResultKey& key, const Result& result) {
  std::string name = key.detector;
  for (const auto& part : {key.observer, key.variant, key.band}) {
    if (!part.empty()) name += ", " + part;
  }
  if (result.orientations.size() > 1) name += ", #" + std::to_string(key.orientation);
  return name;
}

std::string scaled(const Estimate& e, double scale) {
  return format_with_error(e.value * scale, e.standard_error * scale);
}

std::string amount(const Estimate& e, double scale, const std::string& unit) {
  const std::string number = scaled(e, scale);
  return number == "n/a" ? number : number + " " + unit;
}

std::string amount_with_interval(const Estimate& e, const std::string& unit) {
  const bool has_value = e.value != 0.0 && std::isfinite(e.value);
  const std::string percent =
      has_value ? fmt::format("{:.2g} %", 100.0 * 0.5 * (e.high - e.low) / std::fabs(e.value)) : "n/a";
  return amount(e, 1.0, unit) + "   (95 %: ±" + percent + ")";
}

}  // namespace clray::io
