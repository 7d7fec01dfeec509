// SPDX-License-Identifier: Apache-2.0
// The instants of a scene's pass: when they are, and what of them is traced (clray/pass.hpp). And the ranges of its
// station between them.
#pragma once

#include "clray/pass.hpp"
#include "ephemeris/range.hpp"

namespace clray::pass {

/// Views of the instants that are traced, in order.
std::vector<Orientation> views(const Scene& scene);

/// Ranges of the scene's station: along the orbit of its pass, or by its own keys. Throws Error(input).
ephemeris::RangeModel range_model(const Scene& scene);

}  // namespace clray::pass
