// SPDX-License-Identifier: Apache-2.0
// What is left unfinished is removed where its maker is gone, and nothing else is.
#include <doctest/doctest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "text/output_file.hpp"
#include "text/temporaries.hpp"

using namespace clray::text;
namespace fs = std::filesystem;

namespace {

struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "clray-text-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~Scratch() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(path), {}); }
};

void spit(const std::string& file, const std::string& text) {
  std::ofstream(file) << text;
}

}  // namespace

TEST_CASE("leftovers of one path are removed: files and folders; what only looks like one stays") {
  const Scratch scratch;
  spit(scratch / ".out.clray-0123abcd", "left");
  fs::create_directories(scratch / ".out.clray-89abcdef/deep");
  spit(scratch / ".out.clray-89abcdef/deep/file", "left");
  const std::vector<std::string> others{".out.clray-0123abc",
                                        ".out.clray-0123abcde",
                                        ".out.clray-0123abcg",
                                        ".out.clray-0123ABCD",
                                        ".other.clray-0123abcd",
                                        "out.clray-0123abcd",
                                        "out"};
  for (const std::string& name : others) spit(scratch / name, "mine");
  spit(scratch / "target", "mine");
  fs::create_symlink("target", scratch / ".out.clray-00000000");
  remove_unfinished(scratch / "out");
  CHECK(scratch.entries() == static_cast<std::ptrdiff_t>(others.size()) + 2);
  CHECK_FALSE(fs::exists(scratch / ".out.clray-0123abcd"));
  CHECK_FALSE(fs::exists(scratch / ".out.clray-89abcdef"));
  remove_unfinished(scratch / "no/such/folder");
}

TEST_CASE("what somebody is making stays, and is removed when its maker is gone") {
  const Scratch scratch;
  for (const auto kind : {Unfinished::Kind::file, Unfinished::Kind::folder}) {
    std::string name;
    {
      Unfinished made;
      REQUIRE(made.make(scratch / "out", kind) == 0);
      name = made.path();
      remove_unfinished(scratch / "out");
      CHECK(fs::exists(name));
    }
    // A file goes with its maker; a folder stays until somebody looks.
    CHECK(fs::exists(name) == (kind == Unfinished::Kind::folder));
    remove_unfinished(scratch / "out");
    CHECK(scratch.entries() == 0);
  }
  Unfinished made;
  CHECK(made.make(scratch / "no/such/out", Unfinished::Kind::file) == ENOENT);
}

TEST_CASE("a replaced file leaves nothing beside it, and is given the permissions of the process") {
  const Scratch scratch;
  spit(scratch / ".sums.clray-00000001", "left");
  spit(scratch / "sums.new", "mine");
  replace_output_file(scratch / "sums", "one");
  replace_output_file(scratch / "sums", "two");
  CHECK(scratch.entries() == 2);
  std::ifstream in(scratch / "sums");
  CHECK(std::string((std::istreambuf_iterator<char>(in)), {}) == "two");
  const ::mode_t mask = ::umask(0);
  ::umask(mask);
  CHECK(static_cast<unsigned>(fs::status(scratch / "sums").permissions()) == (0666U & ~mask));
}
