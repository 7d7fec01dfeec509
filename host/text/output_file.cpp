// SPDX-License-Identifier: Apache-2.0
// Checked writing; see output_file.hpp.
#include "text/output_file.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "clray/error.hpp"
#include "text/temporaries.hpp"
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

void OutputFile::sync() {
  errno = 0;
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail_output("write", path_, errno);
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

void replace_output_file(const std::string& path, const std::function<void(OutputFile&)>& write) {
  remove_unfinished(path);
  Unfinished beside;
  if (const int code = beside.make(path, Unfinished::Kind::file)) fail_output("write", path, code);
  OutputFile file(beside.path());
  write(file);
  file.sync();
  file.close();
  if (::rename(beside.path().c_str(), path.c_str()) != 0) fail_output("write", path, errno);
  const std::size_t slash = path.rfind('/');
  sync_to_disk(slash == std::string::npos ? "." : path.substr(0, slash + 1));
}

void replace_output_file(const std::string& path, std::string_view bytes) {
  replace_output_file(path, [&](OutputFile& file) { file.put(bytes); });
}

std::string folder_fault(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string name = folder + "/clray-probe-XXXXXX";
  const int file = ::mkstemp(name.data());
  if (file < 0) return std::strerror(errno);
  const std::string bytes(1u << 18, 'c');
  errno = ENOSPC;  // where less than all is written
  const bool whole = ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  std::string reason = whole ? "" : std::strerror(errno);
  ::close(file);
  ::unlink(name.c_str());
  return reason;
}

void sync_to_disk(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_output("open", path, errno);
  // Some file systems cannot sync folders. The user's data are safe all the same.
  const bool failed = ::fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS;
  const int code = errno;
  ::close(descriptor);
  if (failed) fail_output("write", path, code);
}

void discard_output_file(const std::string& path) noexcept {
  ::unlink(path.c_str());
}

}  // namespace clray::text
