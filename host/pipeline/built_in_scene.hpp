// SPDX-License-Identifier: Apache-2.0
// A small scene for a program: a few of each shape and surface that it holds, close together, seen by as many observers
// in as many bands, by the same detectors. The self-test traces it (traced_self_test.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/plan.hpp"

namespace clray {

/// What a program holds, and its sizes.
struct ProgramContent {
  std::vector<std::string> models, shapes, detectors;  ///< scene-file names of rows
  std::uint32_t lanes = 1, connections = 1, components = 1;
  bool pixels = false, mirrors = false, scatter = false, sobol = true, strata = true;
  bool hinged = false, one_sided = false, shared_planes = false, pieces = false;
  bool curved = false, specialised = true;
  std::string walk = "plain";  ///< scene-file name
};

/// The content of a plan's program.
ProgramContent content_of(const PassPlan& plan, bool specialised);

/// A scene with this content, ready to trace. Components beyond those in `content` are counted as the first ones.
struct BuiltInScene {
  Geometry geometry;
  PassPlan plan;
};
BuiltInScene built_in_scene(const ProgramContent& content);

}  // namespace clray
