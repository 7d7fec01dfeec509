// SPDX-License-Identifier: Apache-2.0
// PLY reader (text, little and big endian): x, y, z of the element vertex and the corner lists of the element face.
// Other properties and elements are stepped over, so that neither a normal that is not a number nor an unknown
// colour matters. The header's counts are compared with the file's size before anything is allocated.
// Source of the format: Turk, "The PLY polygon file format", 1994.
#include <array>
#include <cmath>
#include <cstring>

#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_text.hpp"
#include "text/near_miss.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

struct ScalarType {
  const char* name;
  const char* alias;
  unsigned bytes;
  char kind;  // s signed, u unsigned, f floating
};
constexpr std::array<ScalarType, 8> kTypes = {{{"char", "int8", 1, 's'},
                                               {"uchar", "uint8", 1, 'u'},
                                               {"short", "int16", 2, 's'},
                                               {"ushort", "uint16", 2, 'u'},
                                               {"int", "int32", 4, 's'},
                                               {"uint", "uint32", 4, 'u'},
                                               {"float", "float32", 4, 'f'},
                                               {"double", "float64", 8, 'f'}}};

struct PlyProperty {
  std::string name;
  const ScalarType* type = nullptr;
  const ScalarType* count_type = nullptr;  // of a list
  int axis = -1;                           // of a vertex: 0, 1, 2 for x, y, z
  bool corners = false;                    // of a face: its list of vertices
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

constexpr const char* kStrips = "tristrips";

enum class Encoding { text, little, big };

const ScalarType& scalar_type(TextCursor& text) {
  const std::string_view word = text.word();
  for (const ScalarType& type : kTypes) {
    if (word == type.name || word == type.alias) return type;
  }
  text.fail(quote_word(word) + " is no PLY type; char, uchar, …, float or double was expected");
}

class PlyHeader {
 public:
  explicit PlyHeader(TextCursor& text) : text_(text) {
    if (text_.word() != "ply") text_.fail("no 'ply' in the first line; a PLY file was expected");
    text_.next_line();
    for (;;) {
      if (!text_.next_filled_line()) text_.fail("the file ends in its header; end_header was expected");
      const std::string key(text_.word());
      if (key == "end_header") break;
      read_line(key);
      text_.next_line();
    }
    if (!format_) text_.fail("no format line; one was expected before end_header");
    text_.next_line();
  }

  Encoding encoding = Encoding::text;
  std::vector<PlyElement> elements;
  Tally strange;  // lines that are no header lines

 private:
  void read_line(const std::string& key) {
    if (key == "format") {
      read_format();
    } else if (key == "element") {
      PlyElement element;
      element.name = std::string(text_.word());
      element.count = static_cast<std::uint64_t>(text_.integer("the number of elements", 0, INT64_MAX));
      elements.push_back(std::move(element));
    } else if (key == "property") {
      read_property();
    } else if (key != "comment" && key != "obj_info") {
      // Some writers forget the word "comment". A misspelt keyword is refused, because the data would be misread.
      const std::string hint = text::did_you_mean(key, {"format", "element", "property", "end_header"});
      if (!hint.empty()) text_.fail(quote_word(key) + " is no PLY header line" + hint + " A PLY header was expected");
      strange.add(text_.line(), key);
    }
  }

  void read_format() {
    const std::string_view word = text_.word();
    if (word == "ascii") {
      encoding = Encoding::text;
    } else if (word == "binary_little_endian") {
      encoding = Encoding::little;
    } else if (word == "binary_big_endian") {
      encoding = Encoding::big;
    } else {
      text_.fail(quote_word(word) + "; ascii, binary_little_endian or binary_big_endian was expected");
    }
    format_ = true;
  }

  void read_property() {
    if (elements.empty()) text_.fail("a property before any element; an element was expected");
    PlyElement& element = elements.back();
    PlyProperty property;
    TextCursor ahead = text_;
    if (ahead.word() == "list") {
      text_.word();
      property.count_type = &scalar_type(text_);
      if (property.count_type->kind == 'f')
        text_.fail("a list counted in a floating type; an integer type was expected");
    }
    property.type = &scalar_type(text_);
    property.name = std::string(text_.word());
    if (property.name.empty()) text_.fail("a property without a name; a name was expected");
    if (element.name == "vertex" && !property.count_type && property.name.size() == 1 && property.name[0] >= 'x' &&
        property.name[0] <= 'z')
      property.axis = property.name[0] - 'x';
    property.corners = (element.name == "face" || element.name == kStrips) && property.count_type &&
                       (property.name == "vertex_indices" || property.name == "vertex_index");
    if (property.corners && property.type->kind == 'f')
      text_.fail(property.name + " in a floating type; an integer type was expected");
    element.properties.push_back(std::move(property));
  }

  TextCursor& text_;
  bool format_ = false;
};

/// Reads or skips one value after the other, in text or binary.
class PlyBody {
 public:
  PlyBody(TextCursor& text, const std::string& content, Encoding encoding, const std::string& path)
      : text_(text),
        p_(content.data() + text.offset()),
        end_(content.data() + content.size()),
        encoding_(encoding),
        path_(path) {}

  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - p_); }
  std::uint64_t line() const { return encoding_ == Encoding::text ? text_.line() : 0; }

  void begin_item(const std::string& element, std::uint64_t number) {
    element_ = &element;
    number_ = number;
    if (encoding_ == Encoding::text && !text_.next_filled_line())
      text_.fail("the file ends where " + item() + " was expected");
  }
  // A word too many matters where the last property is one that is used: its count may be wrong.
  void end_item(bool last_used) {
    if (encoding_ != Encoding::text) return;
    if (text_.more_on_line()) {
      const std::string_view word = text_.word();
      if (last_used)
        text_.fail(quote_word(word) + " follows a complete " + *element_ + "; the end of the line was expected");
      surplus_.add(text_.line(), word);
    }
    text_.next_line();
  }

  double number(const ScalarType& type) {
    if (encoding_ == Encoding::text) return text_.number("a property value");
    const std::uint64_t bits = take(type);
    double value = static_cast<double>(bits);
    if (type.kind == 's') value = static_cast<double>(extended(bits, type));
    if (type.kind == 'f' && type.bytes == 8) std::memcpy(&value, &bits, sizeof value);
    if (type.kind == 'f' && type.bytes == 4) {
      const auto narrow = static_cast<std::uint32_t>(bits);
      float single;
      std::memcpy(&single, &narrow, sizeof single);
      value = static_cast<double>(single);
    }
    if (!std::isfinite(value)) fail("a coordinate that is not finite; a finite number was expected");
    return value;
  }

  std::int64_t integer(const ScalarType& type, std::int64_t low, std::int64_t high, const char* what) {
    if (encoding_ == Encoding::text) return text_.integer(what, low, high);
    const std::uint64_t bits = take(type);
    const std::int64_t value = type.kind == 's' ? extended(bits, type) : static_cast<std::int64_t>(bits);
    if (value < low || value > high) {
      fail(std::string(what) + " is " + std::to_string(value) + "; an integer from " + std::to_string(low) + " to " +
           std::to_string(high) + " was expected");
    }
    return value;
  }

  void skip(const ScalarType& type) {
    if (encoding_ == Encoding::text) {
      if (text_.word().empty()) text_.fail("the line ends where a property value was expected");
    } else {
      take(type);
    }
  }

  // The bytes or lines behind the last element.
  void check_tail(std::vector<std::string>& warnings) {
    surplus_.warn(path_, quote_word(surplus_.first) + " follows the properties that the header names; left out",
                  warnings);
    Tally tail;
    if (encoding_ != Encoding::text) {
      if (bytes_left() > 0) tail.add(0);
      tail.warn(path_, text::counted(bytes_left(), "byte follows", "bytes follow") + " the last element; left out",
                warnings);
    } else if (text_.next_filled_line()) {
      tail.add(text_.line());
      tail.warn(path_, "what follows the last of the elements that the header counts is left out", warnings);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_input(path_, 0, item() + ": " + message); }
  std::string item() const { return *element_ + " " + std::to_string(number_); }

  std::uint64_t take(const ScalarType& type) {
    if (bytes_left() < type.bytes) {
      fail_input(path_, 0,
                 "the file ends inside " + item() + "; " + std::to_string(type.bytes) + " more bytes were expected");
    }
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < type.bytes; ++i) {
      const unsigned at = encoding_ == Encoding::big ? i : type.bytes - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(p_[at]);
    }
    p_ += type.bytes;
    return bits;
  }

  static std::int64_t extended(std::uint64_t bits, const ScalarType& type) {
    const unsigned shift = 64 - 8 * type.bytes;
    return static_cast<std::int64_t>(bits << shift) >> shift;
  }

  TextCursor& text_;
  const char* p_;
  const char* end_;
  Encoding encoding_;
  const std::string& path_;
  const std::string* element_ = nullptr;
  std::uint64_t number_ = 0;
  Tally surplus_;
};

// One element vertex and one element face (or tristrips) with what is read of them.
void check_layout(const PlyHeader& header, const std::string& path) {
  int axes[3] = {0, 0, 0}, corner_lists = 0, vertices = 0, faces = 0, strips = 0;
  for (const PlyElement& element : header.elements) {
    vertices += element.name == "vertex";
    faces += element.name == "face";
    strips += element.name == kStrips;
    for (const PlyProperty& p : element.properties) {
      if (p.axis >= 0) ++axes[p.axis];
      corner_lists += p.corners;
    }
  }
  if (faces == 0 && strips == 0 && vertices == 1)
    fail_input(path, 0, "points without faces; an element face with a list vertex_indices was expected");
  const bool one = faces <= 1 && strips <= 1 && faces + strips > 0 && corner_lists == faces + strips;
  if (vertices != 1 || !one || axes[0] != 1 || axes[1] != 1 || axes[2] != 1) {
    fail_input(path, 0,
               "one element vertex with x, y, z and one element face with a list vertex_indices were expected");
  }
}

// The fewest bytes that the header promises: in text, a digit and a separator per value.
void check_size(const PlyHeader& header, std::uint64_t body, const std::string& path) {
  const bool text = header.encoding == Encoding::text;
  for (const PlyElement& element : header.elements) {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties)
      least += text ? 2 : p.count_type ? p.count_type->bytes : p.type->bytes;
    const std::uint64_t available = text ? body + 1 : body;
    if (least > 0 ? element.count > available / least : element.count > 0) {
      fail_input(path, 0,
                 "the header claims " + std::to_string(element.count) + " of element '" + element.name + "', but " +
                     std::to_string(body) + " bytes follow; a larger file was expected");
    }
    if (element.name == "vertex" && element.count > kMaxVertices)
      fail_input(path, 0, "more than 2^31 vertices; fewer were expected");
  }
}

// Strips of triangles, each strip ended by -1: every corner makes a triangle with the two before it, turned over at
// every second one. Triangles with a corner twice only lead from one strip to the next.
void read_strips(PlyBody& body, const ScalarType& type, std::int64_t count, std::uint64_t vertices,
                 const std::string& path, PolygonSoup& soup) {
  std::int64_t a = -1, b = -1;
  bool turned = false;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t c = body.integer(type, -1, static_cast<std::int64_t>(vertices) - 1, "a vertex index");
    if (c < 0) {
      a = b = -1;
      turned = false;
      continue;
    }
    if (a >= 0) {
      if (a != b && b != c && a != c) {
        const std::size_t start = soup.corners.size();
        for (const std::int64_t corner : {turned ? b : a, turned ? a : b, c})
          soup.corners.push_back(static_cast<std::uint32_t>(corner));
        soup.end_face(start, path, body.line());
      }
      turned = !turned;
    }
    a = b;
    b = c;
  }
}

void read_item(PlyBody& body, const PlyElement& element, std::uint64_t vertices, const std::string& path,
               PolygonSoup& soup) {
  Vec3 point(0.0);
  for (const PlyProperty& p : element.properties) {
    if (p.axis >= 0) {
      point[p.axis] = body.number(*p.type);
      continue;
    }
    if (!p.count_type) {
      body.skip(*p.type);
      continue;
    }
    const std::int64_t count =
        body.integer(*p.count_type, 0, static_cast<std::int64_t>(kMaxCorners), "a list's length");
    if (p.corners && element.name == kStrips) {
      read_strips(body, *p.type, count, vertices, path, soup);
      continue;
    }
    for (std::int64_t i = 0; i < count; ++i) {
      if (!p.corners) {
        body.skip(*p.type);
        continue;
      }
      soup.corners.push_back(static_cast<std::uint32_t>(
          body.integer(*p.type, 0, static_cast<std::int64_t>(vertices) - 1, "a vertex index")));
    }
  }
  if (element.name == "vertex") soup.vertices.push_back(point);
}

}  // namespace

PolygonSoup read_ply(const std::string& path, const std::string& content) {
  TextCursor text(content, path);
  const PlyHeader header(text);
  check_layout(header, path);
  PlyBody body(text, content, header.encoding, path);
  check_size(header, body.bytes_left(), path);
  std::uint64_t vertices = 0;
  for (const PlyElement& element : header.elements) vertices = element.name == "vertex" ? element.count : vertices;
  PolygonSoup soup;
  soup.slots.push_back("");
  soup.vertices.reserve(vertices);
  header.strange.warn(path, "header line " + quote_word(header.strange.first) + " is taken as a comment",
                      soup.warnings);
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const std::size_t start = soup.corners.size();
      body.begin_item(element.name, i + 1);
      read_item(body, element, vertices, path, soup);
      if (element.name == "face") soup.end_face(start, path, body.line());
      const PlyProperty* last = element.properties.empty() ? nullptr : &element.properties.back();
      body.end_item(last == nullptr || last->corners || last->axis >= 0);
    }
  }
  body.check_tail(soup.warnings);
  return soup;
}

}  // namespace clray
