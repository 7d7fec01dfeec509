// SPDX-License-Identifier: Apache-2.0
// Polygons as a mesh file gives them, before triangulation: what every reader fills and mesh_load.cpp turns
// into a Mesh. Coordinates in the file's own unit until the loader scales them; indices count from 0.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clray/error.hpp"
#include "clray/scene.hpp"

namespace clray {

/// An Error(input) about `path`, at a line unless that is 0.
[[noreturn]] inline void fail_input(const std::string& path, std::uint64_t line, const std::string& message) {
  throw Error(ErrorCode::input, message, line ? path + ":" + std::to_string(line) : path);
}

/// Counts faults of one kind that are read with a warning, and remembers the first.
struct Tally {
  std::uint64_t count = 0;
  std::uint64_t line = 0;  ///< of the first, 0 where the file has no lines
  std::string first;       ///< what the first was

  void add(std::uint64_t at, std::string_view what = {}) {
    if (count++ > 0) return;
    line = at;
    first = what;
  }
  /// One warning for all of them: "path:line: text (3 in all)".
  void warn(const std::string& path, const std::string& text, std::vector<std::string>& warnings) const {
    if (count == 0) return;
    warnings.push_back(path + (line ? ":" + std::to_string(line) : "") + ": " + text +
                       (count > 1 ? " (" + std::to_string(count) + " in all)" : ""));
  }
};

/// Vertices and corners are counted in 31 and 32 bits (an edge is a vertex and a direction in 32).
constexpr std::uint64_t kMaxVertices = (1ull << 31) - 1;
constexpr std::uint64_t kMaxCorners = (1ull << 32) - 1;

/// Polygons over shared vertices, in file order.
struct PolygonSoup {
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners;    ///< vertex indices of all faces, one face after the other
  std::vector<std::uint32_t> first;      ///< index into `corners` of each face's first corner
  std::vector<std::uint32_t> face_slot;  ///< index into `slots`; empty: all faces in slot 0
  std::vector<std::string> slots;
  std::vector<Material> file_materials;
  std::vector<std::string> warnings;
  std::uint64_t collapsed = 0;  ///< facets of an STL file left out because corners coincide: no area
  Tally short_faces;            ///< faces under three corners, left out

  std::size_t faces() const { return first.size(); }
  std::size_t face_end(std::size_t face) const { return face + 1 < first.size() ? first[face + 1] : corners.size(); }

  /// Makes a face of the corners from `start` on; one under three corners is left out and counted. Returns whether
  /// it is kept. Throws Error(input) where there are too many.
  bool end_face(std::size_t start, const std::string& path, std::uint64_t line) {
    if (corners.size() - start < 3) {
      corners.resize(start);
      short_faces.add(line);
      return false;
    }
    if (corners.size() > kMaxCorners) fail_input(path, line, "more than 2^32 face corners; fewer were expected");
    first.push_back(static_cast<std::uint32_t>(start));
    return true;
  }
};

}  // namespace clray
