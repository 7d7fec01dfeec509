// SPDX-License-Identifier: Apache-2.0
// Kept binaries: found again for equal keys only, harmless when damaged; and the kernel cache's folder when it
// cannot be written. In a folder of its own, since it changes POCL_CACHE_DIR.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "device/binary_cache.hpp"
#include "device/buffers.hpp"
#include "device/platforms.hpp"
#include "device/program.hpp"

using namespace clray;
namespace fs = std::filesystem;

namespace {

const char* const kSource = "__kernel void k(__global uint *p) { p[get_global_id(0)] = get_global_id(0) + 41u; }\n";

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

std::uint32_t second_number(OpenedDevice& opened, const cl::Program& program) {
  cl::Kernel kernel = make_kernel(opened, program, "k");
  const cl::Buffer buffer = make_zero_buffer<std::uint32_t>(opened, 4);
  set_arguments(opened, kernel, buffer);
  launch(opened, kernel, 4, 4);
  return read_buffer<std::uint32_t>(opened, buffer, 4)[1];
}

}  // namespace

TEST_CASE("a kept binary serves the same device, flags and source, and no other") {
  OpenedDevice opened = open_device(choose_devices(find_devices(), "cpu").front());
  const OwnCache cache;
  const std::string flags = build_flags(opened, false);
  CHECK_FALSE(load_binary(opened, flags, kSource));
  const cl::Program program = build_source(opened, "k", kSource, false);
  CHECK(second_number(opened, program) == 42);
  save_binary(opened, flags, kSource, program);

  const auto kept = load_binary(opened, flags, kSource);
  REQUIRE(kept);
  CHECK(second_number(opened, *kept) == 42);
  CHECK_FALSE(load_binary(opened, flags + " -Werror", kSource));
  CHECK_FALSE(load_binary(opened, flags, std::string(kSource) + "\n"));
  opened.info.driver += "x";
  CHECK_FALSE(load_binary(opened, flags, kSource));
}

TEST_CASE("a damaged binary is a miss, and the program builds from its source") {
  OpenedDevice opened = open_device(choose_devices(find_devices(), "cpu").front());
  const OwnCache cache;
  const cl::Program program = build_source(opened, "k", kSource, false);
  save_binary(opened, build_flags(opened, false), kSource, program);
  opened.programs.clear();
  int files = 0;
  for (const auto& entry : fs::directory_iterator(cache.folder + "/clray")) {
    ++files;
    std::ifstream in(entry.path(), std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    in.close();
    const std::size_t binary = text.find('\0') + 1;
    std::ofstream(entry.path(), std::ios::binary) << text.substr(0, binary) << "rubbish";
  }
  CHECK(files == 1);
  bool from_binary = false;
  const cl::Program again = build_source(opened, "k", kSource, false, true, &from_binary);
  CHECK_FALSE(from_binary);
  CHECK(second_number(opened, again) == 42);
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
  CHECK(said.find("the folder of compiled kernels, /proc/nowhere, cannot be written: POCL_CACHE_DIR names another") !=
        std::string::npos);
}
