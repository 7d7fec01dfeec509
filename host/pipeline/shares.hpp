// SPDX-License-Identifier: Apache-2.0
// What a share of a pass is: a range of the points of every view or, where points are found anew or visibility is
// solved, a range of views. The ranges of all shares follow each other without a gap.
#pragma once

#include "clray/saved.hpp"
#include "pipeline/saved_sums.hpp"

namespace clray {

/// The views of a share, as a step from the first one to that behind the last.
OpenStep views_of_share(const PassPlan& plan, const Share& share);

/// A share of a pass of rays or tiles that has so many points.
OpenStep share_of(const PassPlan& plan, const Share& share, std::uint64_t points);

}  // namespace clray
