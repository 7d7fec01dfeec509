// SPDX-License-Identifier: Apache-2.0
// Beside faults.cpp: devices with work-groups of at most CLRAY_FAULT_GROUP work-items, and such that fail. From the
// launch of this number on (CLRAY_FAULT_LAUNCH, from 1) the device of that launch has failed, and none of its launches,
// reads, writes and mappings succeeds any more. CLRAY_FAULT_LAUNCHES is a file that gets the number of launches.
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#include <atomic>

namespace {

std::atomic<long> launches{0};
std::atomic<cl_command_queue> broken{nullptr};

struct Launches {
  ~Launches() {
    const char* name = getenv("CLRAY_FAULT_LAUNCHES");
    FILE* file = name != nullptr && launches > 0 ? fopen(name, "w") : nullptr;
    if (file == nullptr) return;
    fprintf(file, "%ld\n", launches.load());
    fclose(file);
  }
} at_the_end;

/// Of a work-group; 0: as many as there are.
size_t most_items() {
  const char* most = getenv("CLRAY_FAULT_GROUP");
  return most != nullptr ? static_cast<size_t>(atol(most)) : 0;
}

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                              const size_t* global, const size_t* local, cl_uint count, const cl_event* events,
                              cl_event* event) {
  const char* at = getenv("CLRAY_FAULT_LAUNCH");
  if (++launches == (at != nullptr ? atol(at) : 0)) broken = queue;
  if (queue == broken.load()) return CL_OUT_OF_RESOURCES;
  if (most_items() != 0 && local != nullptr && local[0] > most_items()) return CL_INVALID_WORK_GROUP_SIZE;
  return real<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel")(queue, kernel, dimensions, offset, global,
                                                                          local, count, events, event);
}

cl_int clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info name, size_t size,
                                void* value, size_t* written) {
  const cl_int status =
      real<decltype(clGetKernelWorkGroupInfo)>("clGetKernelWorkGroupInfo")(kernel, device, name, size, value, written);
  if (status == CL_SUCCESS && name == CL_KERNEL_WORK_GROUP_SIZE && value != nullptr && most_items() != 0)
    *static_cast<size_t*>(value) = most_items();
  return status;
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                           void* data, cl_uint count, const cl_event* events, cl_event* event) {
  if (queue == broken.load()) return CL_OUT_OF_RESOURCES;
  return real<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer")(queue, buffer, blocking, offset, size, data, count,
                                                                    events, event);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                            const void* data, cl_uint count, const cl_event* events, cl_event* event) {
  if (queue == broken.load()) return CL_OUT_OF_RESOURCES;
  return real<decltype(clEnqueueWriteBuffer)>("clEnqueueWriteBuffer")(queue, buffer, blocking, offset, size, data,
                                                                      count, events, event);
}

void* clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags, size_t offset,
                         size_t size, cl_uint count, const cl_event* events, cl_event* event, cl_int* status) {
  if (queue == broken.load()) {
    if (status != nullptr) *status = CL_OUT_OF_RESOURCES;
    return nullptr;
  }
  return real<decltype(clEnqueueMapBuffer)>("clEnqueueMapBuffer")(queue, buffer, blocking, flags, offset, size, count,
                                                                  events, event, status);
}
}
#pragma GCC visibility pop
