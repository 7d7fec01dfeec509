// SPDX-License-Identifier: Apache-2.0
// A library to be loaded before all others (LD_PRELOAD): the call of this number that writes, syncs, closes, makes or
// renames below a path fails, as on a full or broken disk. CLRAY_FAULT_IN is a part of the path, CLRAY_FAULT_AT the
// call's number from 1 on (0: none), CLRAY_FAULT_TOTAL a file that gets the number of calls and their kinds. With
// CLRAY_FAULT_KILLS the process is killed at that call instead.
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>

namespace {

std::atomic<long> calls{0};

bool meant(const char* path) {
  const char* part = getenv("CLRAY_FAULT_IN");
  return part != nullptr && path != nullptr && strstr(path, part) != nullptr;
}

bool meant(int file) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return meant(path);
}

enum Kind { WRITE, CLOSE, FLUSH, SYNC, RENAME, MKDIR, OPEN, KINDS };
const char* const kKinds[KINDS] = {"write", "close", "flush", "sync", "rename", "mkdir", "open"};
std::atomic<bool> met[KINDS];

/// Whether this call is the one that fails.
template <class Where>
bool fails(Kind kind, Where where, int code) {
  if (!meant(where)) return false;
  met[kind] = true;
  const char* at = getenv("CLRAY_FAULT_AT");
  if (++calls != (at != nullptr ? atol(at) : 0)) return false;
  if (getenv("CLRAY_FAULT_KILLS") != nullptr) raise(SIGKILL);
  errno = code;
  return true;
}

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

struct Total {
  /// Of clray alone: what it starts loads this library, too, and a sanitizer's symbolizer ends after it.
  ~Total() {
    if (strcmp(program_invocation_short_name, "clray") != 0) return;
    const char* name = getenv("CLRAY_FAULT_TOTAL");
    FILE* file = name != nullptr ? fopen(name, "w") : nullptr;
    if (file == nullptr) return;
    fprintf(file, "%ld\n", calls.load());
    for (int k = 0; k < KINDS; ++k) {
      if (met[k]) fprintf(file, "%s\n", kKinds[k]);
    }
    fclose(file);
  }
} total;

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  return fails(WRITE, file, ENOSPC) ? -1 : real<ssize_t(int, const void*, size_t)>("write")(file, bytes, count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  return fails(WRITE, file, ENOSPC) ? -1
                                    : real<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, count, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  return fails(WRITE, file, ENOSPC)
             ? -1
             : real<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, count, at);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  if (fails(WRITE, fileno(file), ENOSPC)) return 0;
  return real<size_t(const void*, size_t, size_t, FILE*)>("fwrite")(bytes, size, count, file);
}
int fclose(FILE* file) {
  const bool bad = fails(CLOSE, fileno(file), ENOSPC);
  const int result = real<int(FILE*)>("fclose")(file);
  if (!bad) return result;
  errno = ENOSPC;
  return EOF;
}
int fflush(FILE* file) {
  if (file != nullptr && fails(FLUSH, fileno(file), ENOSPC)) return EOF;
  return real<int(FILE*)>("fflush")(file);
}
int fsync(int file) {
  return fails(SYNC, file, EIO) ? -1 : real<int(int)>("fsync")(file);
}
int rename(const char* from, const char* to) {
  return fails(RENAME, to, EIO) ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  return fails(RENAME, to, EIO)
             ? -1
             : real<int(int, const char*, int, const char*, unsigned)>("renameat2")(a, from, b, to, flags);
}
int mkdir(const char* path, mode_t mode) {
  return fails(MKDIR, path, ENOSPC) ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
}
FILE* fopen(const char* path, const char* mode) {
  if (mode[0] != 'r' && fails(OPEN, path, ENOSPC)) return nullptr;
  return real<FILE*(const char*, const char*)>("fopen")(path, mode);
}
}
#pragma GCC visibility pop
