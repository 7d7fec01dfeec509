// SPDX-License-Identifier: Apache-2.0
// OBJ reader: vertices, polygons (v, v/vt, v//vn, v/vt/vn, negative indices), usemtl and mtllib. Normals, texture
// coordinates, groups and smoothing change no reflection here; their indices are checked, then they are left out.
// Source: Wavefront, Advanced Visualizer manual, appendix B1 (OBJ 3.0). Coordinates in the file's unit.
#include <array>
#include <charconv>
#include <map>

#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_text.hpp"
#include "scene/mesh/obj_materials.hpp"

namespace clray {

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
  ObjReader(const std::string& path, const std::string& content)
      : path_(path), text_(content, path), materials_(path) {}

  PolygonSoup read() {
    while (text_.next_filled_line()) {
      statement(text_.word());
      while (text_.more_on_line()) text_.word();  // a statement that is left out may have continued lines
      text_.next_line();
    }
    finish();
    return std::move(soup_);
  }

 private:
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
      const std::uint64_t line = text_.line();
      materials_.use(text_.rest(), line);
    } else if (key == "mtllib") {
      const std::uint64_t line = text_.line();
      materials_.libraries(text_.rest(), line, soup_.warnings);
    } else if (!is_ignored(key)) {
      if (!is_identifier(key)) text_.fail(quote_word(key) + " is no OBJ statement; v, f, usemtl, … was expected");
      const std::string name(key);
      if (left_out_.size() < 32 || left_out_.count(name)) left_out_[name].add(text_.line());
    }
  }

  void vertex() {
    Vec3 v;
    v.x = text_.number("x of a vertex");
    v.y = text_.number("y of a vertex");
    v.z = text_.number("z of a vertex");
    // Then w, or the r g b that scanners write, or both.
    for (int extra = 0; text_.more_on_line(); ++extra) {
      if (extra == 4) text_.fail("a vertex with more than seven values; x y z [w] [r g b] was expected");
      double unused = 0.0;
      const std::string_view word = text_.word();
      const std::string trouble = parse_number(word, unused);
      if (trouble.find("no number") != std::string::npos)
        text_.fail(trouble + "; w or a colour of a vertex (a finite number) was expected");
      if (!trouble.empty()) colours_.add(text_.line(), word);
    }
    if (soup_.vertices.size() == kMaxVertices) text_.fail("more than 2^31 vertices; fewer were expected");
    soup_.vertices.push_back(v);
    ++count_[kVertex];
  }

  // The number in one part of a corner. A number beyond 64 bits becomes the largest or the smallest of 64 bits.
  std::int64_t part_number(std::string_view part, std::string_view corner) {
    std::int64_t value = 0;
    const char* p = part.data();
    const char* end = p + part.size();
    if (part.size() > 1 && *p == '+' && p[1] != '-') ++p;
    const auto [stop, error] = std::from_chars(p, end, value);
    if (stop != end || error == std::errc::invalid_argument) {
      text_.fail(quote_word(corner) + " is no corner of a face; v, v/vt, v//vn or v/vt/vn with integers was expected");
    }
    if (error != std::errc()) return *p == '-' ? INT64_MIN : INT64_MAX;
    return value;
  }

  // Turns a vertex index into an absolute one from 0. An index ahead of the file's place is checked at its end.
  std::uint64_t vertex_index(std::string_view part, std::string_view corner) {
    const std::int64_t value = part_number(part, corner);
    const std::uint64_t count = count_[kVertex];
    const char* expected = "; an index from 1 to the number in the file, or from -1 to minus that so far, was expected";
    if (value == INT64_MAX) text_.fail("vertex index " + quote_word(part) + " is beyond all" + expected);
    if (value == 0) text_.fail(std::string("vertex index 0") + expected);
    if (value < 0) {
      const std::uint64_t back = 0 - static_cast<std::uint64_t>(value);
      if (back > count) {
        text_.fail("vertex index " + quote_word(part) + " goes back beyond the first of " + std::to_string(count) +
                   expected);
      }
      return count - back;
    }
    const std::uint64_t absolute = static_cast<std::uint64_t>(value) - 1;
    if (absolute >= count) pending_.push_back({text_.line(), absolute});
    return absolute;
  }

  // Texture coordinates and normals are not used, so an index without a target is only worth a warning.
  void unused_index(std::string_view part, std::string_view corner, Field field) {
    if (part.empty()) return;
    const std::int64_t value = part_number(part, corner);
    const auto count = static_cast<std::int64_t>(count_[field]);
    if (value > greatest_[field].index) greatest_[field] = {text_.line(), value};
    if (value == 0 || value < -count) nowhere_[field].add(text_.line(), part);
  }

  void corner(std::string_view word) {
    std::array<std::string_view, 3> parts;
    std::size_t start = 0;
    for (std::size_t field = 0;; ++field) {
      if (field == 3) text_.fail(quote_word(word) + " is no corner of a face; at most two '/' were expected");
      const std::size_t slash = word.find('/', start);
      parts[field] = word.substr(start, slash == std::string_view::npos ? std::string_view::npos : slash - start);
      if (slash == std::string_view::npos) break;
      start = slash + 1;
    }
    if (parts[0].empty())
      text_.fail(quote_word(word) + " is no corner of a face; v, v/vt, v//vn or v/vt/vn was expected");
    const std::uint64_t vertex = vertex_index(parts[0], word);
    unused_index(parts[1], word, kTexture);
    unused_index(parts[2], word, kNormal);
    // An index that wraps in 32 bits is pending and refused at the end, so the cut does no harm.
    soup_.corners.push_back(static_cast<std::uint32_t>(vertex));
  }

  void face() {
    const std::size_t start = soup_.corners.size();
    const std::uint64_t line = text_.line();
    while (text_.more_on_line()) corner(text_.word());
    if (soup_.end_face(start, path_, line)) soup_.face_slot.push_back(materials_.face_slot());
  }

  void finish() {
    for (const Pending& pending : pending_) {
      if (pending.index < soup_.vertices.size()) continue;
      fail_input(path_, pending.line,
                 "vertex index " + std::to_string(pending.index + 1) + " is beyond the last; 1 to " +
                     std::to_string(soup_.vertices.size()) + " was expected");
    }
    for (const Field field : {kTexture, kNormal}) warn_of_unused(field);
    colours_.warn(path_, quote_word(colours_.first) + " as w or a colour of a vertex is not finite; it is not used",
                  soup_.warnings);
    for (const auto& [key, tally] : left_out_)
      tally.warn(path_, "statement " + quote_word(key) + " is left out", soup_.warnings);
    if (soup_.first.empty()) text_.fail("no faces; at least one face (f) of three corners was expected");
    materials_.finish(soup_);
  }

  void warn_of_unused(Field field) {
    Tally tally = nowhere_[field];
    const std::int64_t greatest = greatest_[field].index;
    if (greatest > static_cast<std::int64_t>(count_[field])) tally.add(greatest_[field].line, std::to_string(greatest));
    if (tally.count == 0) return;
    tally.count = 1;  // of the indices beyond the end only the greatest is known
    tally.warn(path_,
               std::string(kFieldName[field]) + " index " + quote_word(tally.first) +
                   " leads nowhere, the file holds " + std::to_string(count_[field]) + "; they are not used",
               soup_.warnings);
  }

  struct Pending {
    std::uint64_t line, index;
  };
  struct Greatest {
    std::uint64_t line = 0;
    std::int64_t index = 0;
  };

  const std::string& path_;
  TextCursor text_;
  ObjMaterials materials_;
  PolygonSoup soup_;
  std::array<std::uint64_t, 3> count_{};
  std::vector<Pending> pending_;
  std::array<Greatest, 3> greatest_{};
  std::array<Tally, 3> nowhere_;
  Tally colours_;
  std::map<std::string, Tally> left_out_;  // by keyword
};

}  // namespace

PolygonSoup read_obj(const std::string& path, const std::string& content) {
  if (content.compare(0, 2, "\xfe\xff") == 0 || content.compare(0, 2, "\xff\xfe") == 0)
    fail_input(path, 1, "text in UTF-16; save it as UTF-8, which was expected");
  const std::size_t zero = content.find('\0');
  if (zero != std::string::npos) {
    std::uint64_t line = 1;
    for (std::size_t i = 0; i < zero; ++i) line += content[i] == '\n' || (content[i] == '\r' && content[i + 1] != '\n');
    fail_input(path, line, "binary data; a text OBJ file was expected");
  }
  return ObjReader(path, content).read();
}

}  // namespace clray
