// SPDX-License-Identifier: Apache-2.0
// MTL libraries: what becomes of Kd, Ks, Ns and illum; what is refused with the library's line; what is a warning.
#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace {

std::shared_ptr<const clray::Mesh> with_mtl(const std::string& mtl, const std::string& before = "usemtl m\n") {
  const Folder folder;
  folder.write("a.mtl", mtl);
  return clray::load_mesh(folder.write("a.obj", "mtllib a.mtl\n" + before + kBox));
}

std::string mtl_refusal(const std::string& mtl) {
  const Folder folder;
  folder.write("a.mtl", mtl);
  return refusal_of(folder.write("a.obj", "mtllib a.mtl\n" + kBox));
}

void check_mtl_refused(const std::string& mtl, const std::string& context, const std::string& words) {
  const std::string found = mtl_refusal(mtl);
  INFO(mtl);
  INFO(found);
  CHECK(found.find(context + "|") == 0);
  CHECK(found.find(words) != std::string::npos);
  CHECK(found.find("expected") != std::string::npos);
}

const clray::Material& only(const clray::Mesh& mesh) {
  REQUIRE(mesh.file_materials.size() == 1);
  return mesh.file_materials[0];
}

}  // namespace

TEST_CASE("Kd and Ks with illum 2 become Ashikhmin-Shirley with the sum as rho and F0") {
  const auto mesh = with_mtl("newmtl m\nKa 1 1 1\nKd 0.1 0.1 0.1\nKs 0.4 0.4 0.4\nNs 50\nd 1\nillum 2\nmap_Ks x.png\n");
  const clray::Material& m = only(*mesh);
  CHECK(m.name == "m");
  CHECK(m.model == "ashikhmin-shirley");
  // (0.1+0.1+0.1)/3 is 0.1 to two units in the last place.
  CHECK(m.parameters.at("rho") == doctest::Approx(0.5).epsilon(1e-15));
  CHECK(m.parameters.at("f0") == m.parameters.at("rho"));
  CHECK(m.parameters.at("d") == doctest::Approx(0.2).epsilon(1e-15));
  CHECK(m.parameters.at("n") == 50.0);
  CHECK(m.two_sided);
  CHECK(mesh->warnings.empty());
}

TEST_CASE("keys may be written in any case") {
  const auto mesh = with_mtl("NEWMTL m\nkd 0.1 0.1 0.1\nKS 0.4\nns 50\nIllum 2\nTR 0\nKe 1 1 1\nke 2 2 2\n");
  const clray::Material& m = only(*mesh);
  CHECK(m.model == "ashikhmin-shirley");
  CHECK(m.parameters.at("rho") == doctest::Approx(0.5).epsilon(1e-15));
  CHECK(m.parameters.at("n") == 50.0);
  CHECK(mesh->warnings.empty());
}

TEST_CASE("a colour is a spectrum of three bands, each at most 1") {
  const auto clamped = with_mtl("newmtl m\nKd 1 0.25 0.625\nKs 0.5\nillum 3\n");
  for (const char* key : {"rho", "f0"}) {
    const clray::Spectrum& s = only(*clamped).spectra.at(key);
    CHECK(s.value == std::vector<double>{1.0, 0.75, 0.75, 1.0});  // blue, green, green, red
    CHECK(s.wavelength_nm.front() == 500.0);
    CHECK(s.wavelength_nm[2] == 600.0);
    CHECK(only(*clamped).parameters.count(key) == 0);
  }
  CHECK(only(*clamped).parameters.at("d") == doctest::Approx(1.875 / 3.375).epsilon(1e-15));  // of the means
  CHECK(only(*clamped).parameters.at("n") == 0.0);
  const auto mirror = with_mtl("newmtl m\nKd 0 0 0\nKs 0.25 0.25 0.25\nNs 1e6\nillum 2\n");
  CHECK(only(*mirror).parameters.at("d") == 0.0);
  CHECK(only(*mirror).parameters.at("n") == 1e6);
}

TEST_CASE("no Ks, or illum below 2 or absent, is Lambert with Kd") {
  for (const char* rest : {"", "Ks 0 0 0\nillum 2\n", "Ks 0.5 0.5 0.5\nillum 1\n", "illum 2\n"}) {
    const auto mesh = with_mtl(std::string("newmtl m\nKd 0.25 0.5 0.75\n") + rest);
    CHECK(only(*mesh).model == "lambert");
    CHECK(only(*mesh).parameters.empty());
    CHECK(only(*mesh).spectra.at("rho").value == std::vector<double>{0.75, 0.5, 0.5, 0.25});
    CHECK(mesh->warnings.empty());
  }
  const auto textured = with_mtl("newmtl m\nKd 0.5\nmap_Kd a.png\n");
  CHECK(only(*textured).parameters == std::map<std::string, double>{{"rho", 0.5}});
  REQUIRE(textured->warnings.size() == 1);
  CHECK(textured->warnings[0].find("a.mtl:1: material 'm' has a texture (map_Kd), which is left out") !=
        std::string::npos);
  const auto absent = with_mtl("newmtl m\nKd 0.5\nKs 0.5\n");
  CHECK(only(*absent).model == "lambert");
  REQUIRE(absent->warnings.size() == 1);
  CHECK(absent->warnings[0].find("a.mtl:1: material 'm' has Ks but no illum") != std::string::npos);
}

TEST_CASE("several materials keep names with spaces, CRLF, comments and indentation") {
  const auto mesh =
      with_mtl("# library\r\nnewmtl white paint # first\r\n\tKd 0.5 0.5 0.5 # grey\r\n\r\nnewmtl b\r\n  Kd 0.25\r\n",
               "usemtl white paint\n");
  REQUIRE(mesh->file_materials.size() == 2);
  CHECK(mesh->file_materials[0].name == "white paint");
  CHECK(mesh->file_materials[0].parameters.at("rho") == 0.5);
  CHECK(mesh->file_materials[1].parameters.at("rho") == 0.25);
  CHECK(mesh->material_slots == std::vector<std::string>{"white paint"});
  CHECK(mesh->warnings.empty());
}

TEST_CASE("malformed lines are refused at the library's line") {
  check_mtl_refused("newmtl m\nKd nan 0 0\n", "a.mtl:2", "'nan' is not finite");
  check_mtl_refused("newmtl m\nKd a b c\n", "a.mtl:2", "'a' is no number");
  check_mtl_refused("newmtl m\nKd 0.5 0.5\n", "a.mtl:2", "one or three values");
  check_mtl_refused("newmtl m\nKd\n", "a.mtl:2", "one or three values");
  check_mtl_refused("newmtl m\nNs x\n", "a.mtl:2", "'x' is no number");
  check_mtl_refused("newmtl m\nillum x\n", "a.mtl:2", "illum");
}

TEST_CASE("a missing library, an unknown material and spectral values are warnings") {
  const Folder folder;
  const auto missing = clray::load_mesh(folder.write("a.obj", "mtllib no.mtl\nusemtl m\n" + kBox));
  REQUIRE(missing->warnings.size() == 1);
  CHECK(missing->warnings[0] == folder.path("a.obj") + ":1: material library 'no.mtl' is missing");
  CHECK(missing->file_materials.empty());
  CHECK(missing->material_slots == std::vector<std::string>{"m"});
  const auto unknown = with_mtl("newmtl other\nKd 0.5\n");
  REQUIRE(unknown->warnings.size() == 1);
  CHECK(unknown->warnings[0].find("a.obj:2: usemtl 'm' is in no material library") != std::string::npos);
  const auto spectral = with_mtl("newmtl m\nKd spectral a.rfl\nKs xyz 1 1 1\n");
  CHECK(spectral->warnings.size() == 2);
  CHECK(with_mtl("# nothing\n", "")->warnings.size() == 1);
}

TEST_CASE("one mtllib line may name several libraries, or one with spaces; a later one overrides") {
  const Folder folder;
  folder.write("a.mtl", "newmtl a\nKd 0.25\n");
  folder.write("b.mtl", "newmtl b\nKd 0.5\nnewmtl a\nKd 0.75\n");
  folder.write("two words.mtl", "newmtl c\nKd 1\n");
  const auto mesh = clray::load_mesh(
      folder.write("x.obj", "mtllib a.mtl b.mtl\nmtllib two words.mtl\nmtllib gone.mtl a.mtl\n" + kBox));
  REQUIRE(mesh->file_materials.size() == 3);
  CHECK(mesh->file_materials[1].parameters.at("rho") == 0.5);
  CHECK(mesh->file_materials[2].parameters.at("rho") == 1.0);
  REQUIRE(mesh->warnings.size() == 2);
  CHECK(mesh->warnings[0].find("'gone.mtl' is missing") != std::string::npos);
  CHECK(mesh->warnings[1].find("x.obj:1: material 'a' comes again in a later library") != std::string::npos);
}
