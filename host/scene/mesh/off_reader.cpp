// SPDX-License-Identifier: Apache-2.0
// OFF reader: vertices and polygons of an object file in text. Colours, normals and texture coordinates after the
// numbers of a line are passed over. Source of the format: Geomview manual, "OFF Files".
#include <array>

#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_text.hpp"

namespace clray {

namespace {

constexpr std::array<const char*, 3> kAxes = {"x of a vertex", "y of a vertex", "z of a vertex"};

// [ST][C][N]OFF, in any case. What the letters before OFF announce stands behind the coordinates of a vertex. The first
// count may follow without a blank, as in "OFF4 1 0".
void read_magic(TextCursor& text) {
  if (!text.next_filled_line()) text.fail("no data; an OFF file was expected");
  const std::string_view word = text.word();
  std::string magic;
  for (const char c : word) {
    if (c >= '0' && c <= '9') break;
    magic += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  const std::size_t name = magic.size() < 3 ? std::string::npos : magic.size() - 3;
  if (name == std::string::npos || magic.compare(name, 3, "OFF") != 0 || magic.find_first_not_of("STCN") != name)
    text.fail(quote_word(word) + "; OFF in three dimensions was expected");
  text.back(word.size() - magic.size());
  if (!text.more_on_line()) {
    text.next_line();
    if (!text.next_filled_line()) text.fail("the file ends where the counts were expected");
    return;
  }
  TextCursor ahead = text;
  if (ahead.word() == "BINARY") text.fail("binary OFF is not read; text OFF was expected");
}

void read_vertices(TextCursor& text, std::uint64_t count, PolygonSoup& soup) {
  soup.vertices.reserve(count);
  for (std::uint64_t v = 0; v < count; ++v) {
    if (!text.next_filled_line()) {
      text.fail("the file ends after " + std::to_string(v) + " vertices; " + std::to_string(count) + " were expected");
    }
    Vec3 point;
    for (int k = 0; k < 3; ++k) point[k] = text.number(kAxes[static_cast<std::size_t>(k)]);
    soup.vertices.push_back(point);
    text.next_line();
  }
}

/// Whether the next line holds nothing but some of the `missing` indices of a face: a face may be broken over lines,
/// but one that lacks an index must not take it from the next.
bool next_line_continues(TextCursor text, std::int64_t missing) {
  text.next_line();
  if (!text.next_filled_line()) return false;
  std::int64_t words = 0;
  for (; text.more_on_line() && words <= missing; ++words) text.word();
  return words <= missing;
}

void read_faces(TextCursor& text, std::uint64_t count, const std::string& path, PolygonSoup& soup) {
  const auto last = static_cast<std::int64_t>(soup.vertices.size()) - 1;
  Tally broken_faces;
  soup.first.reserve(count);
  for (std::uint64_t f = 0; f < count; ++f) {
    if (!text.next_filled_line()) {
      text.fail("the file ends after " + std::to_string(f) + " faces; " + std::to_string(count) + " were expected");
    }
    const std::size_t start = soup.corners.size();
    const std::int64_t corners = text.integer("the number of corners", 0, static_cast<std::int64_t>(kMaxCorners));
    const std::uint64_t line = text.line();
    bool broken = false;
    for (std::int64_t i = 0; i < corners; ++i) {
      if (!text.more_on_line() && next_line_continues(text, corners - i)) {
        text.next_line();
        text.next_filled_line();
        broken = true;
      }
      soup.corners.push_back(static_cast<std::uint32_t>(text.integer("a vertex index", 0, last)));
    }
    if (broken) broken_faces.add(line);
    soup.end_face(start, path, line);
    text.next_line();
  }
  broken_faces.warn(path, "a face goes on over several lines", soup.warnings);
}

}  // namespace

PolygonSoup read_off(const std::string& path, const std::string& content) {
  TextCursor text(content, path);
  read_magic(text);
  const auto vertices = static_cast<std::uint64_t>(text.integer("the number of vertices", 0, INT64_MAX));
  const auto faces = static_cast<std::uint64_t>(text.integer("the number of faces", 0, INT64_MAX));
  // The fewest bytes of a vertex ("0 0 0") and of a face ("0"), each with its line end.
  const std::uint64_t body = content.size() - text.offset() + 1;
  if (vertices > body / 6 || faces > body / 2) {
    text.fail("the header claims " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
              " faces, but " + std::to_string(body) + " bytes follow; a larger file was expected");
  }
  if (vertices > kMaxVertices) text.fail("more than 2^31 vertices; fewer were expected");
  text.next_line();
  PolygonSoup soup;
  soup.slots.push_back("");
  read_vertices(text, vertices, soup);
  read_faces(text, faces, path, soup);
  if (text.next_filled_line()) {
    Tally tail;
    tail.add(text.line());
    tail.warn(path, "what follows the last of the faces that the header counts is left out", soup.warnings);
  }
  return soup;
}

}  // namespace clray
