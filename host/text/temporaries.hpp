// SPDX-License-Identifier: Apache-2.0
// Files and folders that stand only while something is being made. Whoever makes one notes it here, so that a program
// that must end at once can remove them all.
#pragma once

#include <mutex>
#include <string>

namespace clray::text {

/// The note of one path; it is forgotten at the end of the scope. The file itself is its maker's to remove.
class Temporary {
 public:
  explicit Temporary(const std::string& path);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

 private:
  std::string path_;
};

/// Held while a temporary path means something else for a moment, as when two folders change places.
std::unique_lock<std::mutex> hold_temporaries();

/// Removes all that is noted, for a process that ends then: nobody can note or hold anything any more.
void remove_temporaries_for_good() noexcept;

}  // namespace clray::text
