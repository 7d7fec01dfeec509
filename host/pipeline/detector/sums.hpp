// SPDX-License-Identifier: Apache-2.0
// What a detector has that no room says more of: every number of its sums with a unit is a result and a target.
#pragma once

#include "pipeline/detector/room.hpp"

namespace clray {

/// The default of DetectorRoom::results.
void sums_results(const RoomResults& x);

/// The default of DetectorRoom::targets.
void sums_targets(const TargetContext& x, std::vector<Target>* targets);

}  // namespace clray
