// SPDX-License-Identifier: Apache-2.0
// What the OBJ reader must refuse, at which line and with which words; and that nothing outside the folder of an
// OBJ file is ever read.
#include <sys/stat.h>

#include "scene_mesh_files.hpp"

using namespace mesh_test;

namespace fs = std::filesystem;

namespace {
const std::string kThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";  // lines 1-3
}

TEST_CASE("indices that are 0, beyond, before, wrapping or no integers are refused with their line") {
  check_refused(kThree + "f 0 1 2\n", "a.obj:4", "vertex index 0");
  check_refused(kThree + "f 1 2 3\nf 1 2 4\n", "a.obj:5", "vertex index 4 is beyond the last; 1 to 3");
  check_refused(kThree + "f 1 2 -4\n", "a.obj:4", "'-4' goes back beyond the first of 3");
  check_refused(kThree + "f 1 2 4294967297\n", "a.obj:4", "4294967297");
  check_refused(kThree + "f 1 2 4294967299\n", "a.obj:4", "4294967299");
  check_refused(kThree + "f 1 2 -4294967293\n", "a.obj:4", "-4294967293");
  check_refused(kThree + "f 1 2 18446744073709551617\n", "a.obj:4", "beyond all");
  check_refused(kThree + "f 1 2 -9223372036854775808\n", "a.obj:4", "goes back");
  check_refused(kThree + "f 1 2 3.0\n", "a.obj:4", "'3.0' is no corner");
  check_refused(kThree + "f 1 2 x\n", "a.obj:4", "'x' is no corner");
  for (const char* corner : {"/1", "1/1/1/1", "1//1/", "//", "//1", "1/x", "1/1/1.5", "/"}) {
    check_refused(kThree + "vt 0 0\nvn 0 0 1\nf 2 3 " + corner + "\n", "a.obj:6", "is no corner of a face");
  }
}

TEST_CASE("coordinates that are no finite numbers are refused with their line") {
  check_refused("v a b c\n", "a.obj:1", "'a' is no number");
  check_refused("v 0 0 0\nv 1 2 3x\n", "a.obj:2", "'3x' is no number");
  check_refused("v 0 nan 0\n", "a.obj:1", "'nan' is not finite");
  check_refused("v 0 -inf 0\n", "a.obj:1", "'-inf' is not finite");
  check_refused("v 0 0 Infinity\n", "a.obj:1", "is not finite");
  check_refused("v 1e400 0 0\n", "a.obj:1", "'1e400' is too large");
  check_refused("v 1" + std::string(400, '0') + " 0 0\n", "a.obj:1", "is too large");
  check_refused("v 1e99999999999999999999 0 0\n", "a.obj:1", "is too large");
  check_refused("v 0x10 0 0\n", "a.obj:1", "is no number");
  check_refused("v 1,5 0 0\n", "a.obj:1", "'1,5' is no number");
  check_refused("v +-1 0 0\n", "a.obj:1", "is no number");
  check_refused("v 0 0 0 bad\n", "a.obj:1", "'bad' is no number");
  check_refused("v 1 2 3 4 5 6 7 8\n", "a.obj:1", "more than seven values");
  check_refused("v 1e200 0 0\nv 0 0 0\nv 0 1e200 0\nf 1 2 3\n", "a.obj", "beyond 1e15 m");
}

TEST_CASE("truncated lines are refused with their line") {
  check_refused("v 0 0 0\nv 1 2", "a.obj:2", "the line ends where z of a vertex");
  check_refused("v\n", "a.obj:1", "x of a vertex");
  check_refused("v 0 \\\n 0 \\\n x\n", "a.obj:3", "'x'");
  check_refused(kThree + "f 1 2", "a.obj:4", "no faces");
  check_refused(kThree + "f 1 2 \\\n 4\n", "a.obj:5", "vertex index 4");
}

TEST_CASE("files without faces, without area, empty or of binary rubbish are refused") {
  check_refused(kThree, "a.obj:4", "no faces");
  check_refused("# only a comment", "a.obj:1", "no faces");
  check_refused("", "a.obj:1", "the file is empty");
  check_refused(kThree + "f 1 1 1\n", "a.obj", "without area");
  check_refused(std::string("v 0 0 0\n\0\1\2", 11), "a.obj:2", "binary data");
  check_refused("\x89PNG\r\n\x1a\nrubbish", "a.obj:1", "is no OBJ statement");
  std::string rubbish;
  for (int i = 0; i < 4096; ++i) rubbish += static_cast<char>((i * 2654435761u) >> 13);
  CHECK(refusal(rubbish) != "accepted");
  check_refused("<html>\n", "a.obj:1", "is no OBJ statement");
  check_refused("\xff\xfev\0 \0", "a.obj:1", "expected");
}

TEST_CASE("directories, missing and unreadable files and other extensions are refused") {
  const Folder folder;
  fs::create_directory(folder.path("d.obj"));
  CHECK(refusal_of(folder.path("d.obj")) == "d.obj|is a folder; a file was expected");
  CHECK(refusal_of(folder.path("none.obj")).find("No such file") != std::string::npos);
  CHECK(refusal_of(folder.write("a.xyz", "v")).find(".obj, .ply, .stl or .off was expected") != std::string::npos);
  CHECK(refusal_of(folder.write("a.gltf", "{}")) ==
        "a.gltf|.gltf is a 3D scene; export it as OBJ, for example with Blender or 'assimp export model model.obj'; "
        ".obj, "
        ".ply, .stl or .off was expected");
  for (const char* name : {"A.STEP", "a.obj.gz", "a.tab", "a.3ds", "a.dae"}) {
    INFO(name);
    CHECK(refusal_of(folder.write(name, "x")).find("the extension") == std::string::npos);
    CHECK_THROWS_AS(clray::load_scene(folder.path(name)), clray::Error);
  }
  REQUIRE(::mkfifo(folder.path("p.obj").c_str(), 0600) == 0);
  CHECK(refusal_of(folder.path("p.obj")).find("regular file was expected") != std::string::npos);
  fs::create_symlink("loop.obj", folder.path("loop.obj"));
  CHECK(refusal_of(folder.path("loop.obj")).find("cannot be read") != std::string::npos);
  const std::string locked = folder.write("locked.obj", kBox);
  REQUIRE(::chmod(locked.c_str(), 0) == 0);
  REQUIRE(::chmod(folder.path().c_str(), 0755) == 0);
  // Root may read anything, so the check is made as nobody.
  const bool root = ::geteuid() == 0;
  if (root) REQUIRE(::seteuid(65534) == 0);
  const std::string found = refusal_of(locked);
  if (root) REQUIRE(::seteuid(0) == 0);
  CHECK(found.find("locked.obj|cannot be read: Permission denied") == 0);
}

TEST_CASE("a material library outside the folder of the OBJ file is never read") {
  const Folder folder;
  fs::create_directory(folder.path("in"));
  folder.write("out.mtl", "newmtl secret\nKd x x x\n");  // reading it would be an error
  folder.write("in/good.mtl", "newmtl good\nKd 0.25 0.25 0.25\n");
  fs::create_symlink(folder.path("out.mtl"), folder.path("in/link.mtl"));
  fs::create_directory_symlink(folder.path(), folder.path("in/up"));
  const std::string absolute = folder.path("out.mtl");
  for (const std::string& name :
       {std::string("../out.mtl"), std::string("../../etc/passwd"), std::string("/etc/passwd"), std::string("link.mtl"),
        std::string("up/out.mtl"), std::string("./../out.mtl"), std::string("..\\out.mtl"), absolute,
        std::string("../missing.mtl"), std::string("up/link.mtl"), std::string(".."), std::string("/")}) {
    const auto mesh = clray::load_mesh(folder.write("in/a.obj", "mtllib " + name + "\n" + kBox));
    INFO(name);
    CHECK(mesh->file_materials.empty());
    REQUIRE(mesh->warnings.size() == 1);
    CHECK(mesh->warnings[0] == folder.path("in/a.obj") + ":1: material library '" + name.substr(0, 40) +
                                   (name.size() > 40 ? "…'" : "'") + " is missing");
  }
  // Roundabout names that stay inside are fine, also where the folder itself is a link.
  fs::create_directory_symlink(folder.path("in"), folder.path("alias"));
  for (const std::string& name : {std::string("good.mtl"), std::string("../in/good.mtl"), std::string(".\\good.mtl"),
                                  folder.path("in/good.mtl")}) {
    folder.write("in/a.obj", "mtllib " + name + "\nusemtl good\n" + kBox);
    for (const char* way : {"in/a.obj", "alias/a.obj"}) {
      const auto mesh = clray::load_mesh(folder.path(way));
      REQUIRE(mesh->file_materials.size() == 1);
      CHECK(mesh->file_materials[0].parameters.at("rho") == 0.25);
      CHECK(mesh->warnings.empty());
    }
  }
}

TEST_CASE("a path that leads nowhere inside the folder falls back to its last part, with one warning") {
  const Folder folder;
  fs::create_directory(folder.path("in"));
  folder.write("x y.mtl", "newmtl m\nKd x x x\n");  // outside: reading it would be an error
  folder.write("in/x y.mtl", "newmtl m\nKd 0.25 0.25 0.25\n");
  for (const std::string name : {"/somewhere/else/x y.mtl", "../x y.mtl", "C:\\Users\\some one\\x y.mtl", "sub/x y.mtl",
                                 "..\\..\\x y.mtl", "\\\\server\\share\\x y.mtl"}) {
    const auto mesh = clray::load_mesh(folder.write("in/a.obj", "mtllib " + name + "\nusemtl m\n" + kBox));
    INFO(name);
    REQUIRE(mesh->file_materials.size() == 1);
    CHECK(mesh->file_materials[0].parameters.at("rho") == 0.25);
    REQUIRE(mesh->warnings.size() == 1);
    CHECK(mesh->warnings[0].find("a.obj:1: material library '" + name + "' is not inside the folder") !=
          std::string::npos);
    CHECK(mesh->warnings[0].find("'x y.mtl' beside it is read instead") != std::string::npos);
  }
}
