// SPDX-License-Identifier: Apache-2.0
// A scene as files that a person can run: scene.toml with the tables and meshes beside it. Degrees and decimal numbers
// round angles by a few ulp, so bits may differ from those of the scene itself; statistics may not.
#pragma once

#include <string>

#include "clray/scene.hpp"

namespace clray_test {

/// Writes the files into `folder` (made if need be) and returns the text of scene.toml.
std::string write_scene(const clray::Scene& scene, const std::string& folder);

}  // namespace clray_test
