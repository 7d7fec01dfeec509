// SPDX-License-Identifier: Apache-2.0
// Files and folders that stand only while something is being made. Whoever makes one notes it here, so that a program
// that must end at once can remove them all. What a killed program left is told by its name, and removed by the next.
#pragma once

#include <mutex>
#include <optional>
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

/// What is being made to take the place of `path`, beside it, under a name that nobody else has:
/// `.NAME.clray-xxxxxxxx`. It is noted, and locked as long as this stands, so that no other process takes it for a
/// leftover.
class Unfinished {
 public:
  enum class Kind { file, folder };
  Unfinished() = default;
  /// A file goes with this unless it was renamed. A folder is its maker's to remove.
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  /// Makes it, empty. Returns an errno or 0.
  int make(const std::string& path, Kind kind);
  const std::string& path() const { return path_; }
  /// It is something else from now on: what stands at its path is no longer removed when the program ends at once.
  void forget() { note_.reset(); }

 private:
  std::string path_;
  int lock_ = -1;
  std::optional<Temporary> note_;
};

/// Removes what processes of this user that are gone left unfinished beside `path`: what has such a name and no lock.
void remove_unfinished(const std::string& path) noexcept;

/// Held while a temporary path means something else for a moment, as when two folders change places.
std::unique_lock<std::mutex> hold_temporaries();

/// Removes all that is noted, for a process that ends then: nobody can note or hold anything any more.
void remove_temporaries_for_good() noexcept;

}  // namespace clray::text
