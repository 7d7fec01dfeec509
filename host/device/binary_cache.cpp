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

#include "device/program.hpp"

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

constexpr std::uint64_t kFnvBasis = 0xcbf29ce484222325u;

std::uint64_t fnv1a(std::uint64_t state, const std::string& text) {
  for (const unsigned char c : text) state = (state ^ c) * 0x100000001b3u;
  return state;
}

fs::path file_of(const std::string& key) {
  return fs::path(kernel_cache_folder()) / "clray" / fmt::format("{:016x}.bin", fnv1a(kFnvBasis, key));
}

/// Of what passed: the file and its text, from two hashes of the key and a checksum of both.
struct Note {
  fs::path path;
  std::string text;
};

Note note_of(const OpenedDevice& opened, const std::string& what) {
  const std::string key = key_of(opened, build_flags(opened, false), what);
  const std::uint64_t first = fnv1a(kFnvBasis, key), second = fnv1a(~kFnvBasis, key);
  const std::string hashes = fmt::format("clray {} passed {:016x} {:016x}\n", CLRAY_VERSION, first, second);
  return {fs::path(kernel_cache_folder()) / "clray" / fmt::format("{:016x}.passed", first),
          hashes + fmt::format("{:016x}\n", fnv1a(kFnvBasis, hashes))};
}

bool write_whole(const fs::path& path, const std::string& text) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) return false;
  std::string temporary = path.string() + "-XXXXXX";
  const int descriptor = mkstemp(temporary.data());
  if (descriptor < 0) return false;
  close(descriptor);
  std::ofstream file(temporary, std::ios::binary);
  file << text;
  file.close();
  if (file) fs::rename(temporary, path, error);  // whole or not at all, whoever else writes it
  if (file && !error) return true;
  fs::remove(temporary, error);
  return false;
}

}  // namespace

bool remembered(const OpenedDevice& opened, const std::string& what) {
  const Note note = note_of(opened, what);
  std::ifstream file(note.path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), {}) == note.text;
}

void remember(const OpenedDevice& opened, const std::string& what) {
  const Note note = note_of(opened, what);
  write_whole(note.path, note.text);
}

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
    return {};  // of another driver, perhaps: the source is at hand
  }
}

void save_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source,
                 const cl::Program& program) {
  const std::string key = key_of(opened, flags, source);
  try {
    const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.size() != 1 || binaries.front().empty()) return;
    write_whole(file_of(key), key + '\0' + std::string(binaries.front().begin(), binaries.front().end()));
  } catch (const cl::Error&) {
    // What cannot be kept is built again.
  }
}

}  // namespace clray
