// SPDX-License-Identifier: Apache-2.0
// PLY, STL and OFF: every encoding of the same box, read with its exact area; and every file that does not hold what
// it claims, refused.
#include <cstring>
#include <functional>
#include <locale>

#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace {

// A box of 2 × 3 × 4.1 (4.1 has no exact float): area 2·(6 + 8.2 + 12.3) = 53, volume 24.6.
const double kTop = 4.1;
const double kPoints[8][3] = {{0, 0, 0},    {2, 0, 0},    {2, 3, 0},    {0, 3, 0},
                              {0, 0, kTop}, {2, 0, kTop}, {2, 3, kTop}, {0, 3, kTop}};
const int kQuads[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}};

template <typename T>
void put(std::string& bytes, T value, bool big) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));  // the test machine is little-endian, as every OpenCL host of clray
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big ? sizeof(T) - 1 - i : i];
}

std::string points_text(const std::string& after = "\n") {
  std::string text;
  for (const auto& p : kPoints) {
    text += std::to_string(static_cast<int>(p[0])) + " " + std::to_string(static_cast<int>(p[1])) +
            (p[2] > 0 ? " 4.1" : " 0") + after;
  }
  return text;
}

std::string quads_text(const std::string& before = "", const std::string& after = "\n") {
  std::string text;
  for (const auto& q : kQuads) {
    text += before + "4";
    for (const int corner : q) text += " " + std::to_string(corner);
    text += after;
  }
  return text;
}

std::string ply_header(const std::string& format, const std::string& type = "double", const std::string& vertices = "8",
                       const std::string& faces = "6") {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nobj_info none\nelement vertex " + vertices +
         "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type + " z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

template <typename T>
std::string ply_binary(bool big) {
  std::string bytes =
      ply_header(big ? "binary_big_endian" : "binary_little_endian", sizeof(T) == 8 ? "float64" : "float32");
  for (const auto& p : kPoints) {
    for (const double c : p) put(bytes, static_cast<T>(c), big);
  }
  for (const auto& q : kQuads) {
    put<std::uint8_t>(bytes, 4, big);
    for (const int corner : q) put<std::int32_t>(bytes, corner, big);
  }
  return bytes;
}

const std::string kPlyText = ply_header("ascii") + points_text() + quads_text();
const std::string kOff = "OFF\n8 6 12\n" + points_text() + quads_text();

void each_triangle(const std::function<void(const double*, const double*, const double*)>& call) {
  for (const auto& q : kQuads) {
    call(kPoints[q[0]], kPoints[q[1]], kPoints[q[2]]);
    call(kPoints[q[0]], kPoints[q[2]], kPoints[q[3]]);
  }
}

std::string stl_text() {
  std::string text = "solid box\n";
  each_triangle([&](const double* a, const double* b, const double* c) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const double* p : {a, b, c}) {
      text += "   vertex " + std::to_string(static_cast<int>(p[0])) + " " + std::to_string(static_cast<int>(p[1])) +
              (p[2] > 0 ? " 4.1\n" : " 0\n");
    }
    text += "  endloop\n endfacet\n";
  });
  return text + "endsolid box\n";
}

std::string stl_binary(const std::string& title = "binary", std::uint32_t extra = 0) {
  std::string bytes = title;
  bytes.resize(80, ' ');
  put<std::uint32_t>(bytes, 12 + extra, false);
  each_triangle([&](const double* a, const double* b, const double* c) {
    bytes.append(12, '\0');
    for (const double* p : {a, b, c}) {
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(p[k]), false);
    }
    bytes.append(2, '\0');
  });
  return bytes;
}

void check_box(const clray::Mesh& mesh, std::uint64_t faces, double tolerance) {
  CHECK(mesh.report.faces == faces);
  CHECK(mesh.report.triangles == 12);
  CHECK(mesh.vertices.size() == 8);
  CHECK(mesh.report.area_m2 == doctest::Approx(53.0).epsilon(tolerance));
  CHECK(volume(mesh) == doctest::Approx(24.6).epsilon(tolerance));
  CHECK(mesh.report.boundary_edges == 0);
  CHECK(mesh.report.non_manifold_edges == 0);
  CHECK(mesh.report.degenerate == 0);
  CHECK(mesh.material_slots == std::vector<std::string>{""});
  CHECK(mesh.triangle_slot.size() == 12);
}

constexpr double kDouble = 1e-15;  // a few units in the last place
constexpr double kFloat = 3e-8;    // 4.1 as a float is off by 2.3e-8 relative

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), with);
}

std::string all_replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

TEST_CASE("PLY in text and both binary orders keeps doubles as doubles") {
  check_box(*load_text(kPlyText, "a.ply"), 6, kDouble);
  check_box(*load_text(kPlyText, "A.PLY"), 6, kDouble);
  check_box(*load_text(all_replaced(kPlyText, "\n", "\r\n"), "a.ply"), 6, kDouble);
  check_box(*load_text(ply_binary<double>(false), "a.ply"), 6, kDouble);
  check_box(*load_text(ply_binary<double>(true), "a.ply"), 6, kDouble);
  check_box(*load_text(ply_binary<float>(false), "a.ply"), 6, kFloat);
  check_box(*load_text(ply_binary<float>(true), "a.ply"), 6, kFloat);
  CHECK(load_text(kPlyText, "a.ply")->vertices[6].z == 4.1);
}

TEST_CASE("PLY with normals, colours, further lists, elements and vertex_index is read past them") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "float nx\n"
      "property uchar red\nproperty short weight\nelement face 6\nproperty uchar flags\n"
      "property list uchar uint vertex_index\nproperty list int float texcoord\nelement edge 1\nproperty int vertex1\n"
      "property int vertex2\nend_header\n" +
      points_text(" -0.5 200 -300\n") + quads_text("7 ", " 2 0.5 0.5\n") + "0 1\n";
  check_box(*load_text(text, "a.ply"), 6, kDouble);
}

TEST_CASE("STL in text and binary, also binary that begins with solid") {
  check_box(*load_text(stl_text(), "a.stl"), 12, kDouble);
  check_box(*load_text(all_replaced(stl_text(), "\n", "\r\n"), "a.stl"), 12, kDouble);
  check_box(*load_text(stl_binary(), "a.stl"), 12, kFloat);
  check_box(*load_text(stl_binary("solid but binary"), "a.stl"), 12, kFloat);
}

TEST_CASE("OFF with comments, colours, CRLF and counts on the first line") {
  check_box(*load_text(kOff, "a.off"), 6, kDouble);
  check_box(*load_text(all_replaced(kOff, "\n", "  # note\r\n"), "a.off"), 6, kDouble);
  check_box(*load_text("# first\n\nOFF 8 6 0\n" + points_text() + quads_text(), "a.off"), 6, kDouble);
  check_box(*load_text("OFF\n8 6\n" + points_text() + quads_text("", " 255 0 0\n"), "a.off"), 6, kDouble);
  check_box(*load_text("COFF\n8 6 0\n" + points_text(" 255 0 0 255\n") + quads_text(), "a.off"), 6, kDouble);
}

TEST_CASE("a locale with a decimal comma changes nothing in PLY, STL and OFF") {
  struct CommaPoint : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::string stl = stl_text();
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaPoint));
  check_box(*load_text(kPlyText, "a.ply"), 6, kDouble);
  check_box(*load_text(kOff, "a.off"), 6, kDouble);
  check_box(*load_text(stl, "a.stl"), 12, kDouble);
  std::locale::global(before);
}

TEST_CASE("duplicate, flipped and degenerate faces of PLY, STL and OFF are kept") {
  const std::string more = "4 4 5 6 7\n4 7 6 5 4\n3 0 0 1\n";
  const std::string ply = replaced(kPlyText, "face 6", "face 9") + more;
  const std::string off = replaced(kOff, "8 6 12", "8 9 12") + more;
  for (const auto& mesh : {load_text(ply, "a.ply"), load_text(off, "a.off")}) {
    CHECK(mesh->report.area_m2 == doctest::Approx(65.0).epsilon(kDouble));
    CHECK(mesh->report.faces == 9);
    CHECK(mesh->triangles.size() == 17);
    CHECK(mesh->report.degenerate == 1);
    CHECK(mesh->report.non_manifold_edges == 5);  // four of the top, one that the degenerate face joins
  }
  std::string stl = stl_binary("x", 2);
  const std::string face = stl.substr(84, 50);
  std::string point = face.substr(0, 24) + face.substr(12, 12) + face.substr(12, 12) + face.substr(48);
  stl += face + point;
  const auto mesh = load_text(stl, "a.stl");
  CHECK(mesh->report.faces == 14);
  CHECK(mesh->report.degenerate == 1);
  CHECK(mesh->report.area_m2 == doctest::Approx(56.0).epsilon(kFloat));
}

TEST_CASE("counts that the file is too small for are refused before anything is allocated") {
  for (const char* claim : {"1000000000000", "4294967296", "9223372036854775807"}) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      check_refused(ply_header(format, "float", claim) + points_text(), "a.ply", "a larger file was expected", "a.ply");
      check_refused(ply_header(format, "float", "8", claim) + points_text(), "a.ply", "a larger file was expected",
                    "a.ply");
    }
    check_refused(std::string("OFF\n") + claim + " 6 0\n" + points_text(), "a.off:2", "a larger file was expected",
                  "a.off");
    check_refused(std::string("OFF\n8 ") + claim + " 0\n" + points_text(), "a.off:2", "a larger file was expected",
                  "a.off");
  }
  check_refused(ply_header("ascii", "float", "99999999999999999999"), "a.ply:5", "the number of elements", "a.ply");
  check_refused(stl_binary("x", 4000000000u), "a.stl", "bytes were expected", "a.stl");
  std::string wide = ply_binary<float>(false);
  wide = wide.substr(0, wide.find("end_header\n") + 11 + 96) + "\xff" + wide.substr(wide.size() - 100);
  CHECK(refusal(wide, "a.ply") != "accepted");
}

TEST_CASE("numbers that are not finite are refused") {
  check_refused(replaced(kPlyText, "2 3 4.1", "2 nan 4.1"), "a.ply:18", "'nan' is not finite", "a.ply");
  check_refused(replaced(kPlyText, "2 3 4.1", "2 3 1e400"), "a.ply:18", "too large", "a.ply");
  check_refused(replaced(kPlyText, "2 3 4.1", "2 3 1e39"), "a.ply", "beyond 1e15 m", "a.ply");
  check_refused(replaced(kPlyText, "2 3 4.1", "a b c"), "a.ply:18", "'a' is no number", "a.ply");
  check_refused(replaced(kOff, "2 3 4.1", "2 inf 4.1"), "a.off:9", "'inf' is not finite", "a.off");
  check_refused(replaced(kOff, "2 3 4.1", "a b c"), "a.off:9", "'a' is no number", "a.off");
  check_refused(replaced(stl_text(), "vertex 2 3 0", "vertex 2 nan 0"), "a.stl:6", "'nan' is not finite", "a.stl");
  for (const float bad : {__builtin_nanf(""), __builtin_inff(), -__builtin_inff()}) {
    std::string raw;
    put(raw, bad, false);
    check_refused(stl_binary().replace(84 + 50 + 12, 4, raw), "a.stl", "face 2 has a coordinate that is not finite",
                  "a.stl");
    const std::string ply = ply_binary<float>(false);
    check_refused(std::string(ply).replace(ply.find("end_header\n") + 11 + 16, 4, raw), "a.ply", "vertex 2", "a.ply");
  }
}

TEST_CASE("indices out of range and faces that lack corners are refused") {
  for (const char* face : {"4 4 5 6 8", "4 4 5 6 -1", "4 4 5 6 4294967300", "4 4 5 6", "-1", "4 4 5 6 7.5"}) {
    INFO(face);
    CHECK(refusal(replaced(kPlyText, "4 4 5 6 7", face), "a.ply").find("a.ply:21|") == 0);
    CHECK(refusal(replaced(kOff, "4 4 5 6 7", face), "a.off").find("a.off:12|") == 0);
  }
  std::string wild = ply_binary<double>(true);
  wild[wild.size() - 1] = 8;
  check_refused(wild, "a.ply", "face 6: a vertex index is 8", "a.ply");
}

TEST_CASE("cut-off, empty and foreign files are refused") {
  check_refused(kPlyText.substr(0, kPlyText.size() - 10), "a.ply:25", "expected", "a.ply");
  check_refused(ply_binary<float>(false).substr(0, ply_binary<float>(false).size() - 1), "a.ply", "expected", "a.ply");
  check_refused(kOff.substr(0, kOff.size() - 20), "a.off:15", "expected", "a.off");
  check_refused(stl_text().substr(0, 100), "a.stl:7", "expected", "a.stl");
  check_refused(stl_binary().substr(0, 600), "a.stl", "684 bytes were expected", "a.stl");
  check_refused("solid nothing\nendsolid nothing\n", "a.stl", "no faces", "a.stl");
  check_refused("OFF\n0 0 0\n", "a.off", "no faces", "a.off");
  check_refused("OFF BINARY\n8 6 0\n", "a.off:1", "text OFF was expected", "a.off");
  check_refused("4OFF\n8 6 0\n", "a.off:1", "OFF in three dimensions", "a.off");
  check_refused("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 1 2\n",
                "a.ply", "element vertex with x, y, z", "a.ply");
  for (const char* name : {"a.ply", "a.stl", "a.off"}) {
    check_refused("", std::string(name) + ":1", "empty", name);
    std::string rubbish;
    for (int i = 0; i < 5000; ++i) rubbish += static_cast<char>((i * 2654435761u) >> 11);
    CHECK(refusal(rubbish, name) != "accepted");
    CHECK(refusal(kBox, name) != "accepted");
    const Folder folder;
    std::filesystem::create_directory(folder.path(name));
    CHECK(refusal_of(folder.path(name)).find("is a folder") != std::string::npos);
  }
}

// Whatever a file holds, it is refused with an input error or gives a mesh that hangs together.
TEST_CASE("files cut at every byte or with any byte changed never crash and never give an unsound mesh") {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.obj", "mtllib m.mtl\nusemtl m\n" + kBox + "vt 0 0\nf 1/1 2/1 \\\n 3/1\nf -1 -2 -3 -4\n"},
      {"a.ply", kPlyText},
      {"a.ply", ply_binary<float>(true)},
      {"a.off", kOff},
      {"a.stl", stl_text().substr(0, 420)},
      {"a.stl", stl_binary()}};
  const Folder folder;
  std::uint32_t random = 12345;
  std::size_t accepted = 0, refused = 0;
  const auto probe = [&](const std::string& name, const std::string& content) {
    folder.write(name, content);
    try {
      const auto mesh = clray::load_mesh(folder.path(name));
      ++accepted;
      REQUIRE(mesh->triangle_slot.size() == mesh->triangles.size());
      REQUIRE(!mesh->triangles.empty());
      for (const auto& t : mesh->triangles) {
        for (const std::uint32_t v : t) REQUIRE(v < mesh->vertices.size());
      }
      for (const std::uint32_t slot : mesh->triangle_slot) REQUIRE(slot < mesh->material_slots.size());
      REQUIRE(mesh->report.area_m2 > 0.0);
      REQUIRE(mesh->report.area_m2 < 1e31);
    } catch (const clray::Error& error) {
      ++refused;
      REQUIRE(error.code() == clray::ErrorCode::input);
    }
  };
  for (const auto& [name, content] : files) {
    for (std::size_t cut = 0; cut < content.size(); cut += 3) probe(name, content.substr(0, cut));
    for (std::size_t at = 0; at < content.size(); ++at) {
      random = random * 1664525u + 1013904223u;
      std::string changed = content;
      changed[at] = at % 2 ? static_cast<char>(random >> 24) : "0-9. \n/eE#\\"[(random >> 24) % 11];
      probe(name, changed);
    }
  }
  CHECK(accepted > 500);
  CHECK(refused > 500);
}
