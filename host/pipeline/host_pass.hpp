// SPDX-License-Identifier: Apache-2.0
// The kernels of a pass, compiled as C++ for any plan. They run in order, slowly, with a walk that looks at no box. A
// device's sums are compared with theirs (traced_self_test.hpp).
#pragma once

#include <cstdint>

#include "pipeline/plan.hpp"

namespace clray {

/// The sums of points [0, points) of every view, replicate and pixel of the plan's first epoch, in work-items of at
/// most `chunk` points. Same bits as a device's. Throws Error(bug) where host_has_room() says no.
Sums trace_on_host(const PassPlan& plan, const Geometry& geometry, std::uint32_t points, std::uint32_t chunk);

/// Whether the pass has no more lanes, and no more sums that work-items keep, than the host's kernels have room for.
bool host_has_room(const PassPlan& plan);

/// Work-items of a block of that many points of that many views.
std::uint64_t items_of(const PassPlan& plan, std::size_t views, std::uint32_t points, std::uint32_t chunk);

}  // namespace clray
