// SPDX-License-Identifier: Apache-2.0
// A file per program: its whole key (device, driver, flags, source), a zero byte, the driver's binary. The name is a
// hash of the key; the key is compared in full, so that a collision or a stale file is only a miss.
#include "device/binary_cache.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace clray {
namespace {

namespace fs = std::filesystem;

std::string key_of(const OpenedDevice& opened, const std::string& flags, const std::string& source) {
  const char* library = getenv("POCL_KERNELLIB_NAME");  // changes PoCL's code but not its names
  const DeviceInfo& info = opened.info;
  std::string key;
  for (const std::string& part :
       {info.platform, info.name, info.version, info.driver, std::string(library ? library : ""), flags, source}) {
    key += part + "\n";
  }
  return key;
}

fs::path file_of(const std::string& key) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const unsigned char c : key) hash = (hash ^ c) * 0x100000001b3u;
  return fs::path(kernel_cache_folder()) / "clray" / fmt::format("{:016x}.bin", hash);
}

}  // namespace

std::string kernel_cache_folder() {
  if (const char* folder = getenv("POCL_CACHE_DIR")) return folder;
  if (const char* folder = getenv("XDG_CACHE_HOME")) return fs::path(folder) / "pocl" / "kcache";
  if (const char* folder = getenv("HOME")) return fs::path(folder) / ".cache" / "pocl" / "kcache";
  return "/tmp/pocl/kcache";
}

bool kernel_cache_writable() {
  const fs::path folder = kernel_cache_folder();
  std::error_code error;
  fs::create_directories(folder, error);
  std::string name = (folder / "clray-probe-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) return false;
  const bool written = write(file, "clray", 5) == 5;
  close(file);
  unlink(name.c_str());
  return written;
}

std::string unwritable_cache() {
  return "the folder of compiled kernels, " + kernel_cache_folder() +
         ", cannot be written: POCL_CACHE_DIR names another";
}

std::optional<cl::Program> load_binary(const OpenedDevice& opened, const std::string& flags,
                                       const std::string& source) {
  const std::string key = key_of(opened, flags, source);
  std::ifstream file(file_of(key), std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (text.size() < key.size() + 2 || text.compare(0, key.size(), key) != 0 || text[key.size()] != '\0') return {};
  try {
    const auto first = text.begin() + static_cast<std::ptrdiff_t>(key.size()) + 1;
    cl::Program program(opened.context, {opened.device}, {std::vector<unsigned char>(first, text.end())});
    program.build({opened.device}, flags.c_str());
    return program;
  } catch (const cl::Error&) {
    return {};  // perhaps of another driver: the source will be built
  }
}

void save_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source,
                 const cl::Program& program) {
  const std::string key = key_of(opened, flags, source);
  const fs::path path = file_of(key);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) return;
  std::string temporary = path.string() + "-XXXXXX";
  try {
    const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.size() != 1 || binaries.front().empty()) return;
    const int descriptor = mkstemp(temporary.data());
    if (descriptor < 0) return;
    close(descriptor);
    std::ofstream file(temporary, std::ios::binary);
    file << key << '\0';
    file.write(reinterpret_cast<const char*>(binaries.front().data()),
               static_cast<std::streamsize>(binaries.front().size()));
    file.close();
    if (file) fs::rename(temporary, path, error);  // so it appears whole, even if others write it as well
    if (!file || error) fs::remove(temporary, error);
  } catch (const cl::Error&) {
    fs::remove(temporary, error);
  }
}

}  // namespace clray
