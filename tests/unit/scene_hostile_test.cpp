// SPDX-License-Identifier: Apache-2.0
// Scene files made to stop the reader: pipes and devices in place of files, keys and values nested without end,
// hundreds of thousands of names. Each is refused in words or read in a time that grows like the file.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <chrono>

#include "unit/patience.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::string kBall = "component = [{ shape = \"sphere\" }]\n";

double seconds_to_load(const SceneFolder& f, const std::string& text) {
  const std::string file = f.write("many.toml", text);
  const auto start = std::chrono::steady_clock::now();
  load_scene(file);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string repeated(int n, const std::string& head, const std::string& tail) {
  std::string text;
  for (int i = 0; i < n; ++i) text += head + std::to_string(i) + tail;
  return text;
}

}  // namespace

TEST_CASE("hostile: a pipe, a device or a folder in place of any file is refused, and nothing waits for it") {
  const SceneFolder f;
  REQUIRE(::mkfifo(f.path("pipe.csv").c_str(), 0600) == 0);
  REQUIRE(::mkfifo(f.path("pipe.toml").c_str(), 0600) == 0);
  REQUIRE(::mkfifo(f.path("pipe.obj").c_str(), 0600) == 0);
  std::filesystem::create_directory(f.path("folder.csv"));
  std::filesystem::create_symlink("/dev/zero", f.path("zero.csv"));
  const std::pair<std::string, std::string> places[] = {
      {"[[material]]\nname = \"m\"\nmodel = \"lambert\"\nrho = ", ""},
      {"[[material]]\nname = \"m\"\nmodel = \"tabulated\"\nfile = ", ""},
      {kBall + "[source]\nkind = \"sun\"\nspectrum = ", ""},
      {kBall + "[source]\nkind = \"sun\"\nbands = [", "]"},
      {kBall + "[motion]\nattitudes = ", ""},
      {kBall + "[station]\nranges = ", ""},
      {kBall + "[station]\npulse = ", ""},
      {kBall + "[station]\nposition_m = [6e6, 0, 0]\ncpf = ", ""},
  };
  for (const auto& one : places) {
    const auto& head = one.first;
    const auto& tail = one.second;
    CAPTURE(head);
    CHECK(f.complaint(head + "\"pipe.csv\"" + tail)
              .find("\"pipe.csv\" is a device or pipe; a regular file was expected") != std::string::npos);
    CHECK(f.complaint(head + "\"folder.csv\"" + tail).find("\"folder.csv\" is a folder; a file was expected") !=
          std::string::npos);
    CHECK(f.complaint(head + "\"zero.csv\"" + tail).find("expected a file inside the scene's folder") !=
          std::string::npos);
  }
  for (const char* name : {"pipe.toml", "pipe.obj"}) {
    CHECK_THROWS_WITH_AS(load_scene(f.path(name)),
                         (f.path(name) + ": is a device or pipe; a regular file was expected").c_str(), Error);
  }
  SceneOptions options;
  for (const char* file : {"/dev/zero", "/dev/full"}) {
    options.material = std::string("tabulated file=") + file;
    CHECK(f.complaint(kBall, ErrorCode::input, options) ==
          std::string(file) + ": is a device or pipe; a regular file was expected");
  }
}

TEST_CASE("hostile: keys of many parts and values in values have a limit") {
  const SceneFolder f;
  const auto chain = [](int n) {
    std::string text = "a";
    for (int i = 1; i < n; ++i) text += ".a";
    return text;
  };
  const std::string deep = ": a key of more than 16 parts; at most that many were expected";
  for (const int n : {17, 1000, 1000000}) {
    CHECK(f.complaint(kBall + chain(n) + " = 1\n") == "s.toml:2:32" + deep);
    CHECK(f.complaint(kBall + "[" + chain(n) + "]\n") == "s.toml:2:33" + deep);
    CHECK(f.complaint(kBall + "b = [1,\n{ " + chain(n) + " = 1 }]\n") == "s.toml:3:34" + deep);
  }
  CHECK(f.complaint(kBall + chain(16) + " = 1\n").find("unknown key 'a'") != std::string::npos);
  // Dots in texts and comments are none of keys, and those of different numbers do not add up.
  const std::string dots(100, '.');
  CHECK(f.complaint("# " + dots + "\nlength_unit = 1.5 # " + dots + "\ncomponent = [{ name = \"a" + dots +
                    "\", shape = 'sphere' }, { name = '''b\n#'\"''', shape = \"sphere\" }]\n")
            .find("parts") == std::string::npos);
  CHECK(f.complaint(kBall + "reference_point = [" + std::string(100, '[') + "\n").find("not TOML: ") !=
        std::string::npos);
  CHECK(f.complaint(kBall + "reference_point = [0.5, 0.5, 0.5]\nsource = { direction = [1.5, 2.5, 3.5] }\n" +
                    "[trace]\n" + "target_error_percent = 1.5\n") == "fine");
}

TEST_CASE("hostile: a hundred thousand names of each kind") {
  const SceneFolder f;
  const int n = 100000;
  const std::string white = "[[material]]\nname = \"m\"\nmodel = \"lambert\"\n";
  CHECK(seconds_to_load(f, repeated(n, "[[component]]\nshape = \"sphere\"\ntransform = { translate = [",
                                    ", 0, 0] }\n")) < 20.0 * clray::test::kPatience);
  CHECK(seconds_to_load(f, white + repeated(n, "[[material]]\nname = \"m", "\"\nmodel = \"lambert\"\n") +
                               repeated(n, "[[component]]\nshape = \"sphere\"\nmaterial = \"m", "\"\n")) <
        20.0 * clray::test::kPatience);
  CHECK(seconds_to_load(f, kBall + repeated(n, "[[observer]]\nname = \"o", "\"\n")) < 20.0 * clray::test::kPatience);
  CHECK(seconds_to_load(f, kBall + repeated(n, "[[detector]]\nkind = \"delay\"\nname = \"d", "\"\n")) <
        20.0 * clray::test::kPatience);
  CHECK(seconds_to_load(f, white + "[[component]]\nshape = \"sphere\"\nmaterial = \"m\"\n" +
                               repeated(n, "[[variant]]\nname = \"v", "\"\nmaterial = { name = \"m\", rho = 0.5 }\n")) <
        20.0 * clray::test::kPatience);  // each about a second when optimised; a square-law step takes minutes
}

TEST_CASE("hostile: two hundred thousand materials of a mesh") {
  const SceneFolder f;
  const int n = 200000;
  f.write("m.mtl", repeated(n, "newmtl m", "\nKd 0.5 0.5 0.5\n"));
  const std::string mesh =
      f.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" + repeated(n, "usemtl m", "\nf 1 2 3\n"));
  const auto start = std::chrono::steady_clock::now();
  const Scene scene = load_scene(mesh);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() <
        20.0 * clray::test::kPatience);  // 0.5 s
  CHECK(scene.materials.size() == static_cast<std::size_t>(n));
  CHECK(scene.materials[123456].name == "m123456");
  CHECK(scene.components[0].materials[123456] == 123456u);
}
