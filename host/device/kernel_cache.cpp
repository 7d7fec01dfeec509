// SPDX-License-Identifier: Apache-2.0
// What is kept is a file of its own: two hashes of its key (device, driver, flags, text), the content, and a checksum
// of it all. The name is the first hash.
#include "device/kernel_cache.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "clray/error.hpp"
#include "device/program.hpp"
#include "text/hash.hpp"
#include "text/output_file.hpp"

namespace clray {
namespace {

namespace fs = std::filesystem;

std::string key_of(const OpenedDevice& opened, const std::string& flags, const std::string& what) {
  const char* library = getenv("POCL_KERNELLIB_NAME");  // changes PoCL's code but not its names
  const DeviceInfo& info = opened.info;
  std::string key;
  for (const std::string& part :
       {info.platform, info.name, info.version, info.driver, std::string(library ? library : ""), flags, what}) {
    key += part + "\n";
  }
  return key;
}

std::uint64_t hash_of(const std::string& text, std::uint64_t state = kFnvStart) {
  return fnv1a(state, text.data(), text.size());
}

/// A file that is kept: where, and how it begins.
struct Kept {
  fs::path path;
  std::string head;

  /// `kind`: "passed" or "binary".
  Kept(const char* kind, const std::string& key) {
    const std::uint64_t first = hash_of(key), second = hash_of(key, ~kFnvStart);
    path = fs::path(kernel_cache_folder()) / "clray" / fmt::format("{:016x}.{}", first, kind);
    head = fmt::format("clray {} {} {:016x} {:016x}\n", CLRAY_VERSION, kind, first, second);
  }
  std::string text_of(const std::string& content) const {
    const std::string text = head + content;
    return text + fmt::format("\n{:016x}\n", hash_of(text));
  }
};

constexpr std::size_t kChecksumSize = 18;  // of text_of()

/// Nobody else can have written there.
bool is_own(const fs::path& folder) {
  struct stat status {};
  return ::stat(folder.c_str(), &status) == 0 && status.st_uid == ::geteuid() &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

std::optional<std::string> read_kept(const Kept& kept) {
  if (!is_own(kept.path.parent_path())) return std::nullopt;
  std::ifstream file(kept.path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::size_t around = kept.head.size() + kChecksumSize;
  if (text.size() < around) return std::nullopt;
  std::string content = text.substr(kept.head.size(), text.size() - around);
  if (kept.text_of(content) != text) return std::nullopt;
  return content;
}

void write_kept(const Kept& kept, const std::string& content) {
  std::error_code error;
  fs::create_directories(kept.path.parent_path(), error);
  if (error) return;
  try {
    text::replace_output_file(kept.path.string(), kept.text_of(content));  // whole, even if others write it as well
  } catch (const Error&) {
    // It is built again.
  }
}

Kept note_of(const OpenedDevice& opened, const std::string& what) {
  return {"passed", key_of(opened, build_flags(opened, false), what)};
}

}  // namespace

bool remembered(const OpenedDevice& opened, const std::string& what) {
  return read_kept(note_of(opened, what)).has_value();
}

void remember(const OpenedDevice& opened, const std::string& what) {
  write_kept(note_of(opened, what), "");
}

std::optional<std::string> kept_binary(const OpenedDevice& opened, const std::string& flags,
                                       const std::string& source) {
  return read_kept({"binary", key_of(opened, flags, source)});
}

void keep_binary(const OpenedDevice& opened, const std::string& flags, const std::string& source,
                 const std::string& binary) {
  write_kept({"binary", key_of(opened, flags, source)}, binary);
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
