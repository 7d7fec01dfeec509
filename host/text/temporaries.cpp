// SPDX-License-Identifier: Apache-2.0
// See temporaries.hpp.
#include "text/temporaries.hpp"

#include <filesystem>
#include <set>

namespace clray::text {

namespace {

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
