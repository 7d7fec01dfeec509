// SPDX-License-Identifier: Apache-2.0
// See zero_pages.hpp.
#include "device/zero_pages.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace clray {

void* ZeroPages::map(std::size_t bytes) {
  void* const data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  return data;
}

void ZeroPages::unmap(void* data, std::size_t bytes) noexcept {
  munmap(data, bytes);
}

void ZeroPages::clear(void* first, std::size_t bytes) {
  constexpr std::size_t kMany = 1u << 18;  // below it, giving pages back costs more than it saves
  static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  char* const begin = static_cast<char*>(first);
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
  const std::size_t whole = bytes > before ? (bytes - before) / page * page : 0;
  if (whole < kMany || madvise(begin + before, whole, MADV_DONTNEED) != 0) {
    std::memset(begin, 0, bytes);
    return;
  }
  std::memset(begin, 0, before);
  std::memset(begin + before + whole, 0, bytes - before - whole);
}

}  // namespace clray
