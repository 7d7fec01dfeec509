// SPDX-License-Identifier: Apache-2.0
// A result appears whole or not at all, and never in place of something that clray did not write.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "io/output_folder.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;
using io_test::slurp;
using io_test::spit;
namespace fs = std::filesystem;

namespace {

Result sample(std::uint64_t digest = 1) {
  Result result = io_test::result();
  result.digest = digest;
  result.delay.push_back(io_test::delay());
  return result;
}

WriteOptions no_plots() {
  WriteOptions options;
  options.plots = false;
  return options;
}

void write(const std::string& folder, std::uint64_t digest = 1, WriteOptions options = no_plots()) {
  write_result(sample(digest), io_test::scene(), folder, options);
}

std::string refusal(const std::string& folder) {
  try {
    write(folder);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::output);
    return error.what();
  }
  FAIL("written");
  return {};
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("an older result is replaced whole, and nothing else is left beside it") {
  Scratch scratch;
  WriteOptions more = no_plots();
  more.more.push_back([](const std::string& folder) {
    spit(folder + "/observations.csv", "old");
    return MoreFiles{{"observations.csv"}, "", ""};
  });
  write(scratch / "out", 1, more);
  write(scratch / "out/", 2);
  CHECK(has(slurp(scratch / "out/summary.json"), "0000000000000002"));
  CHECK_FALSE(fs::exists(scratch / "out/observations.csv"));
  CHECK(scratch.entries() == 1);
}

TEST_CASE("the old result survives a failing new one") {
  Scratch scratch;
  write(scratch / "out", 1);
  WriteOptions failing = no_plots();
  failing.more.push_back([](const std::string&) -> MoreFiles { throw std::runtime_error("planted"); });
  std::string message;
  try {
    write(scratch / "out", 2, failing);
  } catch (const Error& error) {
    message = error.what();
    CHECK(error.code() == ErrorCode::output);
  }
  CHECK(has(slurp(scratch / "out/summary.json"), "0000000000000001"));
  // What was traced is not lost: the finished files are beside it, and the message says where.
  REQUIRE(scratch.entries() == 2);
  const std::string words = "planted; the files that were finished are in ";
  REQUIRE(has(message, words));
  const fs::path kept = message.substr(message.find(words) + words.size());
  CHECK(has(slurp(kept / "delay.csv"), "0000000000000002"));
  CHECK_FALSE(fs::exists(kept / "summary.json"));
  CHECK_THROWS_AS(write(scratch / "new/deep/er", 2, failing), Error);
  CHECK(std::distance(fs::directory_iterator(scratch / "new/deep"), {}) == 1);
}

TEST_CASE("a folder that could not be replaced is refused before tracing") {
  Scratch scratch;
  CHECK_THROWS_WITH_AS(check_output("/proc"), doctest::Contains("a file system is mounted there"), Error);
  // Somebody else's result in a folder where only owners may move things, as /tmp is.
  const bool root = ::geteuid() == 0;
  if (root) {
    fs::create_directory(scratch / "shared");
    REQUIRE(::chmod((scratch / "shared").c_str(), 01777) == 0);
    REQUIRE(::chmod(scratch.path.c_str(), 0755) == 0);
    write(scratch / "shared/theirs", 1);
    fs::create_directory(scratch / "shared/locked");
    REQUIRE(::chown((scratch / "shared/locked").c_str(), 65534, 65534) == 0);
    REQUIRE(::chmod((scratch / "shared/locked").c_str(), 0500) == 0);
    REQUIRE(::seteuid(65534) == 0);
    std::string theirs, locked;
    try {
      check_output(scratch / "shared/theirs");
    } catch (const Error& error) {
      theirs = error.what();
    }
    try {
      check_output(scratch / "shared/locked");
    } catch (const Error& error) {
      locked = error.what();
    }
    REQUIRE(::seteuid(0) == 0);
    CHECK(has(theirs, "it belongs to somebody else"));
    CHECK(has(locked, "its files could not be removed (Permission denied)"));
  }
  fs::create_symlink(scratch / "nowhere/deep", scratch / "link");
  check_output(scratch / "link");  // a dangling link is followed: the result is made where it leads
  write(scratch / "link", 3);
  CHECK(has(slurp(scratch / "nowhere/deep/summary.json"), "0000000000000003"));
  fs::create_symlink("loop", scratch / "loop");
  CHECK_THROWS_AS(check_output(scratch / "loop"), Error);
  fs::create_symlink(scratch / "absent", scratch / "parent");
  CHECK_THROWS_AS(check_output(scratch / "parent/out"), Error);
}

TEST_CASE("what is no result of clray is not touched") {
  Scratch scratch;
  fs::create_directory(scratch / "photos");
  spit(scratch / "photos/cat.jpg", "meow");
  CHECK(has(refusal(scratch / "photos"), "no summary.json"));
  CHECK(slurp(scratch / "photos/cat.jpg") == "meow");
  spit(scratch / "file", "text");
  CHECK(has(refusal(scratch / "file"), "a file, not a folder"));
  CHECK(slurp(scratch / "file") == "text");
  fs::create_directory(scratch / "other");
  spit(scratch / "other/summary.json", "{\"program\": \"other\"}");
  CHECK(has(refusal(scratch / "other"), "not of clray"));
  write(scratch / "out");
  spit(scratch / "out/notes.txt", "mine");
  CHECK(has(refusal(scratch / "out"), "notes.txt"));
  CHECK(slurp(scratch / "out/notes.txt") == "mine");
  CHECK(has(refusal(scratch / "file/below"), "cannot"));
  CHECK(scratch.entries() == 4);
  // Where nobody may write, root included.
  CHECK(has(refusal("/proc/clray-out"), "cannot write in the folder /proc"));
  CHECK_THROWS_AS(check_output(scratch / "photos"), Error);
  CHECK_THROWS_AS(write(""), Error);
}

TEST_CASE("the current folder, and those that hold it, are no place for a result") {
  Scratch scratch;
  write(scratch / "out");
  const fs::path before = fs::current_path();
  for (const char* here : {"out", "."}) {
    fs::current_path(scratch.path / here);
    for (const char* target : {".", "./", "../out/.."}) {
      CAPTURE(target);
      std::string said;
      try {
        check_output(target);
      } catch (const Error& error) {
        said = error.what();
      }
      CHECK(has(said, "it is the current folder, or holds it"));
    }
    check_output("new");
  }
  fs::current_path(before);
  CHECK(scratch.entries() == 1);
}

TEST_CASE("names that a summary claims lead nowhere else, and a folder is no file of a result") {
  Scratch scratch;
  spit(scratch / "mine", "text");
  fs::create_directory(scratch / "out");
  spit(scratch / "out/summary.json", "{\"clray\": \"1\", \"files\": [\"../mine\", \"photos\", \"summary.json\"]}");
  write(scratch / "out", 2);
  CHECK(slurp(scratch / "mine") == "text");
  CHECK(scratch.entries() == 2);
  fs::create_directory(scratch / "album");
  fs::create_directory(scratch / "album/photos");
  spit(scratch / "album/photos/cat.jpg", "meow");
  spit(scratch / "album/summary.json", "{\"clray\": \"1\", \"files\": [\"photos\"]}");
  CHECK(has(refusal(scratch / "album"), "it holds 'photos', which clray did not write"));
  CHECK(slurp(scratch / "album/photos/cat.jpg") == "meow");
}

TEST_CASE("what comes into an older result while it is replaced is kept") {
  Scratch scratch;
  write(scratch / "out", 1);
  {
    io::OutputFolder place(scratch / "out");
    spit(place.path("summary.json"), "{}");
    place.commit();  // the older result stands at the temporary name now, until the end of the scope
    spit(place.path("notes.txt"), "mine");
  }
  CHECK(slurp(scratch / "out/summary.json") == "{}");
  REQUIRE(scratch.entries() == 2);
  for (const auto& entry : fs::directory_iterator(scratch.path)) {
    if (entry.path().filename() != "out") CHECK(slurp(entry.path() / "notes.txt") == "mine");
  }
}

TEST_CASE("an interrupted result takes the place of one that has no more, and of no other") {
  Scratch scratch;
  Result cut = sample(7);
  cut.partial = true;
  cut.stopped_by = "interrupt";
  cut.rays_total = 100;
  const std::string out = scratch / "out";
  CHECK(result_folder(cut, out) == out);
  write_result(cut, io_test::scene(), out, no_plots());
  CHECK(result_folder(cut, out) == out);
  cut.rays_total = 99;
  CHECK(result_folder(cut, out) == out + ".partial");
  cut.rays_total = 101;
  CHECK(result_folder(cut, out + "/") == out + "/");
  write(out, 8);
  CHECK(result_folder(cut, out) == out + ".partial");
  cut.stopped_by = "time limit";  // as asked
  CHECK(result_folder(cut, out) == out);
  spit(scratch / "out.partial", "a file");  // found before anything is traced
  CHECK_THROWS_WITH_AS(check_output(out), doctest::Contains("out.partial"), Error);
}

TEST_CASE("an empty folder is taken, a link is followed, parents are made") {
  Scratch scratch;
  fs::create_directory(scratch / "empty");
  write(scratch / "empty");
  CHECK(fs::exists(scratch / "empty/summary.json"));
  fs::create_directory_symlink(scratch / "empty", scratch / "link");
  write(scratch / "link", 3);
  CHECK(fs::is_symlink(scratch / "link"));
  CHECK(has(slurp(scratch / "empty/summary.json"), "0000000000000003"));
  write(scratch / "a/b/c d 'e' [1]");
  CHECK(fs::exists(scratch / "a/b/c d 'e' [1]/summary.json"));
}

TEST_CASE("a check leaves nothing behind") {
  Scratch scratch;
  check_output(scratch / "a/b/c");
  CHECK(scratch.entries() == 0);
}

TEST_CASE("the folder has the permissions that the user's mask allows") {
  Scratch scratch;
  const mode_t before = ::umask(022);
  write(scratch / "out");
  ::umask(before);
  struct stat information {};
  REQUIRE(::stat((scratch / "out").c_str(), &information) == 0);
  CHECK((information.st_mode & 0777) == 0755);
}

TEST_CASE("a full disk is an error, and nothing half-written is left") {
  // A limit on file size stands in for the disk: writes beyond it fail with EFBIG.
  Scratch scratch;
  write(scratch / "out", 1);
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  auto* const handler = ::signal(SIGXFSZ, SIG_IGN);
  Result large = io_test::result();
  large.delay.push_back(io_test::delay(5000));
  rlimit tight = before;
  tight.rlim_cur = 8192;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &tight) == 0);
  std::string message;
  try {
    write_result(large, io_test::scene(), scratch / "out", no_plots());
  } catch (const Error& error) {
    message = error.what();
    CHECK(error.code() == ErrorCode::output);
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  CHECK(has(message, "delay.csv: File too large"));
  CHECK(has(slurp(scratch / "out/summary.json"), "0000000000000001"));
  CHECK(scratch.entries() == 1);
}

TEST_CASE("plots: made where gnuplot is, a warning and no file where it is not") {
  Scratch scratch;
  std::vector<std::string> warnings;
  WriteOptions options;
  options.warnings = &warnings;
  Scene scene = io_test::scene();
  scene.name = "it's a_b^c {x} \"quoted\" `date` ü";
  auto files = write_result(sample(), scene, scratch / "out", options);
  CAPTURE(warnings.empty() ? std::string() : warnings.front());
  CHECK(warnings.empty());
  for (const char* name : {"out/delay.png", "out/error.png"}) {
    // The first bytes of every PNG, ISO/IEC 15948.
    CHECK(slurp(scratch / name).substr(0, 8) == "\x89PNG\r\n\x1a\n");
  }
  const std::string path = ::getenv("PATH");
  ::setenv("PATH", scratch.path.c_str(), 1);
  files = write_result(sample(), scene, scratch / "out", options);
  ::setenv("PATH", path.c_str(), 1);
  REQUIRE(warnings.size() == 2);
  CHECK(has(warnings[0], "gnuplot is not installed (package gnuplot-nox)"));
  CHECK_FALSE(fs::exists(scratch / "out/delay.png"));
  CHECK(files.size() == 3);
  CHECK(has(slurp(scratch / "out/summary.json"), "gnuplot is not installed"));
}
