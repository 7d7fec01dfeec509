// SPDX-License-Identifier: Apache-2.0
// What is remembered is a file of its own: two hashes of its key (device, driver, flags, text) and a checksum of them.
// The name is the first hash.
#include "device/kernel_cache.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "device/program.hpp"
#include "text/hash.hpp"
#include "text/output_file.hpp"

namespace clray {
namespace {

namespace fs = std::filesystem;

std::string key_of(const OpenedDevice& opened, const std::string& what) {
  const char* library = getenv("POCL_KERNELLIB_NAME");  // changes PoCL's code but not its names
  const DeviceInfo& info = opened.info;
  std::string key;
  for (const std::string& part : {info.platform, info.name, info.version, info.driver,
                                  std::string(library ? library : ""), build_flags(opened, false), what}) {
    key += part + "\n";
  }
  return key;
}

std::uint64_t hash_of(const std::string& text, std::uint64_t state = kFnvStart) {
  return fnv1a(state, text.data(), text.size());
}

/// Of what passed: the file and its text.
struct Note {
  fs::path path;
  std::string text;
};

Note note_of(const OpenedDevice& opened, const std::string& what) {
  const std::string key = key_of(opened, what);
  const std::uint64_t first = hash_of(key), second = hash_of(key, ~kFnvStart);
  const std::string hashes = fmt::format("clray {} passed {:016x} {:016x}\n", CLRAY_VERSION, first, second);
  return {fs::path(kernel_cache_folder()) / "clray" / fmt::format("{:016x}.passed", first),
          hashes + fmt::format("{:016x}\n", hash_of(hashes))};
}

/// Nobody else can have written there.
bool is_own(const fs::path& folder) {
  struct stat status {};
  return ::stat(folder.c_str(), &status) == 0 && status.st_uid == ::geteuid() &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

bool remembered(const OpenedDevice& opened, const std::string& what) {
  const Note note = note_of(opened, what);
  if (!is_own(note.path.parent_path())) return false;
  std::ifstream file(note.path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), {}) == note.text;
}

void remember(const OpenedDevice& opened, const std::string& what) {
  const Note note = note_of(opened, what);
  std::error_code error;
  fs::create_directories(note.path.parent_path(), error);
  if (error) return;
  std::string temporary = note.path.string() + "-XXXXXX";
  const int file = mkstemp(temporary.data());
  if (file < 0) return;
  const bool whole =
      write(file, note.text.data(), note.text.size()) == static_cast<ssize_t>(note.text.size()) && fsync(file) == 0;
  close(file);
  if (whole) fs::rename(temporary, note.path, error);  // so it appears whole, even if others write it as well
  if (!whole || error) fs::remove(temporary, error);
}

std::string kernel_cache_folder() {
  if (const char* folder = getenv("POCL_CACHE_DIR")) return folder;
  if (const char* folder = getenv("XDG_CACHE_HOME")) return fs::path(folder) / "pocl" / "kcache";
  if (const char* folder = getenv("HOME")) return fs::path(folder) / ".cache" / "pocl" / "kcache";
  return "/tmp/pocl/kcache";
}

bool kernel_cache_writable() {
  return text::folder_fault(kernel_cache_folder()).empty();
}

std::string unwritable_cache() {
  return "the folder of compiled kernels, " + kernel_cache_folder() + ", cannot be written (" +
         text::folder_fault(kernel_cache_folder()) + "): POCL_CACHE_DIR names another";
}

}  // namespace clray
