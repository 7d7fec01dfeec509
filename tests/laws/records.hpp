// SPDX-License-Identifier: Apache-2.0
// A Result as a flat map from names to numbers with errors: "detector/observer/variant/band/orientation/quantity". The
// one place that knows the result types; a new one is added to records.cpp alone. SI units.
#pragma once

#include <map>
#include <string>

#include "clray/result.hpp"

namespace clray_test {

/// One number of a result.
struct Record {
  double value = 0.0;
  double error = 0.0;    ///< standard error
  double scale = 1.0;    ///< what the number could be in this scene: rounding of integer sums is relative to it
  double doubt = 0.0;    ///< relative variance of the claimed variance over that of normal replicates; 0 where unknown
  bool resolved = true;  ///< false: the program itself says that the error is not to be trusted
  /// Of quantity: "total", "moment" (of delay), "bin", "force", "torque", "book", "balance", "picture", "power",
  /// "cover", "window", "exact" (no sampling in these two).
  std::string kind;
  double low = 0.0, high = 0.0;  ///< of a bin: its ends; only bins of the same ends can be compared
};

using Records = std::map<std::string, Record>;

/// Names that a run of one member leaves out of its keys, and with which it is found in a run of many.
struct Names {
  std::string observer, variant, band, orientation;  ///< empty: as the scene has it
};

/// All numbers of a result of `scene`. Names that the result leaves empty, where there is only one observer or band,
/// are filled in from the scene, or from `names` where these are given.
Records records_of(const clray::Result& result, const clray::Scene& scene, const Names& names = {});

/// The name of an orientation in records: its time, or the Sun's direction for one of a grid.
std::string orientation_name(const clray::Result& result, std::size_t orientation, bool grid);

/// Whether this detector's orientations are a grid of its own.
bool is_grid(const clray::DetectorSpec& detector);

/// A warning without its numbers and the names of records in it, so that two runs' can be compared.
std::string warning_kind(const std::string& warning);

}  // namespace clray_test
