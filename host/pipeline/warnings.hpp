// SPDX-License-Identifier: Apache-2.0
// What a run warns of besides its numbers: nothing seen, energy cut off, a target not reached, claims not to be
// trusted.
#pragma once

#include <string>
#include <vector>

#include "clray/result.hpp"
#include "clray/scene.hpp"
#include "pipeline/outcome.hpp"

namespace clray {

/// Appends the scene's warnings and those of a finished result; `ending` says why its tracing stopped, `lit` which of
/// its records found light.
void add_warnings(const Scene& scene, const Ending& ending, const LitRecords& lit, Result* result);

/// What speaks against trusting the claimed errors of a pass: peaks that a surface could send back between the rays
/// (docs/results.md, "Whether a claimed error can be trusted").
std::vector<std::string> doubtful_claims(const PassPlan& plan, const Geometry& geometry, const Sums& sums);

}  // namespace clray
