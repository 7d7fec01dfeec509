// SPDX-License-Identifier: Apache-2.0
// See temporaries.hpp.
#include "text/temporaries.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <set>
#include <vector>

#include "text/text.hpp"

namespace clray::text {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostStem = 200;  // of a name's bytes: file systems allow 255
constexpr std::size_t kDigits = 8;

/// What all names of unfinished things beside `path` begin with; kDigits hexadecimal digits follow.
std::string unfinished_stem(const fs::path& path) {
  return "." + path.filename().string().substr(0, kMostStem) + ".clray-";
}

bool is_unfinished(const std::string& name, const std::string& stem) {
  return name.size() == stem.size() + kDigits && name.compare(0, stem.size(), stem) == 0 &&
         name.find_first_not_of("0123456789abcdef", stem.size()) == std::string::npos;
}

/// A file or folder of this user that nobody else has locked, locked; else -1. Links are not followed.
int lock_leftover(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  if (file >= 0 && ::fstat(file, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) &&
      status.st_uid == ::geteuid() && ::flock(file, LOCK_EX | LOCK_NB) == 0)
    return file;
  if (file >= 0) ::close(file);
  return -1;
}

struct Notes {
  std::mutex mutex;
  std::multiset<std::string> paths;
};

Notes& notes() {
  static auto* const all = new Notes;  // never destroyed: threads may outlive main()
  return *all;
}

}  // namespace

Temporary::Temporary(const std::string& path) : path_(path) {
  const auto lock = hold_temporaries();
  notes().paths.insert(path_);
}

Temporary::~Temporary() {
  const auto lock = hold_temporaries();
  notes().paths.erase(notes().paths.find(path_));
}

Unfinished::~Unfinished() {
  if (!path_.empty()) ::unlink(path_.c_str());
  if (lock_ >= 0) ::close(lock_);
}

int Unfinished::make(const std::string& path, Kind kind) {
  const fs::path parent = fs::path(path).parent_path();
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string name = (parent / (unfinished_stem(path) + hex16(random()).substr(16 - kDigits))).string();
    // Not mkdtemp and mkstemp, because what is made shall have the permissions that the process gives.
    const int made = kind == Kind::folder ? ::mkdir(name.c_str(), 0777)
                                          : ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (made < 0 && errno != EEXIST) return errno;
    if (made < 0) continue;
    const int file = kind == Kind::folder ? ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC) : made;
    // Another process may take it for a leftover before it is locked. Where a file system has no locks, none does.
    const bool lost = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (lost || ::access(name.c_str(), F_OK) != 0) {
      if (file >= 0) ::close(file);
      continue;
    }
    lock_ = file;
    path_ = name;
    note_.emplace(name);
    return 0;
  }
  return EEXIST;
}

void remove_unfinished(const std::string& path) noexcept {
  try {
    const std::string stem = unfinished_stem(path);
    const fs::path parent = fs::path(path).parent_path();
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(parent.empty() ? "." : parent)) {
      if (is_unfinished(entry.path().filename().string(), stem)) left.push_back(entry.path());
    }
    for (const fs::path& one : left) {
      const int lock = lock_leftover(one);
      if (lock < 0) continue;
      std::error_code ignored;
      fs::remove_all(one, ignored);
      ::close(lock);
    }
  } catch (const std::exception&) {
    // A folder that cannot be read is not cleaned.
  }
}

std::unique_lock<std::mutex> hold_temporaries() {
  return std::unique_lock<std::mutex>(notes().mutex);
}

void remove_temporaries_for_good() noexcept {
  notes().mutex.lock();
  constexpr int kAttempts = 20;  // another thread may still write into a folder while it is emptied
  for (const std::string& path : notes().paths) {
    std::error_code error;
    for (int k = 0; k < kAttempts && std::filesystem::exists(std::filesystem::symlink_status(path, error)); ++k)
      std::filesystem::remove_all(path, error);
  }
}

}  // namespace clray::text
