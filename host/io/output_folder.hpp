// SPDX-License-Identifier: Apache-2.0
// A result's folder that appears whole or not at all: everything is written into a temporary sibling, forced to
// disk, then renamed. An older result stays until its successor is complete.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "text/temporaries.hpp"

namespace clray::io {

/// One folder being written. Removed with all it holds unless commit() has returned or keep() was called. Of a folder
/// that was replaced the result's own files are removed, and nothing else.
class OutputFolder {
 public:
  /// Makes the temporary folder beside `target`. Throws Error(output), also where something that is not a clray
  /// result, or that holds files clray did not write, stands at `target`.
  explicit OutputFolder(const std::string& target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where a file is to be written.
  std::string path(const std::string& file) const { return unfinished_.path() + "/" + file; }
  const std::string& folder() const { return unfinished_.path(); }

  /// Forces everything to disk and puts it in place. Throws Error(output); the old result is then still there.
  void commit();
  /// Leaves what is written beside the target, since it cannot be put in place. Returns the folder, or "" if it is
  /// empty.
  std::string keep() noexcept;

 private:
  void remove_leftovers() noexcept;

  std::filesystem::path target_;
  text::Unfinished unfinished_;
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
  bool done_ = false, kept_ = false;
};

}  // namespace clray::io
