// SPDX-License-Identifier: Apache-2.0
// Writes the files of a result. A file is whole or it is not there: every write and the closing are checked, and a file
// that was not closed without a fault is removed.
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

namespace clray::text {

/// Errors of the operating system as Error(output) "cannot <what> <path>: <reason>".
[[noreturn]] void fail_output(const std::string& what, const std::string& path, int system_error);

/// A file being written. All members throw Error(output).
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void put(std::string_view bytes);
  /// Forces to disk what was put.
  void sync();
  void close();

 private:
  std::string path_;
  std::FILE* file_ = nullptr;
};

/// A file of these bytes. Throws Error(output).
void write_output_file(const std::string& path, std::string_view bytes);

/// Why a folder, which is made if it is missing, has no room for a quarter of a megabyte; empty where it has.
std::string folder_fault(const std::string& folder);

/// Forces a file, or the entries of a folder, to disk. Throws Error(output).
void sync_to_disk(const std::string& path);

/// Puts a file at `path`, whole: `write` writes it beside it (see Unfinished), and it is forced to disk before it takes
/// the place. Throws Error(output), or what `write` throws; what stood there is then still there.
void replace_output_file(const std::string& path, const std::function<void(OutputFile&)>& write);
/// The same of a file of these bytes.
void replace_output_file(const std::string& path, std::string_view bytes);

/// Removes a file that a library left unfinished.
void discard_output_file(const std::string& path) noexcept;

}  // namespace clray::text
