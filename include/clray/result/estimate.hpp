// SPDX-License-Identifier: Apache-2.0
// Numbers of a result with their errors, and which member of a run a record belongs to.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "clray/export.hpp"
#include "clray/scene.hpp"

CLRAY_API_BEGIN
namespace clray {

/// A number with its error, from the spread of the replicates.
struct Estimate {
  double value = 0.0;           ///< in the unit of its name
  double standard_error = 0.0;  ///< same unit; 0 where the value is exact
  double low = 0.0;             ///< lower end of the 95 % Student-t interval
  double high = 0.0;            ///< its upper end
  /// How well the squared standard error is known: 0.10 on average for 16 normal replicates, at most 0.82, when one
  /// replicate differs from all others. NaN without any spread.
  double relative_variance_of_variance = 0.0;
  /// Of an exact number, or of its exact part (docs/exact.md): a bound of the rounding error, in its unit. NaN for an
  /// estimate from rays alone.
  double rounding_bound = std::numeric_limits<double>::quiet_NaN();
  /// Of a number whose first bounce alone is solved: that part of the value, which has no standard error. Else NaN.
  double exact_part = std::numeric_limits<double>::quiet_NaN();
  bool tiles = false;  ///< points lay in tiles (docs/exact.md), not on rays

  /// Whether it is solved, all of it.
  bool exact() const { return rounding_bound >= 0.0 && std::isnan(exact_part); }
  /// Whether its first bounce alone is solved.
  bool partly_exact() const { return !std::isnan(exact_part); }
};

/// A vector with a standard error per component.
struct VectorEstimate {
  Vec3 value{0.0};                                                   ///< in the unit of its name
  Vec3 standard_error{0.0};                                          ///< of each component
  Vec3 relative_variance_of_variance{0.0};                           ///< as in Estimate
  double rounding_bound = std::numeric_limits<double>::quiet_NaN();  ///< of each component, as in Estimate
  Vec3 exact_part{std::numeric_limits<double>::quiet_NaN()};         ///< as in Estimate

  /// Whether its first bounce alone is solved.
  bool partly_exact() const { return !std::isnan(exact_part.x); }
};

/// Which member of a run a record belongs to; empty names where there is only one.
struct ResultKey {
  std::string detector;         ///< its shown_name()
  std::string observer;         ///< name
  std::string variant;          ///< name
  std::string band;             ///< name
  std::size_t orientation = 0;  ///< index into Result::orientations
};

}  // namespace clray
CLRAY_API_END
