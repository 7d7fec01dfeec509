// SPDX-License-Identifier: Apache-2.0
// The geometry of a pass (docs/physics.md, section 10): when the body is where, how it stands, where light comes from
// and who sees it.
#pragma once

#include <string>
#include <vector>

#include "clray/export.hpp"
#include "clray/result.hpp"
#include "clray/scene.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Every instant of the scene's pass, traced or not; empty without a pass. Throws Error(input) for files that cannot be
/// read or do not cover the pass, and where nothing is left to trace.
std::vector<PassInstant> pass_instants(const Scene& scene);

/// What a person should know of a pass: what its geometry leaves out, and by how much.
std::vector<std::string> pass_warnings(const Scene& scene);

/// The pass in words: orbit, span, instants traced and not, elevations and phase angles. Empty without a pass. Throws
/// as pass_instants() does.
std::string describe_pass(const Scene& scene);

}  // namespace clray
CLRAY_API_END
