// SPDX-License-Identifier: Apache-2.0
// Regular files alone; see input_file.hpp. A file is opened without waiting and looked at when it is open, so that
// nothing can be put in its place between the two.
#include "text/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "clray/error.hpp"

namespace clray::text {

namespace {

std::string kind_fault(const struct stat& status) {
  if (S_ISREG(status.st_mode)) return "";
  return S_ISDIR(status.st_mode) ? "is a folder; a file was expected"
                                 : "is a device or pipe; a regular file was expected";
}

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw Error(ErrorCode::input, message, path);
}

std::string reason(int code) {
  return std::string("cannot be read: ") + std::strerror(code);
}

}  // namespace

std::string input_file_fault(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) return kind_fault(status);
  return errno == ENOENT || errno == ENOTDIR ? "there is no such file" : reason(errno);
}

InputFile open_input(const std::string& path) {
  const int handle = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (handle < 0) fail(path, reason(errno));
  struct stat status {};
  const std::string fault = ::fstat(handle, &status) != 0 ? reason(errno) : kind_fault(status);
  std::FILE* file = fault.empty() ? ::fdopen(handle, "rb") : nullptr;
  if (file == nullptr) {
    const int code = errno;
    ::close(handle);
    fail(path, fault.empty() ? reason(code) : fault);
  }
  return InputFile(file);
}

std::uint64_t size_of(const InputFile& file) {
  struct stat status {};
  ::fstat(::fileno(file.get()), &status);
  return static_cast<std::uint64_t>(status.st_size);
}

std::string read_input_file(const std::string& path) {
  const InputFile file = open_input(path);
  std::string content(size_of(file) + 1, '\0');  // one more, to meet the end
  std::size_t done = 0;
  while (true) {
    done += std::fread(&content[done], 1, content.size() - done, file.get());
    if (std::ferror(file.get())) fail(path, reason(errno));
    if (done < content.size()) break;
    content.resize(2 * content.size());  // it has grown, or is of /proc, whose files have no size
  }
  content.resize(done);
  return content;
}

}  // namespace clray::text
