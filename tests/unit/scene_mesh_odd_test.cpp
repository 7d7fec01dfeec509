// SPDX-License-Identifier: Apache-2.0
// Mesh files that bend their format where it does not matter: read, with one warning where something is left out or
// guessed, and with no warning where nothing is. All hold one square of side 2, area 4, in two triangles.
#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace {

const std::string kSquare = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";  // lines 1-4

/// The square is read whole with exactly these warnings (parts of them, in order).
std::shared_ptr<const clray::Mesh> check_square(const std::string& content, const std::string& name,
                                                const std::vector<std::string>& warnings = {}) {
  INFO(content);
  const auto mesh = load_text(content, name);
  CHECK(mesh->report.area_m2 == 4.0);
  CHECK(mesh->report.faces == (name == "a.stl" ? 2 : 1));
  CHECK(mesh->triangles.size() == 2);
  CHECK(mesh->report.boundary_edges == 4);
  REQUIRE(mesh->warnings.size() == warnings.size());
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    INFO(mesh->warnings[i]);
    CHECK(mesh->warnings[i].find(warnings[i]) != std::string::npos);
  }
  return mesh;
}

/// The square with material(s) from a library; `before` stands in front of its two triangles.
std::shared_ptr<const clray::Mesh> with_library(const std::string& library, const std::string& first,
                                                const std::string& second = "",
                                                const std::vector<std::string>& warnings = {}) {
  const Folder folder;
  folder.write("a.mtl", library);
  const auto mesh =
      clray::load_mesh(folder.write("a.obj", "mtllib a.mtl\n" + kSquare + first + "f 1 2 3\n" + second + "f 1 3 4\n"));
  INFO(library);
  CHECK(mesh->report.area_m2 == 4.0);
  REQUIRE(mesh->warnings.size() == warnings.size());
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    INFO(mesh->warnings[i]);
    CHECK(mesh->warnings[i].find(warnings[i]) != std::string::npos);
  }
  return mesh;
}

double rho(const clray::Mesh& mesh, const std::string& name) {
  for (const clray::Material& m : mesh.file_materials) {
    if (m.name != name) continue;
    if (m.spectra.count("rho") == 0) return m.parameters.at("rho");
    const std::vector<double>& bgr = m.spectra.at("rho").value;  // blue, green twice, red
    return (bgr[0] + bgr[1] + bgr[3]) / 3.0;
  }
  FAIL("no material " << name);
  return 0.0;
}

std::string stl(const std::string& first, const std::string& last, bool upper = false) {
  std::string text = first +
                     "facet normal nan 0 1\n outer loop\n  vertex 0 0 0\n  vertex 2 0 0\n  vertex 2 2 0\n endloop\n"
                     "endfacet\nfacet\n outer loop\n  vertex 0 0 0\n  vertex 2 2 0\n  vertex 0 2 0\n end loop\n"
                     "end facet\n" +
                     last;
  if (upper) {
    for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return text;
}

std::string binary_stl(const std::string& tail, std::uint32_t count = 2) {
  std::string bytes(80, 'x');
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(count >> 8 * i & 0xff);
  const float points[2][9] = {{0, 0, 0, 2, 0, 0, 2, 2, 0}, {0, 0, 0, 2, 2, 0, 0, 2, 0}};
  for (const auto& facet : points) {
    bytes.append(12, '\xff');  // a normal that is not a number
    bytes.append(reinterpret_cast<const char*>(facet), sizeof facet);
    bytes.append(2, '\7');
  }
  return bytes + tail;
}

std::string ply(const std::string& strange, const std::string& body = "0 0 0\n2 0 0\n2 2 0\n0 2 0\n4 0 1 2 3\n",
                const std::string& faces = "1") {
  return "ply\nformat ascii 1.0\n" + strange +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

}  // namespace

TEST_CASE("OBJ corners with empty texture and normal parts are read") {
  for (const std::string suffix : {"/", "//", "/1/", "/1", "//1", "/1/1"}) {
    std::string face = "vt 0 0\nvn 0 0 1\nf";
    for (const char* v : {" 1", " 2", " 3", " 4"}) face += v + suffix;
    check_square(kSquare + face + "\n", "a.obj");
  }
}

TEST_CASE("OBJ indices of normals and texture points that are not there are one warning each") {
  check_square(kSquare + "f 1//1 2//2 3//3 4//4\n", "a.obj", {"a.obj:5: normal index '4' leads nowhere"});
  check_square(kSquare + "vn 0 0 1\nf 1//1 2//1 3//2 4//1\n", "a.obj", {"a.obj:6: normal index '2'"});
  check_square(kSquare + "f 1/0/1 2/-1/1 3/9/1 4/99999999999999999999/1\nvn 0 0 1\n", "a.obj",
               {"a.obj:5: texture coordinate index '0' leads nowhere, the file holds 0"});
  check_square(kSquare + "f 1//-2 2//1 3//1 4//1\nvn 0 0 1\n", "a.obj", {"a.obj:5: normal index '-2'"});
  // Both kinds, and indices that come before what they name: no warning for those.
  check_square(kSquare + "f 1/1/1 2/1/1 3/1/1 4/1/2\nvt 0 0\nvn 0 0 1\nvn 0 0 1\n", "a.obj");
}

TEST_CASE("faces of fewer than three corners are left out with one warning") {
  check_square(kSquare + "f 1 2\nf 1 2 3 4\nf 1\nf\n", "a.obj",
               {"a.obj:5: a face with fewer than three corners is left out (3 in all)"});
  check_square("OFF\n4 3 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n2 0 1\n4 0 1 2 3\n0\n", "a.off",
               {"a.off:7: a face with fewer than three corners is left out (2 in all)"});
  check_square(ply("", "0 0 0\n2 0 0\n2 2 0\n0 2 0\n2 0 1\n4 0 1 2 3\n1 0\n", "3"), "a.ply",
               {"a.ply:14: a face with fewer than three corners is left out (2 in all)"});
  check_refused(kSquare + "f 1 2\nf 3 4\n", "a.obj:7", "no faces");
  check_refused("OFF\n2 1 0\n0 0 0\n2 0 0\n2 0 1\n", "a.off", "no faces", "a.off");
}

TEST_CASE("an OFF count glued to its keyword, keywords in any case, colours that are no numbers") {
  const std::string body = "0 0 0 grey\n2 0 0\n2 2 0 nan\n0 2 0\n4 0 1 2 3 0xff\n";
  for (const char* head : {"OFF4 1 0\n", "OFF 4 1\n", "off\n4 1 0\n", "COFF4 1 0\n", "STOFF\n4 1 0\n", "NOFF 4 1 0\n"})
    check_square(head + body, "a.off");
  check_square("OFF4 1 0\n" + body + "# the end\n\n4 0 1 2 3\n", "a.off", {"a.off:9: what follows the last"});
  check_refused("OFFX4 1 0\n" + body, "a.off:1", "OFF in three dimensions", "a.off");
  check_refused("4OFF\n4 1 0\n" + body, "a.off:1", "OFF in three dimensions", "a.off");
}

TEST_CASE("STL text with keywords in any case, in two words, blanks in front and no endsolid") {
  for (const char* last : {"endsolid x\n", "endsolid\n", "end solid x\n", "END SOLID", "ENDSOLID x\n", "", "\n\n"}) {
    for (const char* first :
         {"solid x\n", "  solid x\n", "\n\n\tsolid\n", "SOLID x\n", "Solid a # b\n", "\xef\xbb\xbfsolid x\n"}) {
      INFO(first << last);
      check_square(stl(first, last), "a.stl");
      if (first[0] != '\xef') check_square(stl(first, last, true), "a.stl");
    }
  }
  const std::string whole = stl("solid x\n", "");
  check_refused(whole.substr(0, whole.size() - 10), "a.stl:15", "'endfacet' was expected", "a.stl");
  check_refused("solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "a.stl:6", "'vertex' was expected",
                "a.stl");
}

TEST_CASE("STL: bytes behind the facets that the header counts are one warning; too few are refused") {
  check_square(binary_stl(""), "a.stl");
  check_square(binary_stl("abcd"), "a.stl", {"a.stl: 4 bytes follow the 2 faces"});
  check_square(binary_stl(std::string(100, '\0')), "a.stl", {"a.stl: 100 bytes follow the 2 faces"});
  std::string solid = binary_stl("\1\2");
  solid.replace(0, 6, "solid ");
  check_square(solid, "a.stl", {"2 bytes follow"});
  check_refused(binary_stl("abcd", 3), "a.stl", "234 bytes were expected", "a.stl");
}

TEST_CASE("PLY: header lines without a keyword are taken as comments, misspelt keywords are refused") {
  check_square(ply("Created by Blender3D 247 - www.blender.org, source file: \n"), "a.ply",
               {"a.ply:3: header line 'Created' is taken as a comment"});
  check_square(ply("VCGLIB generated\nmade in 1999\n"), "a.ply",
               {"a.ply:3: header line 'VCGLIB' is taken as a comment (2 in all)"});
  check_refused(ply("propert uchar red\n"), "a.ply:3", "did you mean 'property'?", "a.ply");
  check_refused(ply("Element edge 1\n"), "a.ply:3", "did you mean 'element'?", "a.ply");
}

TEST_CASE("PLY: what is not used need not be a number; what follows the last element is one warning") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "nx\n"
      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  check_square(head + "0 0 0 nan 256\n2 0 0 -inf -1\n2 2 0 1e400 0.5\n0 2 0 x y\n4 0 1 2 3\n", "a.ply");
  check_refused(head + "0 0 0 nan\n2 0 0 0 0\n2 2 0 0 0\n0 2 0 0 0\n4 0 1 2 3\n", "a.ply:12", "the line ends", "a.ply");
  check_square(ply("") + "4 0 1 2 3\n", "a.ply", {"a.ply:15: what follows the last"});
  std::string bytes = ply("");
  bytes = bytes.substr(0, bytes.find("end_header\n") + 11);
  bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
  const float points[12] = {0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
  const std::int32_t corners[4] = {0, 1, 2, 3};
  bytes.append(reinterpret_cast<const char*>(points), sizeof points);
  bytes += '\4';
  bytes.append(reinterpret_cast<const char*>(corners), sizeof corners);
  check_square(bytes, "a.ply");
  check_square(bytes + "123", "a.ply", {"a.ply: 3 bytes follow the last element"});
}

TEST_CASE("PLY: strips of triangles are triangles that look to one side") {
  const std::string points = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n";
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list int int vertex_indices\n";
  // Two squares as one strip, then as two strips of one list; a repeated corner turns the direction of a strip.
  const std::pair<const char*, double> cases[] = {
      {"6 0 1 2 3 4 5\n", 2.0}, {"9 0 1 2 3 -1 2 3 4 5\n", 2.0}, {"9 0 1 2 3 3 2 2 3 4\n", 1.5}};
  for (const auto& one : cases) {
    const auto& strips = one.first;
    const auto& area = one.second;
    CAPTURE(strips);
    const Folder folder;
    const auto mesh = clray::load_mesh(
        folder.write("a.ply", head + "element tristrips 1\n" + list + "end_header\n" + points + strips));
    for (const auto& t : mesh->triangles) {
      const clray::Vec3 a = mesh->vertices[t[0]], b = mesh->vertices[t[1]], c = mesh->vertices[t[2]];
      CHECK((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) == -1.0);  // all turn right, as the first
    }
    CHECK(mesh->report.area_m2 == area);
    CHECK(mesh->warnings.empty());
  }
  const Folder folder;
  CHECK(refusal_of(folder.write("p.ply", head + "end_header\n" + points)) ==
        "p.ply|points without faces; an element face with a list vertex_indices was expected");
  CHECK(refusal_of(folder.write("b.ply", head + "element tristrips 1\n" + list + "end_header\n" + points + "3 0 1 6\n"))
            .find("an integer from -1 to 5") != std::string::npos);
}

TEST_CASE("what is not used may be no number or too much; what counts may not") {
  check_square("v 0 0 0 nan nan nan\nv 2 0 0 1 inf 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n", "a.obj",
               {"a.obj:1: 'nan' as w or a colour of a vertex is not finite; it is not used (4 in all)"});
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string points = "end_header\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n";
  check_square(head + "property uchar red\n" + points + "4 0 1 2 3 9 1 1\n", "a.ply",
               {"a.ply:15: '1' follows the properties that the header names; left out"});
  const Folder folder;
  CHECK(refusal_of(folder.write("a.ply", head + points + "3 0 1 2 3\n")).find("follows a complete face") !=
        std::string::npos);
  check_square("OFF\n4 1 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n4 0\n1 2\n\n3\n", "a.off",
               {"a.off:7: a face goes on over several lines"});
  CHECK(refusal_of(folder.write("a.off", "OFF\n4 2 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n4 0 1 2\n3 0 1 2\n"))
            .find("a.off:7|the line ends where a vertex index was expected") == 0);
  CHECK(refusal_of(folder.write("a.obj", std::string("\xfe\xff\0v", 4))) ==
        "a.obj:1|text in UTF-16; save it as UTF-8, which was expected");
}

TEST_CASE("STL text keeps doubles, and equal corners become one vertex whatever the sign of their zeros") {
  const auto mesh = load_text(
      "solid\nfacet\nouter loop\nvertex 0.1 -0 0\nvertex 1.1 0 0\nvertex 1.1 1 0\nendloop\nendfacet\n"
      "facet\nouter loop\nvertex 0.1 0 -0.0\nvertex 1.1 1 0\nvertex 0.1 1 0\nendloop\nendfacet\n",
      "a.stl");
  CHECK(mesh->vertices.size() == 4);
  CHECK(mesh->vertices[0].x == 0.1);
  CHECK(mesh->report.boundary_edges == 4);
}

TEST_CASE("MTL: a material without Kd is the default surface, never black") {
  for (const std::string keys : {"map_Kd tex.png\nillum 1\n", "Pr 0.4\nPm 0.0\nmap_Pr a.png\n", "", "Ka 1 1 1\n",
                                 "Ks 0.5 0.5 0.5\n", "Ks 0 0 0\nillum 2\n"}) {
    const auto mesh = with_library("newmtl m\n" + keys, "usemtl m\n", "",
                                   {"a.mtl:1: material 'm' has no Kd: taken as Lambert with rho 0.5"});
    CHECK(rho(*mesh, "m") == 0.5);
    CHECK(mesh->file_materials[0].model == "lambert");
  }
  CHECK(rho(*with_library("newmtl m\nKd 0 0 0\n", "usemtl m\n"), "m") == 0.0);  // black if the file says so
  const auto two = with_library("newmtl m\nmap_Kd a\nnewmtl n\nmap_Kd b\n", "usemtl m\n", "usemtl n\n",
                                {"material 'm' has no Kd: taken as Lambert with rho 0.5 (2 in all)"});
  CHECK(rho(*two, "n") == 0.5);
  // Ks alone, with illum 2, is a surface that only shines.
  CHECK(with_library("newmtl m\nKs 0.5 0.5 0.5\nillum 2\n", "usemtl m\n")->file_materials[0].parameters.at("d") == 0.0);
}

TEST_CASE("MTL names may hold a '#'; a comment behind a name changes nothing") {
  const auto numbers = with_library("newmtl Material #25\nKd 0.75\nnewmtl Material #26\nKd 0.25\n",
                                    "usemtl Material #25\n", "usemtl Material #26\n");
  CHECK(numbers->material_slots == std::vector<std::string>{"Material #25", "Material #26"});
  CHECK(rho(*numbers, "Material #25") == 0.75);
  CHECK(rho(*numbers, "Material #26") == 0.25);
  const auto glued = with_library("newmtl #1\nKd 0.75\nnewmtl a#b\nKd 0.25\n", "usemtl #1\n", "usemtl a#b\n");
  CHECK(rho(*glued, "#1") == 0.75);
  CHECK(rho(*glued, "a#b") == 0.25);
  const auto spaced = with_library("newmtl Paint # 5\nKd 0.75\nnewmtl Paint # 6\nKd 0.25\n", "usemtl Paint # 5\n",
                                   "usemtl Paint # 6\n");
  CHECK(rho(*spaced, spaced->material_slots[0]) == 0.75);
  CHECK(rho(*spaced, spaced->material_slots[1]) == 0.25);
  for (const std::string in_library : {"foil", "foil # bright", "foil #bright", "foil #"}) {
    for (const std::string in_mesh : {"foil", "foil # dull", "foil #dull", "foil  # \\"}) {
      // Where both names hold a glued '#', they are two names.
      if (in_library.find("#b") != std::string::npos && in_mesh.find("#d") != std::string::npos) continue;
      INFO(in_library << " | " << in_mesh);
      const auto mesh =
          with_library("newmtl " + in_library + "\nKd 0.25\n", "usemtl " + in_mesh + "\n", "usemtl foil\n");
      REQUIRE(mesh->material_slots.size() == 1);
      CHECK(rho(*mesh, mesh->material_slots[0]) == 0.25);
    }
  }
  // Another number is another material.
  const auto other = with_library("newmtl Material #25\nKd 0.75\n", "usemtl Material #27\n", "",
                                  {"usemtl 'Material #27' is in no material library"});
  CHECK(other->material_slots == std::vector<std::string>{"Material #27"});
}

TEST_CASE("MTL: a material twice, values out of range and strange illum are one warning a kind") {
  CHECK(rho(*with_library("newmtl m\nKd 0.25\nnewmtl m\nKd 0.75\n", "usemtl m\n", "",
                          {"a.mtl:3: material 'm' is defined again; the last definition is used"}),
            "m") == 0.75);
  CHECK(rho(*with_library("newmtl m\nKd 1.000001 0.8 0.6\n", "usemtl m\n", "", {"a.mtl:2: Kd of 'm' is outside [0,1]"}),
            "m") == doctest::Approx(0.8).epsilon(1e-15));
  CHECK(rho(*with_library("newmtl m\nKd -0.5 0.5 1\n", "usemtl m\n", "", {"Kd of 'm' is outside [0,1]"}), "m") == 0.5);
  const auto shiny = with_library("newmtl m\nNs -1.96\nKd 0.25\nKs 0.25\nillum 2\n", "usemtl m\n", "",
                                  {"a.mtl:2: Ns of 'm' is outside [0,1e6]"});
  CHECK(shiny->file_materials[0].parameters.at("n") == 0.0);
  const auto most = with_library("newmtl m\nNs 1e7\nKd 0.25\nKs 2 0 0\nillum 2\n", "usemtl m\n", "",
                                 {"a.mtl:2: Ns of 'm' is outside [0,1e6] and taken to its nearer end (2 in all)",
                                  "Kd + Ks of material 'm' are above 1"});
  CHECK(most->file_materials[0].parameters.at("n") == 1e6);
  CHECK(most->file_materials[0].spectra.at("rho").value == std::vector<double>{0.25, 0.25, 0.25, 1.0});
  const auto bright = with_library("newmtl m\nKd 0.75\nKs 0.75\nillum 2\n", "usemtl m\n", "",
                                   {"a.mtl:1: Kd + Ks of material 'm' are above 1 and taken as 1"});
  CHECK(rho(*bright, "m") == 1.0);
  with_library("newmtl m\nKd 0.5\nillum 11\n", "usemtl m\n", "", {"illum of material 'm' is none of 0 to 10"});
  CHECK(
      rho(*with_library("Kd 1\nnewmtl m\nKd 0.5\n", "usemtl m\n", "", {"a.mtl:1: 'Kd' before any newmtl is left out"}),
          "m") == 0.5);
  with_library("", "usemtl m\n", "", {"the material library defines no material"});
}

TEST_CASE("MTL: a transparent material is opaque, with one warning") {
  for (const char* keys : {"d 0\nTr 1\n", "d 0.5\n", "Tr 0.5\n", "d -halo 0.5\n", "Tr 1\n", "Tr 0\nd 0.0\n"}) {
    const auto mesh = with_library(std::string("newmtl m\nKd 0.25\n") + keys, "usemtl m\n", "",
                                   {"a.mtl:1: material 'm' is transparent (d or Tr): taken as opaque"});
    CHECK(rho(*mesh, "m") == 0.25);
  }
  for (const char* keys : {"d 1\n", "Tr 0\n", "d 1.0\nTr 0.0\n", "d 1\nTr 1\n", "d x\n"})  // some write Tr for d
    with_library(std::string("newmtl m\nKd 0.25\n") + keys, "usemtl m\n");
}

TEST_CASE("newmtl and usemtl without a name mean each other, with one warning") {
  const auto pair = with_library("newmtl \nKd 0.25\n", "usemtl \n", "", {"a.mtl:1: newmtl without a name"});
  CHECK(rho(*pair, pair->material_slots[0]) == 0.25);
  const auto unused = with_library("newmtl # none\nKd 0.25\n", "", "", {"a.mtl:1: newmtl without a name"});
  CHECK(unused->material_slots == std::vector<std::string>{""});  // no usemtl: no material
  check_square(kSquare + "usemtl \nf 1 2 3 4\n", "a.obj", {"a.obj:5: usemtl without a name"});
  check_square(kSquare + "usemtl # none\nf 1 2 3 4\n", "a.obj", {"a.obj:5: usemtl without a name"});
  check_square(kSquare + "mtllib\nf 1 2 3 4\n", "a.obj", {"a.obj:5: mtllib without a name is left out"});
}

TEST_CASE("a library that is named many times is read once") {
  const Folder folder;
  folder.write("a.mtl", "newmtl m\nNs -1\nKd 0.25\n");
  std::string text = kSquare;
  for (int i = 0; i < 180; ++i) text += i % 2 ? "mtllib a.mtl\n" : "mtllib ./a.mtl\n";
  const auto mesh = clray::load_mesh(folder.write("a.obj", text + "usemtl m\nf 1 2 3 4\n"));
  CHECK(mesh->file_materials.size() == 1);
  REQUIRE(mesh->warnings.size() == 1);
  CHECK(mesh->warnings[0].find("a.mtl:2: Ns of 'm'") != std::string::npos);
  CHECK(mesh->warnings[0].find("in all") == std::string::npos);
}
