// SPDX-License-Identifier: Apache-2.0
// Memory of the host that comes from the system as zeros, page by page when it is written to, and goes back at once:
// what large runs no longer need makes room for what follows. Heaps keep freed blocks below others that are in use.
#pragma once

#include <cstddef>
#include <new>

namespace clray {

class ZeroPages {
 public:
  /// Throws std::bad_alloc.
  explicit ZeroPages(std::size_t bytes) : bytes_(bytes), data_(map(bytes)) {}
  ~ZeroPages() { unmap(data_, bytes_); }
  ZeroPages(const ZeroPages&) = delete;
  ZeroPages& operator=(const ZeroPages&) = delete;

  void* data() const { return data_; }

  /// Makes bytes zero again. Of many, the pages go back.
  static void clear(void* first, std::size_t bytes);
  static void* map(std::size_t bytes);
  static void unmap(void* data, std::size_t bytes) noexcept;

 private:
  std::size_t bytes_;
  void* data_;
};

/// Gives containers such memory where they ask for much.
template <class T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <class Other>
  PageAllocator(const PageAllocator<Other>&) {}

  static bool much(std::size_t count) { return count * sizeof(T) >= 1u << 16; }
  T* allocate(std::size_t count) {
    return static_cast<T*>(much(count) ? ZeroPages::map(count * sizeof(T)) : ::operator new(count * sizeof(T)));
  }
  void deallocate(T* data, std::size_t count) noexcept {
    much(count) ? ZeroPages::unmap(data, count * sizeof(T)) : ::operator delete(data);
  }
  bool operator==(const PageAllocator&) const { return true; }
  bool operator!=(const PageAllocator&) const { return false; }
};

}  // namespace clray
