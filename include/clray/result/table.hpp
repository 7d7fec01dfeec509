// SPDX-License-Identifier: Apache-2.0
// What detectors find whose sums are results by themselves.
#pragma once

#include <string>
#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// The numbers of a sum that a detector's row states with a unit, each with its error.
struct TableResult {
  ResultKey key;                 ///< which member of the run it is
  std::string name;              ///< of the sum
  std::string unit;              ///< of its values
  std::vector<Estimate> values;  ///< in the order of the detector's row
};

}  // namespace clray
CLRAY_API_END
