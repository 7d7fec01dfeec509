// SPDX-License-Identifier: Apache-2.0
// OBJ reader: vertices, polygons (v, v/vt, v//vn, v/vt/vn, negative indices), usemtl and mtllib. Normals, texture
// coordinates, groups and smoothing change no reflection here: their indices are checked and they are left out.
// Source: Wavefront, Advanced Visualizer manual, appendix B1 (OBJ 3.0). Coordinates in the file's unit.
#include "scene/obj_reader.hpp"

#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <unordered_map>

#include "scene/mesh_text.hpp"
#include "scene/mtl_reader.hpp"

namespace clray {

namespace fs = std::filesystem;

namespace {

enum Field { kVertex, kTexture, kNormal };
constexpr std::array<const char*, 3> kFieldName = {"vertex", "texture coordinate", "normal"};

// Statements that say nothing about how light is reflected.
bool is_ignored(std::string_view key) {
  for (const char* known : {"g", "o", "s", "mg", "vp", "bevel", "c_interp", "d_interp", "lod", "usemap", "maplib",
                            "shadow_obj", "trace_obj"}) {
    if (key == known) return true;
  }
  return false;
}

bool is_identifier(std::string_view key) {
  for (char c : key) {
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_')) return false;
  }
  return !key.empty() && key.size() <= 32 && !(key[0] >= '0' && key[0] <= '9');
}

class ObjReader {
 public:
  ObjReader(const std::string& path, const std::string& content) : path_(path), text_(content, path) {}

  PolygonSoup read() {
    while (text_.next_filled_line()) {
      statement(text_.word());
      while (text_.more_on_line()) text_.word();  // what is left out may go on over continued lines
      text_.next_line();
    }
    finish();
    return std::move(soup_);
  }

 private:
  struct Pending {
    std::uint64_t line, index;
    Field field;
  };

  void statement(std::string_view key) {
    if (key == "v") {
      vertex();
    } else if (key == "f" || key == "fo") {
      face();
    } else if (key == "vt") {
      ++count_[kTexture];
    } else if (key == "vn") {
      ++count_[kNormal];
    } else if (key == "usemtl") {
      use_material(std::string(text_.rest()));
    } else if (key == "mtllib") {
      material_libraries(text_.rest());
    } else if (!is_ignored(key)) {
      if (!is_identifier(key)) text_.fail(quote_word(key) + " is no OBJ statement; v, f, usemtl, … was expected");
      if (left_out_.size() < 32 || left_out_.count(std::string(key))) {
        auto& entry = left_out_[std::string(key)];
        if (entry.second++ == 0) entry.first = text_.line();
      }
    }
  }

  void vertex() {
    Vec3 v;
    v.x = text_.number("x of a vertex");
    v.y = text_.number("y of a vertex");
    v.z = text_.number("z of a vertex");
    // w, or the r g b that scanners append, or both.
    for (int extra = 0; text_.more_on_line(); ++extra) {
      if (extra == 4) text_.fail("a vertex with more than seven values; x y z [w] [r g b] was expected");
      text_.number("w or a colour of a vertex");
    }
    if (soup_.vertices.size() == kMaxVertices) text_.fail("more than 2^31 vertices; fewer were expected");
    soup_.vertices.push_back(v);
    ++count_[kVertex];
  }

  // One index of a corner: made absolute from 0. A number not yet reached is kept for the end of the file.
  std::uint64_t index(std::string_view part, std::string_view corner, Field field) {
    std::int64_t value = 0;
    const char* p = part.data();
    const char* end = p + part.size();
    if (part.size() > 1 && *p == '+' && p[1] != '-') ++p;
    const auto [stop, error] = std::from_chars(p, end, value);
    if (stop != end || error == std::errc::invalid_argument) {
      text_.fail(quote_word(corner) + " is no corner of a face; v, v/vt, v//vn or v/vt/vn with integers was expected");
    }
    const std::string expected = ", 1 to the number in the file or -1 to minus those so far was expected";
    if (error != std::errc())
      text_.fail(std::string(kFieldName[field]) + " index " + quote_word(part) + " is beyond all" + expected);
    if (value == 0) text_.fail(std::string(kFieldName[field]) + " index 0" + expected);
    const std::uint64_t count = count_[field];
    if (value < 0) {
      const std::uint64_t back = 0 - static_cast<std::uint64_t>(value);
      if (back > count) {
        text_.fail(std::string(kFieldName[field]) + " index " + quote_word(part) + " goes back beyond the first of " +
                   std::to_string(count) + expected);
      }
      return count - back;
    }
    const std::uint64_t absolute = static_cast<std::uint64_t>(value) - 1;
    if (absolute >= count) pending_.push_back({text_.line(), absolute, field});
    return absolute;
  }

  void corner(std::string_view word) {
    std::array<std::string_view, 3> parts;
    std::size_t start = 0, field = 0;
    for (;; ++field) {
      if (field == 3) text_.fail(quote_word(word) + " is no corner of a face; at most two '/' were expected");
      const std::size_t slash = word.find('/', start);
      parts[field] = word.substr(start, slash == word.npos ? word.npos : slash - start);
      if (slash == word.npos) break;
      start = slash + 1;
    }
    // Only the texture coordinate of v//vn may be empty.
    if (parts[0].empty() || (field > 0 && parts[field].empty())) {
      text_.fail(quote_word(word) + " is no corner of a face; v, v/vt, v//vn or v/vt/vn was expected");
    }
    const std::uint64_t vertex = index(parts[0], word, kVertex);
    if (field >= 1 && !parts[1].empty()) index(parts[1], word, kTexture);
    if (field == 2) index(parts[2], word, kNormal);
    // An index that wraps in 32 bits is pending and refused at the end, so the cut does no harm.
    soup_.corners.push_back(static_cast<std::uint32_t>(vertex));
  }

  void face() {
    const std::size_t first = soup_.corners.size();
    while (text_.more_on_line()) corner(text_.word());
    const std::size_t count = soup_.corners.size() - first;
    if (count < 3) text_.fail("a face with " + std::to_string(count) + " corners; at least three were expected");
    if (soup_.corners.size() > kMaxCorners) text_.fail("more than 2^32 face corners; fewer were expected");
    if (current_slot_ < 0) current_slot_ = slot("", 0);
    soup_.first.push_back(static_cast<std::uint32_t>(first));
    soup_.face_slot.push_back(static_cast<std::uint32_t>(current_slot_));
    slot_used_[static_cast<std::size_t>(current_slot_)] = true;
  }

  int slot(const std::string& name, std::uint64_t line) {
    const auto [it, inserted] = slot_of_.emplace(name, static_cast<int>(soup_.slots.size()));
    if (inserted) {
      soup_.slots.push_back(name);
      slot_line_.push_back(line);
      slot_used_.push_back(false);
    }
    return it->second;
  }

  void use_material(const std::string& name) {
    if (name.empty()) text_.fail("usemtl without a name; the name of a material was expected");
    current_slot_ = slot(name, text_.line());
  }

  void material_libraries(std::string_view names) {
    if (names.empty()) text_.fail("mtllib without a name; the name of a file was expected");
    any_mtllib_ = true;
    // A name may hold spaces, and a line may hold several names: the whole line is tried first.
    if (material_library(std::string(names), names.find_first_of(" \t") == names.npos)) return;
    if (names.find_first_of(" \t") == names.npos) return;
    const std::string copy(names);
    TextCursor words(copy, path_);
    while (words.more_on_line()) material_library(std::string(words.word()), true);
  }

  // Inside the folder of the OBJ, after following links: a mesh from elsewhere must not make us open other files.
  bool material_library(std::string name, bool complain) {
    fs::path folder = fs::path(path_).parent_path();
    std::error_code error;
    const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) text_.fail("the folder of the OBJ file cannot be resolved: " + error.message());
    fs::path file = fs::weakly_canonical(root / name, error);
    if (!error && !fs::exists(file, error) && name.find('\\') != name.npos) {
      for (char& c : name) c = c == '\\' ? '/' : c;
      file = fs::weakly_canonical(root / name, error);
    }
    if (error) text_.fail("mtllib " + quote_word(name) + " cannot be resolved: " + error.message());
    const fs::path inside = file.lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") {
      text_.fail("mtllib " + quote_word(name) + " leaves the folder of the OBJ file; a file inside it was expected");
    }
    if (!fs::exists(file, error)) {
      if (complain) {
        soup_.warnings.push_back(path_ + ":" + std::to_string(text_.line()) + ": material library " + quote_word(name) +
                                 " is missing");
      }
      return false;
    }
    for (Material& material : read_mtl((folder / inside).string(), soup_.warnings)) add_material(std::move(material));
    return true;
  }

  void add_material(Material material) {
    any_mtl_ = true;
    for (Material& known : soup_.file_materials) {
      if (known.name != material.name) continue;
      soup_.warnings.push_back(path_ + ":" + std::to_string(text_.line()) + ": material " + quote_word(material.name) +
                               " comes again in a later library, which is used");
      known = std::move(material);
      return;
    }
    soup_.file_materials.push_back(std::move(material));
  }

  void finish() {
    for (const Pending& pending : pending_) {
      if (pending.index < count_[pending.field]) continue;
      fail_input(path_, pending.line,
                 std::string(kFieldName[pending.field]) + " index " + std::to_string(pending.index + 1) +
                     " is beyond the last; 1 to " + std::to_string(count_[pending.field]) + " was expected");
    }
    for (const auto& [key, entry] : left_out_) {
      soup_.warnings.push_back(path_ + ":" + std::to_string(entry.first) + ": statement " + quote_word(key) +
                               " is left out (" + std::to_string(entry.second) + " in all)");
    }
    if (soup_.first.empty()) text_.fail("no faces; at least one face (f) was expected");
    drop_unused_slots();
    warn_of_unknown_materials();
  }

  void drop_unused_slots() {
    std::vector<std::uint32_t> place(soup_.slots.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < soup_.slots.size(); ++i) {
      if (!slot_used_[i]) continue;
      place[i] = static_cast<std::uint32_t>(kept);
      soup_.slots[kept] = soup_.slots[i];
      slot_line_[kept++] = slot_line_[i];
    }
    if (kept == soup_.slots.size()) return;
    soup_.slots.resize(kept);
    slot_line_.resize(kept);
    for (std::uint32_t& s : soup_.face_slot) s = place[s];
  }

  void warn_of_unknown_materials() {
    // Where no library could be read at all, its own warning says so once.
    if (!any_mtl_ && any_mtllib_) return;
    for (std::size_t i = 0; i < soup_.slots.size(); ++i) {
      bool known = soup_.slots[i].empty();
      for (const Material& material : soup_.file_materials) known = known || material.name == soup_.slots[i];
      if (!known) {
        soup_.warnings.push_back(path_ + ":" + std::to_string(slot_line_[i]) + ": usemtl " +
                                 quote_word(soup_.slots[i]) + " is in no material library");
      }
    }
  }

  const std::string& path_;
  TextCursor text_;
  PolygonSoup soup_;
  std::array<std::uint64_t, 3> count_{};
  std::vector<Pending> pending_;
  std::unordered_map<std::string, int> slot_of_;
  std::vector<std::uint64_t> slot_line_;
  std::vector<bool> slot_used_;
  int current_slot_ = -1;
  bool any_mtl_ = false, any_mtllib_ = false;
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> left_out_;  // keyword: first line, count
};

}  // namespace

PolygonSoup read_obj(const std::string& path) {
  const std::string content = read_mesh_file(path);
  const std::size_t zero = content.find('\0');
  if (zero != content.npos) {
    std::uint64_t line = 1;
    for (std::size_t i = 0; i < zero; ++i) line += content[i] == '\n' || (content[i] == '\r' && content[i + 1] != '\n');
    fail_input(path, line, "binary data; a text OBJ file was expected");
  }
  return ObjReader(path, content).read();
}

}  // namespace clray
