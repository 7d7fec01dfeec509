// SPDX-License-Identifier: Apache-2.0
// Numbers of a device that begin as zeros: kernels add to them, and the host takes what they found, which leaves zeros.
// A device that works in the host's memory adds to pages of the host. Such a page takes memory only from when something
// is added to it until that is taken, so that numbers are nowhere twice. Sizes are in elements unless named bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "device/buffers.hpp"
#include "device/zero_pages.hpp"

namespace clray {

/// A buffer of zeros. Pages: those that the buffer stands in; null where the device has memory of its own.
struct Zeros {
  std::shared_ptr<ZeroPages> pages;
  cl::Buffer buffer;  // goes before its pages
};

template <class T>
Zeros make_zeros(OpenedDevice& opened, std::size_t count) {
  if (!opened.shares_memory) return {nullptr, make_zero_buffer<T>(opened, count)};
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(T);
  Zeros zeros{std::make_shared<ZeroPages>(bytes), {}};
  zeros.buffer = with_cl_errors(opened.info.name, [&] {
    return cl::Buffer(opened.context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, zeros.pages->data());
  });
  return zeros;
}

/// Calls take(at, numbers, n) with pieces of `count` elements from element `first` on, where each begins and how many
/// it has, and makes them zero again. Waits for all work queued before.
template <class T, class Take>
void take_zeros(OpenedDevice& opened, const Zeros& zeros, std::uint64_t first, std::uint64_t count, Take&& take) {
  constexpr std::uint64_t kPiece = 1u << 18;  // small enough that memory is reused and not mapped anew
  for (std::uint64_t at = first; at < first + count; at += kPiece) {
    const std::size_t now = std::min(kPiece, first + count - at);
    if (zeros.pages == nullptr) {
      take(at, read_buffer<T>(opened, zeros.buffer, now, at).data(), now);
      zero_buffer<T>(opened, zeros.buffer, now, at);
      continue;
    }
    with_cl_errors(opened.info.name, [&] {
      void* const mapped = opened.queue.enqueueMapBuffer(zeros.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE,
                                                         at * sizeof(T), now * sizeof(T));
      take(at, static_cast<const T*>(mapped), now);
      ZeroPages::clear(mapped, now * sizeof(T));
      opened.queue.enqueueUnmapMemObject(zeros.buffer, mapped);
    });
  }
}

/// Makes `count` elements from element `first` on zero again.
template <class T>
void clear_zeros(OpenedDevice& opened, const Zeros& zeros, std::uint64_t first, std::uint64_t count) {
  // Filling pages would make all of them take memory.
  if (zeros.pages != nullptr) return take_zeros<T>(opened, zeros, first, count, [](std::uint64_t, const T*, auto) {});
  zero_buffer<T>(opened, zeros.buffer, count, first);
}

}  // namespace clray
