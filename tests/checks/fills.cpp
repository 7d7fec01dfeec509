// SPDX-License-Identifier: Apache-2.0
// Loaded before Oclgrind 21.10 (LD_PRELOAD) by tests/checks/races: its check for uninitialised values does not see what
// clEnqueueFillBuffer has set, and so reports every sum that begins with a buffer of zeros. Here fills are writes.
#include <CL/cl.h>

#include <cstring>
#include <vector>

#pragma GCC visibility push(default)
extern "C" cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t pattern_size,
                                      size_t offset, size_t size, cl_uint count, const cl_event* events,
                                      cl_event* event) {
  std::vector<char> bytes(size);
  for (size_t at = 0; at < size; at += pattern_size) std::memcpy(bytes.data() + at, pattern, pattern_size);
  return clEnqueueWriteBuffer(queue, buffer, CL_TRUE, offset, size, bytes.data(), count, events, event);
}
#pragma GCC visibility pop
