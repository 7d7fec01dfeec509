// SPDX-License-Identifier: Apache-2.0
// Checked writing; see output_file.hpp.
#include "text/output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "clray/error.hpp"
#include "text/text.hpp"

namespace clray::text {

void fail_output(const std::string& what, const std::string& path, int system_error) {
  const std::string reason = system_error ? std::strerror(system_error) : "unknown reason (is the disk full?)";
  throw Error(ErrorCode::output, "cannot " + what + " " + shown(path) + ": " + reason);
}

OutputFile::OutputFile(const std::string& path) : path_(path) {
  errno = 0;
  file_ = std::fopen(path.c_str(), "wb");
  if (!file_) fail_output("write", path, errno);
}

OutputFile::~OutputFile() {
  if (!file_) return;
  std::fclose(file_);
  discard_output_file(path_);
}

void OutputFile::put(std::string_view bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail_output("write", path_, errno);
}

void OutputFile::close() {
  errno = 0;
  const bool failed = std::fclose(file_) != 0;
  file_ = nullptr;
  if (!failed) return;
  const int code = errno;
  discard_output_file(path_);
  fail_output("write", path_, code);
}

void write_output_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.put(bytes);
  file.close();
}

void discard_output_file(const std::string& path) noexcept {
  ::unlink(path.c_str());
}

}  // namespace clray::text
