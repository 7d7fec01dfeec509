// SPDX-License-Identifier: Apache-2.0
// What is remembered beside the kernel cache: found again for equal keys only, none when damaged; and that folder when
// it cannot be written. In a folder of its own, since it changes POCL_CACHE_DIR.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "device/buffers.hpp"
#include "device/kernel_cache.hpp"
#include "device/program.hpp"
#include "unit/device_support.hpp"

using namespace clray;
namespace fs = std::filesystem;

namespace {

/// Sets POCL_CACHE_DIR to a fresh folder for a scope.
struct OwnCache {
  std::string folder, before;
  OwnCache() {
    if (const char* old = getenv("POCL_CACHE_DIR")) before = old;
    std::string name = (fs::temp_directory_path() / "clray-test-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()));
    folder = name;
    setenv("POCL_CACHE_DIR", folder.c_str(), 1);
  }
  ~OwnCache() {
    before.empty() ? unsetenv("POCL_CACHE_DIR") : setenv("POCL_CACHE_DIR", before.c_str(), 1);
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

}  // namespace

TEST_CASE("what is remembered serves the same device, driver and text, and no other") {
  OpenedDevice opened = clray::test::opened_cpu();
  const OwnCache cache;
  const std::string what = "a test\nof this";
  CHECK_FALSE(remembered(opened, what));
  remember(opened, what);
  CHECK(remembered(opened, what));
  CHECK_FALSE(remembered(opened, what + "\n"));
  opened.info.driver += "x";
  CHECK_FALSE(remembered(opened, what));
}

TEST_CASE("a damaged memory is none") {
  OpenedDevice opened = clray::test::opened_cpu();
  const OwnCache cache;
  remember(opened, "a test");
  int files = 0;
  for (const auto& entry : fs::directory_iterator(cache.folder + "/clray")) {
    ++files;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(20);
    file.put('#');
  }
  CHECK(files == 1);
  CHECK_FALSE(remembered(opened, "a test"));
  remember(opened, "a test");
  CHECK(remembered(opened, "a test"));
}

TEST_CASE("what others could have written is not remembered") {
  OpenedDevice opened = clray::test::opened_cpu();
  const OwnCache cache;
  remember(opened, "a test");
  REQUIRE(remembered(opened, "a test"));
  fs::permissions(cache.folder + "/clray", fs::perms::others_write, fs::perm_options::add);
  CHECK_FALSE(remembered(opened, "a test"));
}

TEST_CASE("with an unwritable kernel cache the error names it, and the environment stays as it is") {
  const std::string self = fs::read_symlink("/proc/self/exe").string();
  const OwnCache scope;
  const std::string command = "cd '" + scope.folder + "' && POCL_CACHE_DIR=/proc/nowhere '" + self +
                              "' -tc='the self-test passes on this*' >out 2>&1";
  CHECK(std::system(command.c_str()) != 0);
  std::ifstream in(scope.folder + "/out");
  const std::string said((std::istreambuf_iterator<char>(in)), {});
  CAPTURE(said);
  CHECK(said.find("the folder of compiled kernels, /proc/nowhere, cannot be written (No such file or directory): "
                  "POCL_CACHE_DIR names another") != std::string::npos);
}
