// SPDX-License-Identifier: Apache-2.0
// Words that the rooms share: names of records and numbers with errors and units, as a person reads them.
#pragma once

#include <string>

#include "clray/result.hpp"
#include "text/columns.hpp"

namespace clray::io {

/// A table of more rows would not fit a screen; the files have all of them.
constexpr std::size_t kMostRows = 12;

/// "  … and 3 more in the files" where there are more rows than kMostRows, else nothing.
std::string more_rows(std::size_t count);

/// "delay, observer, variant, band, #2".
std::string record_name(const ResultKey& key, const Result& result);

/// "1.23 ± 0.04", of a scaled estimate; an exact one has the digits that its rounding leaves.
std::string scaled(const Estimate& e, double scale);
/// The same of a component (0 … 2) of a vector.
std::string scaled(const VectorEstimate& v, int axis, double scale);

/// The same with a unit.
std::string amount(const Estimate& e, double scale, const std::string& unit);

/// "1.23 ± 0.04 m²   (95 %: ±7 %)".
std::string amount_with_interval(const Estimate& e, const std::string& unit);

}  // namespace clray::io
