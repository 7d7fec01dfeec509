// SPDX-License-Identifier: Apache-2.0
// The OBJ reader: every form that it must accept, with areas in closed form. Areas of small integers are exact
// in double; tolerances of 1e-15 relative elsewhere are a few units in the last place of the sum.
#include <clocale>
#include <cmath>
#include <locale>

#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace {

// A comma as decimal point, as in German or French, without needing such a locale to be installed.
struct CommaPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

class CommaLocale {
 public:
  CommaLocale() : before_(std::locale::global(std::locale(std::locale::classic(), new CommaPoint))) {
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"}) {
      if (std::setlocale(LC_NUMERIC, name)) break;
    }
  }
  ~CommaLocale() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
  }

 private:
  std::locale before_;
};

void check_box(const clray::Mesh& mesh) {
  CHECK(mesh.report.faces == 6);
  CHECK(mesh.report.triangles == 12);
  CHECK(mesh.triangles.size() == 12);
  CHECK(mesh.report.area_m2 == 52.0);
  CHECK(mesh.report.boundary_edges == 0);
  CHECK(mesh.report.non_manifold_edges == 0);
  CHECK(mesh.report.degenerate == 0);
  CHECK(volume(mesh) == 24.0);
  CHECK(mesh.warnings.empty());
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

TEST_CASE("a box of quads has its area, volume and closed edges") {
  const auto mesh = load_text(kBox);
  check_box(*mesh);
  CHECK(mesh->vertices.size() == 8);
  CHECK(mesh->material_slots == std::vector<std::string>{""});
  CHECK(mesh->triangle_slot == std::vector<std::uint32_t>(12, 0));
  CHECK(mesh->file_materials.empty());
}

TEST_CASE("line ends LF, CRLF and CR, a byte order mark and a missing last line end change nothing") {
  check_box(*load_text(replaced(kBox, "\n", "\r\n")));
  check_box(*load_text(replaced(kBox, "\n", "\r")));
  check_box(*load_text("\xef\xbb\xbf" + kBox));
  check_box(*load_text(kBox.substr(0, kBox.size() - 1)));
  check_box(*load_text("\n\n  \t\n" + replaced(kBox, "\n", "\n\n")));
}

TEST_CASE("comments, indented and trailing, change nothing, even with a backslash at their end") {
  check_box(*load_text("# a comment\n  # another \\\n" + replaced(kBox, "\n", "  # v 9 9 9 \\\n")));
  check_box(*load_text(replaced(kBox, "\n", "#\n")));
}

TEST_CASE("a backslash continues a line, inside numbers' lists only") {
  std::string text = replaced(kBox, "f ", "f \\\n ");
  text = replaced(text, "v ", "v\\\r\n\t");
  check_box(*load_text(text));
}

TEST_CASE("corners as v/vt, v//vn and v/vt/vn") {
  const std::string extra = "vt 0 0\nvn 0 0 1\n";
  for (const char* suffix : {"/1", "//1", "/1/1", "/-1/-1", "//-1"}) {
    std::string faces = kBox.substr(kBoxVertices.size());
    for (const char digit : std::string("12345678")) {
      faces = replaced(faces, std::string(" ") + digit, std::string(" @") + digit + suffix);
    }
    check_box(*load_text(kBoxVertices + extra + replaced(faces, "@", "")));
  }
}

TEST_CASE("negative indices count back from the last vertex so far") {
  const auto mesh = load_text("v 0 0 0\nv 3 0 0\nv 0 4 0\nf -3 -2 -1\nv 9 9 9\nv 0 0 1\nf 1 2 -1\nf -5 -4 -1\n");
  CHECK(mesh->triangles[0] == std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(mesh->triangles[1] == std::array<std::uint32_t, 3>{0, 1, 4});
  CHECK(mesh->triangles[2] == std::array<std::uint32_t, 3>{0, 1, 4});
  CHECK(mesh->report.area_m2 == 6.0 + 1.5 + 1.5);
}

TEST_CASE("faces before their vertices are accepted") {
  check_box(*load_text(kBox.substr(kBoxVertices.size()) + kBoxVertices));
}

TEST_CASE("coordinates are read in double, correctly rounded, in every notation") {
  const auto mesh = load_text(
      "v 0.1 +2.5e-1 -1E3\nv 1. .5 12345678.901234567\nv 1e-400 -0 4.9406564584124654e-324\nv 1 0 0\nf 1 2 3\n");
  CHECK(mesh->vertices[0] == clray::Vec3(0.1, 0.25, -1000.0));
  CHECK(mesh->vertices[1] == clray::Vec3(1.0, 0.5, 12345678.901234567));
  CHECK(mesh->vertices[2].x == 0.0);
  CHECK(mesh->vertices[2].z == 4.9406564584124654e-324);
}

TEST_CASE("w and colours after x y z are tolerated") {
  for (const char* extra : {" 1", " 0.5 0.5 0.5", " 1 0.5 0.25 1"}) {
    const std::string vertices = replaced(kBoxVertices, "\n", std::string(extra) + "\n");
    check_box(*load_text(vertices + kBox.substr(kBoxVertices.size())));
  }
}

TEST_CASE("the length unit scales coordinates and area") {
  const Folder folder;
  const auto mesh = clray::load_mesh(folder.write("a.obj", kBox), 0.5);
  CHECK(mesh->report.area_m2 == 13.0);
  CHECK(mesh->vertices[6] == clray::Vec3(1.0, 1.5, 2.0));
  for (const double unit : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    CHECK_THROWS_AS(clray::load_mesh(folder.path("a.obj"), unit), clray::Error);
  }
}

TEST_CASE("a locale with a decimal comma changes nothing") {
  const std::string text = replaced(replaced(kBox, "v 2 3 4", "v 2.000 3.0 4.0"), "v 0 0 0", "v 0.0 0.0 0.0");
  const CommaLocale comma;
  check_box(*load_text(text));
  const auto mesh = load_text("v 1234.5 0.25 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(mesh->vertices[0] == clray::Vec3(1234.5, 0.25, 0.0));
}

TEST_CASE("groups, objects and smoothing are ignored silently; curves, lines and strangers with one warning each") {
  check_box(*load_text("o box\ng a b\ns off\ns 1\nmg 0\nlod 1\n" + kBox));
  const auto mesh = load_text(kBox + "l 1 2\nl 2 3\np 1\ncurv 0 1 1 2 \\\n 3 4\ncstype bezier\n");
  CHECK(mesh->report.area_m2 == 52.0);
  REQUIRE(mesh->warnings.size() == 4);
  CHECK(mesh->warnings[0].find("a.obj:20: statement 'cstype' is left out") != std::string::npos);
  CHECK(mesh->warnings[1].find("a.obj:18: statement 'curv'") != std::string::npos);
  CHECK(mesh->warnings[2].find("a.obj:15: statement 'l' is left out (2 in all)") != std::string::npos);
}

TEST_CASE("usemtl makes slots of the materials in use, in order of their first face") {
  const auto mesh = load_text(kBoxVertices +
                              "f 1 4 3 2\nusemtl unused\nusemtl panel with spaces  # comment\nf 5 6 7 8\nf 1 2 6 5\n"
                              "usemtl foil\nf 3 4 8 7\nusemtl panel with spaces\nf 2 3 7 6 \n");
  CHECK(mesh->material_slots == std::vector<std::string>{"", "panel with spaces", "foil"});
  CHECK(mesh->triangle_slot == std::vector<std::uint32_t>{0, 0, 1, 1, 1, 1, 2, 2, 1, 1});
  REQUIRE(mesh->warnings.size() == 2);
  CHECK(mesh->warnings[0].find("a.obj:11: usemtl 'panel with spaces' is in no material library") != std::string::npos);
}

TEST_CASE("flipped, duplicate, open and non-manifold faces are kept with all their area") {
  const auto flipped = load_text(replaced(kBox, "f 5 6 7 8", "f 8 7 6 5"));
  CHECK(flipped->report.area_m2 == 52.0);
  CHECK(flipped->report.non_manifold_edges == 4);
  CHECK(flipped->report.boundary_edges == 0);
  const auto doubled = load_text(kBox + "f 5 6 7 8\nf 8 7 6 5\n");
  CHECK(doubled->report.area_m2 == 52.0 + 2 * 6.0);
  CHECK(doubled->report.faces == 8);
  CHECK(doubled->triangles.size() == 16);
  CHECK(doubled->report.non_manifold_edges == 4);
  const auto open = load_text(replaced(kBox, "f 5 6 7 8\n", ""));
  CHECK(open->report.area_m2 == 46.0);
  CHECK(open->report.boundary_edges == 4);
  // Three wings on one edge, and a bow of two triangles on one vertex.
  const auto fan = load_text("v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
  CHECK(fan->report.area_m2 == 1.5);
  CHECK(fan->report.non_manifold_edges == 1);
  CHECK(fan->report.boundary_edges == 6);
  const auto bow = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 -1 0\nf 1 2 3\nf 1 4 5\n");
  CHECK(bow->report.area_m2 == 1.0);
  CHECK(bow->report.non_manifold_edges == 0);
  CHECK(bow->report.boundary_edges == 6);
}

TEST_CASE("degenerate faces are kept and counted") {
  const auto mesh = load_text(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.1 0.1 0\nv 0.2 0.2 0\nv 0.3 0.3 0\n"
      "f 1 2 3\nf 1 1 2\nf 4 5 6\nf 1 1 1\n");
  CHECK(mesh->triangles.size() == 4);
  CHECK(mesh->report.degenerate == 3);
  CHECK(mesh->report.area_m2 == doctest::Approx(0.5).epsilon(1e-15));
  // A thin triangle that is no rounding error stays out of the count.
  CHECK(load_text("v 0 0 0\nv 1 0 0\nv 0.5 1e-12 0\nf 1 2 3\n")->report.degenerate == 0);
}
