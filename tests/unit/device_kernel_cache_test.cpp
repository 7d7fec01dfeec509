// SPDX-License-Identifier: Apache-2.0
// What is kept beside the kernel cache, memories of tests and built programs: found again for equal keys only, none
// when damaged; and that folder when it cannot be written. In a folder of its own, since it changes POCL_CACHE_DIR.
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

TEST_CASE(
    "built programs are kept for one device, driver, flags and text; what a driver does not take is built again") {
  OpenedDevice opened = clray::test::opened_cpu();
  opened.has_cache = false;  // as of a driver that keeps nothing itself
  const OwnCache cache;
  const std::string flags = build_flags(opened, false);
  const std::string twice = "__kernel void change(__global int* x) { x[0] = 2 * x[0]; }";
  const std::string thrice = "__kernel void change(__global int* x) { x[0] = 3 * x[0]; }";
  const auto changed = [&](const std::string& source) {
    opened.programs.clear();  // as in another process
    cl::Kernel kernel = make_kernel(opened, build_source(opened, "change.cl", source, false), "change");
    const cl::Buffer x = make_buffer(opened, std::vector<int>{21});
    set_arguments(opened, kernel, x);
    launch(opened, kernel, 1, 1);
    return read_buffer<int>(opened, x, 1).front();
  };
  CHECK_FALSE(kept_binary(opened, flags, twice));
  CHECK(changed(twice) == 42);
  CHECK(changed(thrice) == 63);
  REQUIRE(kept_binary(opened, flags, twice));
  CHECK_FALSE(kept_binary(opened, flags + " -Werror", twice));
  CHECK_FALSE(kept_binary(opened, flags, twice + " "));
  CHECK(changed(twice) == 42);
  keep_binary(opened, flags, twice, *kept_binary(opened, flags, thrice));
  CHECK(changed(twice) == 63);  // what is kept is what runs
  keep_binary(opened, flags, twice, "no program");
  CHECK(changed(twice) == 42);
  opened.has_cache = true;
  const std::string fourfold = "__kernel void change(__global int* x) { x[0] = 4 * x[0]; }";
  CHECK(changed(fourfold) == 84);
  CHECK_FALSE(kept_binary(opened, flags, fourfold));
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
