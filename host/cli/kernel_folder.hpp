// SPDX-License-Identifier: Apache-2.0
// The folder where PoCL keeps compiled kernels. PoCL loads what it finds there as code, without a look. So the folder
// must be the user's own, and what changed since it was written is removed: then it is built again.
#pragma once

#include <memory>
#include <string>

#include "text/temporaries.hpp"

namespace clray::cli {

/// Chooses the folder, and guards it if it is clray's own: a list beside the kernels has a checksum of every file.
/// Processes that use the folder hold a lock on the list together; what is not listed, because a process was killed, is
/// removed only where no other process may be writing it.
class KernelFolder {
 public:
  KernelFolder();
  ~KernelFolder();
  KernelFolder(const KernelFolder&) = delete;
  KernelFolder& operator=(const KernelFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Why the folder that was asked for, or the usual one, is not taken; empty where it is.
  const std::string& trouble() const { return trouble_; }
  /// Lists what was written meanwhile.
  void note_files() noexcept;

 private:
  void take_temporary(const std::string& why);
  void remove_changed();

  std::string path_, trouble_;
  std::unique_ptr<text::Temporary> noted_;  // of a temporary folder
  bool guarded_ = false;
  int lock_ = -1;
};

}  // namespace clray::cli
