// SPDX-License-Identifier: Apache-2.0
// The folder of compiled kernels: damaged files are built again and never fail a run, and code is taken from no folder
// that somebody else may have written to.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;
namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kRun{"--device",   "cpu",     "--rays", "4096", "--method",  "points",
                                    "--no-plots", "--quiet", "--out",  "out",  "square.obj"};

std::string digest(const Scratch& scratch) {
  return nlohmann::json::parse(slurp(scratch / "out/summary.json"))["digest"];
}

/// Files that a driver may load, or clray read.
std::vector<fs::path> files(const fs::path& folder) {
  std::vector<fs::path> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && fs::file_size(entry) > 0) all.push_back(entry);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

TEST_CASE("flipped bits and cuts in compiled kernels never fail a run") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> home{"POCL_CACHE_DIR=", "XDG_CACHE_HOME=" + (scratch / "cache")};
  REQUIRE(clray(scratch, kRun, home).status == 0);
  const std::string whole = digest(scratch);
  const fs::path kernels = scratch / "cache/clray/kernels";
  REQUIRE(fs::exists(kernels / "files.list"));
  std::mt19937 random(7);
  const int faults = ::getenv("CLRAY_LONG_TESTS") != nullptr ? 200 : 4;
  for (int k = 0; k < faults; ++k) {
    const auto all = files(kernels);
    REQUIRE(all.size() > 3);
    // Half of the faults meet what is loaded as code.
    std::vector<fs::path> code;
    for (const fs::path& file : all) {
      if (file.extension() == ".so" || file.extension() == ".bc") code.push_back(file);
    }
    REQUIRE_FALSE(code.empty());
    const fs::path file = k % 2 == 0 ? code[random() % code.size()] : all[random() % all.size()];
    std::string bytes = slurp(file);
    const std::size_t at = random() % bytes.size();
    CAPTURE(file.string());
    CAPTURE(at);
    if (k % 3 == 0) {
      bytes.resize(at);
    } else {
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    }
    spit(file, bytes);
    const auto outcome = clray(scratch, kRun, home);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(digest(scratch) == whole);
  }
}

TEST_CASE("compiled kernels are kept in no folder that others can write, and that is said") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  fs::create_directory(scratch / "tmp");
  for (const mode_t mode : {0777, 0775}) {
    fs::create_directory(scratch / "open");
    REQUIRE(::chmod((scratch / "open").c_str(), mode) == 0);
    const auto outcome = clray(scratch, kRun, {"POCL_CACHE_DIR=" + (scratch / "open"), "TMPDIR=" + (scratch / "tmp")});
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(contains(outcome.err, "open can be written by others: they are not kept"));
    CHECK(fs::is_empty(scratch / "open"));
    CHECK(fs::is_empty(scratch / "tmp"));
    fs::remove_all(scratch / "open");
  }
  if (::geteuid() == 0) {
    fs::create_directory(scratch / "theirs");
    REQUIRE(::chown((scratch / "theirs").c_str(), 65534, 65534) == 0);
    const auto outcome = clray(scratch, kRun, {"POCL_CACHE_DIR=" + (scratch / "theirs")});
    CHECK(outcome.status == 0);
    CHECK(contains(outcome.err, "theirs belongs to somebody else"));
    CHECK(fs::is_empty(scratch / "theirs"));
  }
}

TEST_CASE("without HOME the user's own folder of the list of users is taken, or a temporary one; never a shared one") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  fs::create_directory(scratch / "tmp");
  const auto outcome =
      clray(scratch, kRun,
            {"POCL_CACHE_DIR=", "XDG_CACHE_HOME=/proc/nowhere", "HOME=/proc/nowhere", "TMPDIR=" + (scratch / "tmp")});
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.err, "/proc/nowhere/clray/kernels is no folder that can be made"));
  CHECK(fs::is_empty(scratch / "tmp"));
}

TEST_CASE("few rays are traced before the compiler optimises, unless it already has, to the same digest") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> home{"POCL_CACHE_DIR=" + (scratch / "kernels")};
  const auto explained = [&](const char* rays, const char* packets) {
    std::vector<std::string> arguments{"--device", "cpu", "--rays", rays, "--method", "points", "--walk", packets};
    arguments.insert(arguments.end(), {"--explain", "--no-plots", "--out", "out", "square.obj"});
    const auto outcome = clray(scratch, arguments, home);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    return contains(outcome.out + outcome.err, "- the compiler's optimiser");
  };
  CHECK(explained("4096", "plain"));
  const std::string soon = digest(scratch);
  CHECK_FALSE(explained("65536", "plain"));
  CHECK_FALSE(explained("4096", "plain"));
  CHECK(digest(scratch) == soon);
}

TEST_CASE("a run that an error ends begins without the optimiser, in its first eight runs") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> home{"POCL_CACHE_DIR=" + (scratch / "kernels"),
                                      "XDG_CACHE_HOME=" + (scratch / "cache")};
  const auto explained = [&] {
    const auto outcome = clray(scratch,
                               {"--device", "cpu", "--target-error", "20", "--method", "points", "--explain",
                                "--no-plots", "--out", "out", "square.obj"},
                               home);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    return contains(outcome.out + outcome.err, "- the compiler's optimiser");
  };
  CHECK(explained());
  const std::string soon = digest(scratch);
  for (int run = 2; run <= 8; ++run) CHECK(explained());
  CHECK_FALSE(explained());
  CHECK(digest(scratch) == soon);
}
