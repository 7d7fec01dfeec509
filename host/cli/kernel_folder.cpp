// SPDX-License-Identifier: Apache-2.0
// See kernel_folder.hpp. The list is text: a line of checksum, size and path for each file, and a checksum of all
// lines.
#include "kernel_folder.hpp"

#include <fcntl.h>
#include <pwd.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "text/hash.hpp"
#include "text/output_file.hpp"

namespace clray::cli {

namespace fs = std::filesystem;

namespace {

constexpr const char* kList = "files.list";
constexpr const char* kUnlisted[] = {"last_accessed", "build.log"};  // PoCL changes them, and loads neither

/// Checksums by path below the folder.
using Sums = std::map<std::string, std::string>;

std::string slurp(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string hex(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%016" PRIx64, value);
  return text;
}

std::string sum_of(const fs::path& file) {
  const std::string bytes = slurp(file);
  return hex(checksum(bytes.data(), bytes.size())) + " " + std::to_string(bytes.size());
}

bool is_listed(const fs::path& file) {
  const std::string name = file.filename();
  for (const char* other : kUnlisted) {
    if (name == other) return false;
  }
  return name.rfind(kList, 0) != 0;
}

/// Every file below the folder that PoCL may load, or clray read.
Sums sums_of(const fs::path& folder) {
  Sums sums;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->is_regular_file(error) && is_listed(at->path()))
      sums[fs::relative(at->path(), folder, error).string()] = sum_of(at->path());
  }
  return sums;
}

Sums read_list(const fs::path& folder) {
  const std::string text = slurp(folder / kList);
  const std::size_t end = text.size() < 17 ? 0 : text.size() - 17;
  if (text.size() < 17 || text.substr(end, 16) != hex(checksum(text.data(), end))) return {};
  Sums sums;
  std::istringstream lines(text.substr(0, end));
  for (std::string sum, size, path; lines >> sum >> size && std::getline(lines.ignore(1), path);)
    sums[path] = sum + " " + size;
  return sums;
}

void write_list(const fs::path& folder, const Sums& sums) {
  std::string text;
  for (const auto& [path, sum] : sums) text += sum + " " + path + "\n";
  text += hex(checksum(text.data(), text.size())) + "\n";
  clray::text::replace_output_file((folder / kList).string(), text);
}

/// Why compiled code in a folder could be somebody else's, or cannot be kept there; empty where all is well.
std::string fault_of(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) return "is no folder that can be made";
  if (status.st_uid != ::geteuid()) return "belongs to somebody else";
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) return "can be written by others";
  const std::string reason = text::folder_fault(folder.string());
  return reason.empty() ? "" : "cannot be written (" + reason + ")";
}

/// Where programs keep what they can make again: XDG_CACHE_HOME, or .cache in the home of the environment or, without
/// one, of the list of users. Empty where there is none.
std::string cache_home() {
  if (const char* folder = ::getenv("XDG_CACHE_HOME"); folder != nullptr && *folder == '/') return folder;
  if (const char* home = ::getenv("HOME"); home != nullptr && *home == '/') return std::string(home) + "/.cache";
  const passwd* const user = ::getpwuid(::geteuid());
  return user != nullptr && user->pw_dir != nullptr ? std::string(user->pw_dir) + "/.cache" : "";
}

}  // namespace

KernelFolder::KernelFolder() {
  if (const char* asked = ::getenv("POCL_CACHE_DIR"); asked != nullptr && *asked != '\0') {
    path_ = asked;
    if (const std::string fault = fault_of(path_); !fault.empty()) take_temporary(path_ + " " + fault);
    return;
  }
  const std::string home = cache_home();
  path_ = home + "/clray/kernels";
  const mode_t before = ::umask(077);  // what is made here is the user's alone
  const std::string fault = home.empty() ? "is no folder" : fault_of(path_);
  ::umask(before);
  if (!fault.empty()) {
    take_temporary(path_ + " " + fault);
    return;
  }
  guarded_ = true;
  lock_ = ::open((path_ + "/" + kList + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  remove_changed();
}

KernelFolder::~KernelFolder() {
  note_files();
  if (lock_ >= 0) ::close(lock_);
  std::error_code ignored;
  if (noted_) fs::remove_all(path_, ignored);
}

void KernelFolder::take_temporary(const std::string& why) {
  trouble_ = "the folder of compiled kernels, " + why + ": they are not kept. POCL_CACHE_DIR names another";
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "clray-kernels-XXXXXX").string();
  if (error || ::mkdtemp(name.data()) == nullptr) return;  // PoCL alone needs the folder, and says that a build failed
  path_ = name;
  noted_ = std::make_unique<text::Temporary>(name);
}

void KernelFolder::remove_changed() {
  const bool alone = lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) == 0;
  const Sums listed = read_list(path_), found = sums_of(path_);
  std::set<fs::path> bad;
  const auto remove = [&](const fs::path& file) {
    // PoCL's files of one program stand in xx/name and belong together; others stand alone.
    auto part = file.begin();
    fs::path top = *part;
    if (std::distance(file.begin(), file.end()) > 2 && part->string().size() == 2) top /= *++part;
    bad.insert(std::distance(file.begin(), file.end()) > 2 ? top : file);
  };
  for (const auto& [path, sum] : listed) {
    const auto at = found.find(path);
    if (at == found.end() || at->second != sum) remove(path);
  }
  for (const auto& [path, sum] : found) {
    if (alone && listed.count(path) == 0) remove(path);
  }
  std::error_code ignored;
  for (const fs::path& one : bad) fs::remove_all(path_ / one, ignored);
  if (lock_ >= 0) ::flock(lock_, LOCK_SH);
}

void KernelFolder::note_files() noexcept {
  if (!guarded_) return;
  try {
    const Sums listed = read_list(path_), found = sums_of(path_);
    if (found == listed) return;
    for (const auto& [path, sum] : found) {
      if (listed.count(path) == 0) text::sync_to_disk((fs::path(path_) / path).string());
    }
    write_list(path_, found);
  } catch (const std::exception&) {
    // What is not listed is built again.
  }
}

}  // namespace clray::cli
