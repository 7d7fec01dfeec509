// SPDX-License-Identifier: Apache-2.0
// The materials of an OBJ file: its mtllib and usemtl statements become the slots of its faces and the materials of
// its libraries. Nothing outside the OBJ file's folder is ever opened.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/mesh/mesh_soup.hpp"
#include "text/name_index.hpp"

namespace clray {

class ObjMaterials {
 public:
  /// `path` and the text of the statements must outlive this.
  explicit ObjMaterials(const std::string& path) : path_(path) {}

  /// A mtllib statement: one name with spaces, or several.
  void libraries(std::string_view names, std::uint64_t line, std::vector<std::string>& warnings);
  /// A usemtl statement; the next faces are of this slot.
  void use(std::string_view name, std::uint64_t line);
  /// The slot of a face that comes now.
  std::uint32_t face_slot();
  /// Gives the soup its slots (those in use, one a material) and materials, and the warnings about them.
  void finish(PolygonSoup& soup);

 private:
  struct Slot {
    std::string_view name;  // as the file writes it, comment included
    std::uint64_t line = 0;
    bool used = false;
  };

  struct Unknown {
    std::string name;
    std::uint64_t line = 0;
  };

  bool library(const std::string& name, std::uint64_t line, std::vector<std::string>& warnings);
  void add(Material material, std::uint64_t line);
  std::uint32_t slot(std::string_view name, std::uint64_t line);
  void warn_of_unknown(const std::vector<Unknown>& unknown, std::vector<std::string>& warnings) const;

  const std::string& path_;
  std::vector<Slot> slots_;
  text::NameIndex slot_of_;
  int current_ = -1;
  std::vector<Material> materials_;
  text::NameIndex material_of_;
  std::set<std::string> read_;  // canonical paths of the libraries
  Tally again_;
  bool any_library_ = false;
};

}  // namespace clray
