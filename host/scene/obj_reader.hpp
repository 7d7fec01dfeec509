// SPDX-License-Identifier: Apache-2.0
// Strict Wavefront OBJ reader, in double, with file:line in every complaint. Fills a PolygonSoup.
#pragma once

#include <string>

#include "scene/mesh_soup.hpp"

namespace clray {

/// Reads an OBJ file and the MTL libraries that it names inside its own folder. Throws Error(input).
PolygonSoup read_obj(const std::string& path);

}  // namespace clray
