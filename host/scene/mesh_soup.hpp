// SPDX-License-Identifier: Apache-2.0
// Polygons as a mesh file gives them, before triangulation: what every reader fills and mesh_load.cpp turns
// into a Mesh. Coordinates in the file's own unit until the loader scales them; indices count from 0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clray/error.hpp"
#include "clray/scene.hpp"

namespace clray {

/// Polygons over shared vertices, in file order.
struct PolygonSoup {
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners;    ///< vertex indices of all faces, one face after the other
  std::vector<std::uint32_t> first;      ///< index into `corners` of each face's first corner
  std::vector<std::uint32_t> face_slot;  ///< index into `slots`; empty: all faces in slot 0
  std::vector<std::string> slots;
  std::vector<Material> file_materials;
  std::vector<std::string> warnings;
  std::uint64_t collapsed = 0;  ///< faces that the reader dropped because corners coincide: no area

  std::size_t faces() const { return first.size(); }
  std::size_t face_end(std::size_t face) const { return face + 1 < first.size() ? first[face + 1] : corners.size(); }
};

/// Vertices and corners are counted in 31 and 32 bits (edge keys hold two vertices and a direction).
constexpr std::uint64_t kMaxVertices = (1ull << 31) - 1;
constexpr std::uint64_t kMaxCorners = (1ull << 32) - 1;

/// An Error(input) about `path`, at a line unless that is 0.
[[noreturn]] inline void fail_input(const std::string& path, std::uint64_t line, const std::string& message) {
  throw Error(ErrorCode::input, message, line ? path + ":" + std::to_string(line) : path);
}

/// The whole of a regular file. Throws Error(input) if it is missing, a directory, unreadable or empty.
std::string read_mesh_file(const std::string& path);

}  // namespace clray
