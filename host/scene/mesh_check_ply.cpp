// SPDX-License-Identifier: Apache-2.0
// Check of a PLY file (text, little and big endian) before OpenMesh reads it: the header's counts against the
// file's size first, so that no claim allocates anything, then every value of every element.
// Source of the format: Turk, "The PLY polygon file format", 1994.
#include <array>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "scene/mesh_formats.hpp"
#include "scene/mesh_text.hpp"

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
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

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
  PlyHeader(TextCursor& text) : text_(text) {
    if (text_.word() != "ply") text_.fail("no 'ply' in the first line; a PLY file was expected");
    text_.next_line();
    bool format = false;
    for (;;) {
      if (!text_.next_filled_line()) text_.fail("the file ends in its header; end_header was expected");
      const std::string_view key = text_.word();
      if (key == "end_header") break;
      if (key == "format") {
        read_format();
        format = true;
      } else if (key == "element") {
        PlyElement element;
        element.name = std::string(text_.word());
        element.count = static_cast<std::uint64_t>(text_.integer("the number of elements", 0, INT64_MAX));
        elements.push_back(std::move(element));
      } else if (key == "property") {
        read_property();
      } else if (key != "comment" && key != "obj_info") {
        text_.fail(quote_word(key) + " is no PLY header line; format, element, property or end_header was expected");
      }
      text_.next_line();
    }
    if (!format) text_.fail("no format line; one was expected before end_header");
    text_.next_line();
  }

  Encoding encoding = Encoding::text;
  std::vector<PlyElement> elements;

 private:
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
  }

  void read_property() {
    if (elements.empty()) text_.fail("a property before any element; an element was expected");
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
    elements.back().properties.push_back(std::move(property));
  }

  TextCursor& text_;
};

/// Reads one value after the other, text or binary.
class PlyBody {
 public:
  PlyBody(TextCursor& text, const std::string& content, Encoding encoding, const std::string& path)
      : text_(text),
        p_(content.data() + text.offset()),
        end_(content.data() + content.size()),
        encoding_(encoding),
        path_(path) {}

  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - p_); }

  void begin_item(const std::string& element, std::uint64_t number) {
    element_ = &element;
    number_ = number;
    if (encoding_ == Encoding::text && !text_.next_filled_line())
      text_.fail("the file ends where " + item() + " was expected");
  }
  void end_item() {
    if (encoding_ != Encoding::text) return;
    if (text_.more_on_line()) {
      text_.fail(quote_word(text_.word()) + " follows a complete " + *element_ + "; the end of the line was expected");
    }
    text_.next_line();
  }

  double value(const ScalarType& type) {
    if (encoding_ == Encoding::text) return text_value(type);
    if (bytes_left() < type.bytes)
      fail_input(path_, 0,
                 "the file ends inside " + item() + "; " + std::to_string(type.bytes) + " more bytes were expected");
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < type.bytes; ++i) {
      const unsigned at = encoding_ == Encoding::big ? i : type.bytes - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(p_[at]);
    }
    p_ += type.bytes;
    return decoded(bits, type);
  }

  [[noreturn]] void fail(const std::string& message) const {
    if (encoding_ == Encoding::text) text_.fail(message);
    fail_input(path_, 0, item() + ": " + message);
  }

 private:
  std::string item() const { return *element_ + " " + std::to_string(number_); }

  // Within its type, or else OpenMesh's stream would stop there and leave the rest unread.
  double text_value(const ScalarType& type) {
    if (type.kind == 'f') {
      const double value = text_.number("a property value");
      if (std::fabs(value) > static_cast<double>(FLT_MAX)) text_.fail("a value beyond 3.4e38; less was expected");
      return value;
    }
    const int bits = static_cast<int>(8 * type.bytes) - (type.kind == 's' ? 1 : 0);
    const std::int64_t high = (std::int64_t{1} << bits) - 1;
    return static_cast<double>(text_.integer("a property value", type.kind == 's' ? -high - 1 : 0, high));
  }

  static double decoded(std::uint64_t bits, const ScalarType& type) {
    if (type.kind == 'u') return static_cast<double>(bits);
    if (type.kind == 's') {
      const unsigned shift = 64 - 8 * type.bytes;
      return static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift);
    }
    if (type.bytes == 8) {
      double value;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }
    const auto narrow = static_cast<std::uint32_t>(bits);
    float value;
    std::memcpy(&value, &narrow, sizeof value);
    return value;
  }

  TextCursor& text_;
  const char* p_;
  const char* end_;
  Encoding encoding_;
  const std::string& path_;
  const std::string* element_ = nullptr;
  std::uint64_t number_ = 0;
};

bool is_coordinate(const PlyProperty& property) {
  return !property.count_type && (property.name == "x" || property.name == "y" || property.name == "z");
}

bool is_corner_list(const PlyElement& element, const PlyProperty& property) {
  return element.name == "face" && property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

// The least a file must still hold for the header to be true: in text a digit and a separator per value.
void check_size(const PlyHeader& header, std::uint64_t body, const std::string& path) {
  for (const PlyElement& element : header.elements) {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties) {
      const bool corners = is_corner_list(element, p);
      if (header.encoding == Encoding::text) {
        least += corners ? 8 : 2;
      } else {
        least += p.count_type ? p.count_type->bytes + (corners ? 3 * p.type->bytes : 0) : p.type->bytes;
      }
    }
    const std::uint64_t available = header.encoding == Encoding::text ? body + 1 : body;
    if (least > 0 ? element.count > available / least : element.count > 0) {
      fail_input(path, 0,
                 "the header claims " + std::to_string(element.count) + " of element '" + element.name + "', but " +
                     std::to_string(body) + " bytes follow; a larger file was expected");
    }
  }
}

void check_layout(const PlyHeader& header, FormatClaim& claim, const std::string& path) {
  int coordinates = 0, corner_lists = 0, vertices = 0, faces = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      claim.vertices = element.count;
      ++vertices;
    }
    if (element.name == "face") {
      claim.faces = element.count;
      ++faces;
    }
    for (const PlyProperty& p : element.properties) {
      if (element.name == "vertex" && is_coordinate(p)) ++coordinates;
      if (is_corner_list(element, p)) {
        ++corner_lists;
        if (p.type->kind == 'f') fail_input(path, 0, "vertex_indices in a floating type; an integer type was expected");
      }
    }
  }
  if (vertices != 1 || faces != 1 || coordinates != 3 || corner_lists != 1) {
    fail_input(path, 0,
               "one element vertex with x, y, z and one element face with a list vertex_indices were expected");
  }
}

void append_little(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
}

void read_list(PlyBody& body, const PlyProperty& property, bool corners, std::uint64_t vertices, std::string& plain) {
  const double count = body.value(*property.count_type);
  if (!(count >= (corners ? 3.0 : 0.0))) {
    body.fail("a list of " + std::to_string(static_cast<long long>(count)) + " entries; " +
              (corners ? "at least three corners" : "none or more") + " were expected");
  }
  if (corners) append_little(plain, static_cast<std::uint32_t>(count));
  for (double i = 0; i < count; ++i) {
    const double index = body.value(*property.type);
    if (!corners) continue;
    if (!(index >= 0.0 && index < static_cast<double>(vertices))) {
      body.fail("vertex index " + std::to_string(static_cast<long long>(index)) + "; an integer from 0 to " +
                std::to_string(vertices) + " less one was expected");
    }
    append_little(plain, static_cast<std::uint32_t>(index));
  }
}

void read_vertex(PlyBody& body, const PlyElement& element, FormatClaim& claim) {
  Vec3 point(0.0);
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) {
      read_list(body, property, false, 0, claim.plain);
      continue;
    }
    const double value = body.value(*property.type);
    if (!is_coordinate(property)) continue;
    if (!(std::fabs(value) <= static_cast<double>(FLT_MAX))) {
      body.fail("a coordinate that is not finite or beyond 3.4e38; a finite number was expected");
    }
    point[property.name[0] - 'x'] = value;
  }
  claim.points.push_back(point);
}

std::string plain_header(const FormatClaim& claim) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(claim.vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(claim.faces) +
         "\nproperty list int int vertex_indices\nend_header\n";
}

}  // namespace

FormatClaim check_ply(const std::string& content, const std::string& path) {
  TextCursor text(content, path);
  const PlyHeader header(text);
  FormatClaim claim;
  check_layout(header, claim, path);
  PlyBody body(text, content, header.encoding, path);
  check_size(header, body.bytes_left(), path);
  std::string faces;
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      body.begin_item(element.name, i + 1);
      if (element.name == "vertex") {
        read_vertex(body, element, claim);
      } else {
        for (const PlyProperty& property : element.properties) {
          if (property.count_type) {
            read_list(body, property, is_corner_list(element, property), claim.vertices, faces);
          } else {
            body.value(*property.type);
          }
        }
      }
      body.end_item();
    }
  }
  claim.binary = true;
  claim.plain = plain_header(claim);
  for (const Vec3& point : claim.points) {
    for (int k = 0; k < 3; ++k) {
      const auto value = static_cast<float>(point[k]);
      std::uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      append_little(claim.plain, bits);
    }
  }
  claim.plain += faces;
  return claim;
}

}  // namespace clray
