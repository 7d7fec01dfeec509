// SPDX-License-Identifier: Apache-2.0
// Checks of STL and OFF files before OpenMesh reads them: sizes against counts, finite numbers, indices in range.
#include <algorithm>
#include <array>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstring>

#include "scene/mesh_formats.hpp"
#include "scene/mesh_text.hpp"

namespace clray {

namespace {

std::uint32_t little_u32(const char* p) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(p[i]);
  return value;
}

constexpr std::size_t kStlHeader = 84, kStlFace = 50;

FormatClaim check_stl_binary(const std::string& content, const std::string& path) {
  FormatClaim claim;
  claim.binary = true;
  claim.faces = little_u32(content.data() + 80);
  for (std::uint64_t f = 0; f < claim.faces; ++f) {
    const char* face = content.data() + kStlHeader + f * kStlFace;
    for (int k = 3; k < 12; ++k) {  // 0-2 are the normal, which is not used
      const std::uint32_t bits = little_u32(face + 4 * k);
      float value = 0.0f;
      std::memcpy(&value, &bits, sizeof value);
      if (!std::isfinite(value)) {
        fail_input(
            path, 0,
            "face " + std::to_string(f + 1) + " has a coordinate that is not finite; finite numbers were expected");
      }
    }
  }
  return claim;
}

void expect(TextCursor& text, std::string_view expected) {
  if (!text.next_filled_line()) text.fail("the file ends where '" + std::string(expected) + "' was expected");
  std::size_t start = 0;
  while (start < expected.size()) {
    const std::size_t end = std::min(expected.find(' ', start), expected.size());
    const std::string_view word = text.word();
    if (word != expected.substr(start, end - start))
      text.fail(quote_word(word) + "; '" + std::string(expected) + "' was expected");
    start = end + 1;
  }
}

// A coordinate that OpenMesh's float can hold.
double coordinate(TextCursor& text, const char* what) {
  const double value = text.number(what);
  if (std::fabs(value) > static_cast<double>(FLT_MAX))
    text.fail(std::string(what) + " is beyond 3.4e38; less was expected");
  return value;
}

constexpr std::array<const char*, 3> kAxes = {"x of a vertex", "y of a vertex", "z of a vertex"};

void append_little(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
}

FormatClaim check_stl_ascii(const std::string& content, const std::string& path) {
  FormatClaim claim;
  claim.binary = true;
  claim.plain.assign(kStlHeader, '\0');
  TextCursor text(content, path);
  expect(text, "solid");
  text.next_line();
  bool open = true;
  while (text.next_filled_line()) {
    const std::string_view word = text.word();
    if (word == "endsolid") {
      open = false;
    } else if (word == "solid") {
      open = true;
    } else if (word == "facet") {
      if (!open) text.fail("a facet after endsolid; solid was expected");
      text.next_line();
      claim.plain.append(12, '\0');  // the normal is not used
      expect(text, "outer loop");
      text.next_line();
      for (int corner = 0; corner < 3; ++corner) {
        expect(text, "vertex");
        for (const char* what : kAxes) {
          const auto value = static_cast<float>(coordinate(text, what));
          std::uint32_t bits = 0;
          std::memcpy(&bits, &value, sizeof bits);
          append_little(claim.plain, bits);
        }
        if (text.more_on_line()) text.fail("more than three coordinates; the end of the line was expected");
        text.next_line();
      }
      expect(text, "endloop");
      text.next_line();
      expect(text, "endfacet");
      claim.plain.append(2, '\0');
      ++claim.faces;
    } else {
      text.fail(quote_word(word) + "; 'facet' or 'endsolid' was expected");
    }
    text.next_line();
  }
  if (open) text.fail("the file ends where 'endsolid' was expected");
  if (claim.faces > 0xffffffffu) text.fail("more than 2^32 facets; fewer were expected");
  std::string count;
  append_little(count, static_cast<std::uint32_t>(claim.faces));
  claim.plain.replace(80, 4, count);
  return claim;
}

void off_vertices(TextCursor& text, FormatClaim& claim) {
  char line[128];
  for (std::uint64_t v = 0; v < claim.vertices; ++v) {
    if (!text.next_filled_line())
      text.fail("the file ends after " + std::to_string(v) + " vertices; " + std::to_string(claim.vertices) +
                " were expected");
    Vec3 point;
    for (int k = 0; k < 3; ++k) point[k] = coordinate(text, kAxes[k]);
    claim.points.push_back(point);
    // to_chars knows no locale, unlike printf.
    for (int k = 0; k < 3; ++k) {
      claim.plain.append(line, std::to_chars(line, line + sizeof line, point[k]).ptr);
      claim.plain += k < 2 ? ' ' : '\n';
    }
    while (text.more_on_line()) text.number("a normal, colour or texture coordinate");
    text.next_line();
  }
}

void off_faces(TextCursor& text, FormatClaim& claim) {
  for (std::uint64_t f = 0; f < claim.faces; ++f) {
    if (!text.next_filled_line())
      text.fail("the file ends after " + std::to_string(f) + " faces; " + std::to_string(claim.faces) +
                " were expected");
    const std::int64_t corners = text.integer("the number of corners", 3, static_cast<std::int64_t>(kMaxCorners));
    claim.plain += std::to_string(corners);
    for (std::int64_t i = 0; i < corners; ++i) {
      claim.plain +=
          ' ' + std::to_string(text.integer("a vertex index", 0, static_cast<std::int64_t>(claim.vertices) - 1));
    }
    claim.plain += '\n';
    while (text.more_on_line()) text.number("a colour");
    text.next_line();
  }
}

}  // namespace

FormatClaim check_stl(const std::string& content, const std::string& path) {
  // By size first: many binary files begin with "solid" too.
  if (content.size() >= kStlHeader) {
    const std::uint64_t faces = little_u32(content.data() + 80);
    if (content.size() == kStlHeader + faces * kStlFace) return check_stl_binary(content, path);
    const bool text = content.compare(0, 5, "solid") == 0 && content.find('\0') == content.npos;
    if (!text) {
      fail_input(path, 0,
                 "a binary STL of " + std::to_string(content.size()) + " bytes claims " + std::to_string(faces) +
                     " faces; " + std::to_string(kStlHeader + faces * kStlFace) + " bytes were expected");
    }
  }
  return check_stl_ascii(content, path);
}

FormatClaim check_off(const std::string& content, const std::string& path) {
  FormatClaim claim;
  TextCursor text(content, path);
  if (!text.next_filled_line()) text.fail("no data; an OFF file was expected");
  const std::string_view magic = text.word();
  if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF" && magic != "NCOFF" &&
      magic != "STOFF") {
    text.fail(quote_word(magic) + "; OFF in three dimensions was expected");
  }
  if (text.more_on_line()) {
    const TextCursor here = text;
    const std::string_view word = text.word();
    if (word == "BINARY") text.fail("binary OFF is not read; text OFF was expected");
    text = here;
  } else {
    text.next_line();
    if (!text.next_filled_line()) text.fail("the file ends where the counts were expected");
  }
  claim.vertices = static_cast<std::uint64_t>(text.integer("the number of vertices", 0, INT64_MAX));
  claim.faces = static_cast<std::uint64_t>(text.integer("the number of faces", 0, INT64_MAX));
  if (text.more_on_line()) text.integer("the number of edges", 0, INT64_MAX);
  // Five bytes ("0 0 0") are the least for a vertex, seven for a face, each with its line end.
  const std::uint64_t body = content.size() - text.offset() + 1;
  if (claim.vertices > body / 6 || claim.faces > body / 8) {
    text.fail("the header claims " + std::to_string(claim.vertices) + " vertices and " + std::to_string(claim.faces) +
              " faces, but " + std::to_string(body) + " bytes follow; a larger file was expected");
  }
  text.next_line();
  claim.plain = "OFF\n" + std::to_string(claim.vertices) + ' ' + std::to_string(claim.faces) + " 0\n";
  off_vertices(text, claim);
  off_faces(text, claim);
  return claim;
}

}  // namespace clray
