// SPDX-License-Identifier: Apache-2.0
// See words.hpp.
#include "io/detector/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/write.hpp"
#include "text/text.hpp"

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

/// An exact number with the digits that its rounding leaves.
static std::string exact_number(double value, double bound) {
  const double ratio = std::fabs(value) / bound;
  if (!(ratio > 1.0)) return "0";
  return text::rounded(value, std::max(1, static_cast<int>(std::floor(std::log10(std::min(ratio, 1e15))))));
}

std::string scaled(const Estimate& e, double scale) {
  if (e.exact()) return exact_number(e.value * scale, e.rounding_bound * scale);
  return format_with_error(e.value * scale, e.standard_error * scale);
}

std::string scaled(const VectorEstimate& v, int axis, double scale) {
  Estimate e;
  e.value = v.value[axis];
  e.standard_error = v.standard_error[axis];
  e.rounding_bound = v.rounding_bound;
  e.exact_part = v.exact_part[axis];
  return scaled(e, scale);
}

std::string amount(const Estimate& e, double scale, const std::string& unit) {
  const std::string number = scaled(e, scale);
  return number == "n/a" ? number : number + " " + unit;
}

std::string amount_with_interval(const Estimate& e, const std::string& unit) {
  const bool has_value = e.value != 0.0 && std::isfinite(e.value);
  const std::string percent =
      has_value ? fmt::format("{:.2g} %", 100.0 * 0.5 * (e.high - e.low) / std::fabs(e.value)) : "n/a";
  if (e.exact()) return fmt::format("{}   (exact, rounding below {:.1g})", amount(e, 1.0, unit), e.rounding_bound);
  return amount(e, 1.0, unit) + "   (95 %: ±" + percent + (e.partly_exact() ? "; first bounce exact)" : ")");
}

}  // namespace clray::io
