// SPDX-License-Identifier: Apache-2.0
// The readers of mesh files, one a format: each walks over its file once, in double, and refuses with file:line what
// cannot be taken as it stands: counts that the file is too small for, numbers that are not finite, indices out of
// range, a cut-off end. What is not used (normals, colours, texture coordinates) is passed over.
#pragma once

#include <string>

#include "scene/mesh/mesh_soup.hpp"

namespace clray {

/// Wavefront OBJ, and the MTL libraries that it names inside its own folder.
PolygonSoup read_obj(const std::string& path, const std::string& content);

/// PLY: text, little and big endian.
PolygonSoup read_ply(const std::string& path, const std::string& content);

/// STL: text and binary. Corners of equal coordinates become one vertex.
PolygonSoup read_stl(const std::string& path, const std::string& content);

/// OFF in text.
PolygonSoup read_off(const std::string& path, const std::string& content);

}  // namespace clray
