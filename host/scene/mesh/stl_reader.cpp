// SPDX-License-Identifier: Apache-2.0
// STL reader, text and binary. Each facet lists three points; points of equal coordinates become one vertex, and a
// facet whose corners coincide is left out. Normals and attributes are not used. Keywords in any case.
// Source of the format: 3D Systems, "StereoLithography Interface Specification", 1989.
#include <array>
#include <cmath>
#include <cstring>

#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_text.hpp"
#include "scene/mesh/point_index.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of a binary file
constexpr std::array<const char*, 3> kAxes = {"x of a vertex", "y of a vertex", "z of a vertex"};

/// Facets become faces over shared vertices.
class Facets {
 public:
  explicit Facets(std::size_t expected) : points_(expected / 2) { soup_.first.reserve(expected); }

  void add(const std::array<Vec3, 3>& points) {
    std::uint32_t corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = points_.number(points[k]);
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
      ++soup_.collapsed;
      return;
    }
    soup_.first.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    soup_.corners.insert(soup_.corners.end(), corner, corner + 3);
  }

  std::size_t vertices() const { return points_.points().size(); }

  PolygonSoup take() {
    soup_.vertices = points_.take();
    soup_.slots.push_back("");
    return std::move(soup_);
  }

 private:
  PolygonSoup soup_;
  PointIndex points_;
};

std::uint32_t little_u32(const char* p) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(p[i]);
  return value;
}

std::uint64_t claimed_facets(const std::string& content) {
  return content.size() < kHeader ? 0 : little_u32(content.data() + 80);
}

PolygonSoup read_binary(const std::string& path, const std::string& content) {
  const std::uint64_t count = claimed_facets(content), size = kHeader + count * kFacet;
  if (content.size() < size) {
    fail_input(path, 0,
               "a binary STL of " + std::to_string(content.size()) + " bytes claims " + std::to_string(count) +
                   " faces; " + std::to_string(size) + " bytes were expected");
  }
  if (count > kMaxVertices / 3) fail_input(path, 0, "more than 2^31 corners; fewer were expected");
  Facets facets(count);
  for (std::uint64_t f = 0; f < count; ++f) {
    const char* p = content.data() + kHeader + f * kFacet + 12;  // behind the normal
    std::array<Vec3, 3> points;
    for (Vec3& point : points) {
      for (int k = 0; k < 3; ++k, p += 4) {
        const std::uint32_t bits = little_u32(p);
        float value = 0.0f;
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) {
          fail_input(
              path, 0,
              "face " + std::to_string(f + 1) + " has a coordinate that is not finite; finite numbers were expected");
        }
        point[k] = static_cast<double>(value);
      }
    }
    facets.add(points);
  }
  PolygonSoup soup = facets.take();
  if (content.size() > size) {
    Tally tail;
    tail.add(0);
    tail.warn(path,
              text::counted(content.size() - size, "byte follows", "bytes follow") + " the " +
                  text::counted(count, "face") + " that the header counts; left out",
              soup.warnings);
  }
  return soup;
}

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// The next keyword, in small letters; two words make one ("endsolid", "outerloop"). Empty at the end of the file.
std::string keyword(TextCursor& text) {
  if (!text.next_filled_line()) return {};
  std::string word = lower(text.word());
  if (word == "end" || word == "outer") word += lower(text.word());
  return word;
}

void expect(TextCursor& text, const std::string& expected) {
  const std::string word = keyword(text);
  if (word.empty()) text.fail("the file ends where '" + expected + "' was expected");
  if (word != expected) text.fail(quote_word(word) + "; '" + expected + "' was expected");
}

void read_facet(TextCursor& text, Facets& facets) {
  text.next_line();  // the normal is not used
  expect(text, "outerloop");
  text.next_line();
  std::array<Vec3, 3> points;
  for (Vec3& point : points) {
    expect(text, "vertex");
    for (int k = 0; k < 3; ++k) point[k] = text.number(kAxes[static_cast<std::size_t>(k)]);
    if (text.more_on_line()) text.fail("more than three coordinates; the end of the line was expected");
    text.next_line();
  }
  expect(text, "endloop");
  text.next_line();
  expect(text, "endfacet");
  facets.add(points);
  if (facets.vertices() > kMaxVertices) text.fail("more than 2^31 vertices; fewer were expected");
}

// What follows "solid" and "endsolid" is a name; a file may hold several solids, and may lack the last endsolid.
PolygonSoup read_text(const std::string& path, const std::string& content) {
  TextCursor text(content, path);
  Facets facets(0);
  expect(text, "solid");
  text.next_line();
  for (std::string word = keyword(text); !word.empty(); word = keyword(text)) {
    if (word == "facet") {
      read_facet(text, facets);
    } else if (word != "solid" && word != "endsolid") {
      text.fail(quote_word(word) + "; 'facet' or 'endsolid' was expected");
    }
    text.next_line();
  }
  return facets.take();
}

bool begins_with_solid(const std::string& content) {
  const std::string none;
  TextCursor text(content, none);
  return text.next_filled_line() && lower(text.word()) == "solid";
}

}  // namespace

PolygonSoup read_stl(const std::string& path, const std::string& content) {
  // The size decides first, since many binary files begin with "solid" as well.
  const bool whole = content.size() >= kHeader && content.size() == kHeader + claimed_facets(content) * kFacet;
  const bool text = content.size() < kHeader || (begins_with_solid(content) && content.find('\0') == std::string::npos);
  return text && !whole ? read_text(path, content) : read_binary(path, content);
}

}  // namespace clray
