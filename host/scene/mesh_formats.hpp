// SPDX-License-Identifier: Apache-2.0
// PLY, STL and OFF files, read by OpenMesh's readers after a check of our own that they are what they claim.
#pragma once

#include <string>
#include <vector>

#include "scene/mesh_soup.hpp"

namespace clray {

/// Reads `path` as "ply", "stl" or "off". Throws Error(input).
PolygonSoup read_with_openmesh(const std::string& path, const std::string& format);

/// What a file says of itself, found by walking over all of it once.
struct FormatClaim {
  std::uint64_t vertices = 0;  ///< 0 for STL, which has only faces
  std::uint64_t faces = 0;
  bool binary = false;
  std::vector<Vec3> points;  ///< PLY and OFF: the vertices in double, where OpenMesh reads float
  /// PLY, OFF and text STL: the same mesh written plainly, which is what OpenMesh gets to read: its readers lose
  /// their place at comments, colours, properties before the corners and numbers of another type than they want,
  /// and its text STL reader takes the decimal sign from the global locale. Text STL becomes binary, in float.
  std::string plain;
};

/// Walks over the content and throws Error(input) at the first thing that OpenMesh would accept silently: counts
/// that the file is too small for, numbers that are not finite, indices out of range, faces under three corners,
/// a cut-off end.
FormatClaim check_ply(const std::string& content, const std::string& path);
FormatClaim check_stl(const std::string& content, const std::string& path);
FormatClaim check_off(const std::string& content, const std::string& path);

}  // namespace clray
