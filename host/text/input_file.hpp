// SPDX-License-Identifier: Apache-2.0
// Opens and reads the files that users name. Only regular files are read: a pipe would be waited for, and a device such
// as /dev/zero never ends.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

namespace clray::text {

/// Why `path` is no file to read, or "": "there is no such file", "is a folder; a file was expected", …
std::string input_file_fault(const std::string& path);

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, FileCloser>;

/// Opens a regular file. Throws Error(input) with the path as context.
InputFile open_input(const std::string& path);

/// Bytes of an open regular file.
std::uint64_t size_of(const InputFile& file);

/// All bytes of a regular file. Throws Error(input) with the path as context.
std::string read_input_file(const std::string& path);

}  // namespace clray::text
