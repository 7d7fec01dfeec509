// SPDX-License-Identifier: Apache-2.0
// Small helpers about buffers and launches on an opened device. Sizes are in elements unless named bytes. Every
// failure is a clray::Error(device).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "device/device_impl.hpp"

namespace clray {

/// Throws Error(input) if the device cannot hold so many bytes in one buffer: `what` need them, with `fewer` of
/// something they would need less.
void check_buffer_size(OpenedDevice& opened, double bytes, const char* what, const char* fewer);

/// The same for the sums of a pass.
inline void check_sums_size(OpenedDevice& opened, std::uint64_t sums) {
  check_buffer_size(opened, 8.0 * static_cast<double>(sums), "the detectors",
                    "bins, pixels, orientations or wavelengths");
}

/// An uninitialised buffer of `count` elements, or of one if count is 0, as OpenCL knows no empty buffer.
template <class T>
cl::Buffer make_buffer(OpenedDevice& opened, std::size_t count, cl_mem_flags flags = CL_MEM_READ_WRITE) {
  return with_cl_errors(opened.info.name,
                        [&] { return cl::Buffer(opened.context, flags, std::max<std::size_t>(count, 1) * sizeof(T)); });
}

/// Copies `values` into the buffer, from element `first` on; returns when done.
template <class T>
void write_buffer(OpenedDevice& opened, const cl::Buffer& buffer, const std::vector<T>& values, std::size_t first = 0) {
  if (values.empty()) return;
  with_cl_errors(opened.info.name, [&] {
    opened.queue.enqueueWriteBuffer(buffer, CL_TRUE, first * sizeof(T), values.size() * sizeof(T), values.data());
  });
}

/// Queues a copy of `count` elements into the buffer; `values` must stay until finish().
template <class T>
void queue_write(OpenedDevice& opened, const cl::Buffer& buffer, const T* values, std::size_t count) {
  if (count == 0) return;
  with_cl_errors(opened.info.name,
                 [&] { opened.queue.enqueueWriteBuffer(buffer, CL_FALSE, 0, count * sizeof(T), values); });
}

/// A buffer that holds a copy of `count` elements.
template <class T>
cl::Buffer make_buffer(OpenedDevice& opened, const T* values, std::size_t count,
                       cl_mem_flags flags = CL_MEM_READ_ONLY) {
  cl::Buffer buffer = make_buffer<T>(opened, count, flags);
  if (count == 0) return buffer;
  with_cl_errors(opened.info.name,
                 [&] { opened.queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values); });
  return buffer;
}

/// Elements of the host as a buffer, for a device that shares its memory: they are not copied, and must stay.
template <class T>
cl::Buffer buffer_of(OpenedDevice& opened, const T* values, std::size_t count) {
  return with_cl_errors(opened.info.name, [&] {
    return cl::Buffer(opened.context, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, count * sizeof(T),
                      const_cast<T*>(values));
  });
}

/// A buffer that holds a copy of `values`.
template <class T>
cl::Buffer make_buffer(OpenedDevice& opened, const std::vector<T>& values, cl_mem_flags flags = CL_MEM_READ_ONLY) {
  return make_buffer(opened, values.data(), values.size(), flags);
}

/// Sets `count` elements from element `first` on to zero bytes (in queue order; does not wait).
template <class T>
void zero_buffer(OpenedDevice& opened, const cl::Buffer& buffer, std::size_t count, std::size_t first = 0) {
  static_assert(sizeof(T) % 4 == 0, "filled by 32-bit words");
  if (count == 0) return;
  with_cl_errors(opened.info.name,
                 [&] { opened.queue.enqueueFillBuffer(buffer, cl_uint{0}, first * sizeof(T), count * sizeof(T)); });
}

/// A buffer of `count` zeros.
template <class T>
cl::Buffer make_zero_buffer(OpenedDevice& opened, std::size_t count) {
  cl::Buffer buffer = make_buffer<T>(opened, count);
  zero_buffer<T>(opened, buffer, std::max<std::size_t>(count, 1));
  return buffer;
}

/// `count` elements from element `first` on; waits for all work queued before.
template <class T>
std::vector<T> read_buffer(OpenedDevice& opened, const cl::Buffer& buffer, std::size_t count, std::size_t first = 0) {
  std::vector<T> values(count);
  if (count == 0) return values;
  with_cl_errors(opened.info.name, [&] {
    opened.queue.enqueueReadBuffer(buffer, CL_TRUE, first * sizeof(T), count * sizeof(T), values.data());
  });
  return values;
}

/// The kernel `name` of a program.
inline cl::Kernel make_kernel(OpenedDevice& opened, const cl::Program& program, const char* name) {
  return with_cl_errors(opened.info.name, [&] { return cl::Kernel(program, name); });
}

/// Sets all arguments of a kernel in order: buffers, cl::Local(bytes), and scalars or structs of exactly the kernel's
/// type.
template <class... Arguments>
void set_arguments(OpenedDevice& opened, cl::Kernel& kernel, const Arguments&... arguments) {
  with_cl_errors(opened.info.name, [&] {
    cl_uint index = 0;
    (kernel.setArg(index++, arguments), ...);
  });
}

/// Queues a one-dimensional launch of at least `items` work-items in groups of `group` (the kernel checks its id
/// against the count: the last group is full), or as many as the device can run of this kernel. The caller fixes
/// `group`: some drivers compile once per local size.
inline cl::Event launch(OpenedDevice& opened, const cl::Kernel& kernel, std::size_t items, std::size_t group) {
  return with_cl_errors(opened.info.name, [&] {
    cl::Event event;
    const auto most = kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(opened.device);
    group = std::clamp<std::size_t>(most, 1, group);
    const std::size_t global = (std::max<std::size_t>(items, 1) + group - 1) / group * group;
    opened.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(global), cl::NDRange(group), nullptr, &event);
    return event;
  });
}

/// Waits for a launch; the seconds it ran on the device.
inline double seconds_of(OpenedDevice& opened, const cl::Event& event) {
  return with_cl_errors(opened.info.name, [&] {
    event.wait();
    const cl_ulong start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const cl_ulong end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    return 1e-9 * static_cast<double>(end - start);
  });
}

/// Waits for everything queued.
inline void finish(OpenedDevice& opened) {
  with_cl_errors(opened.info.name, [&] { opened.queue.finish(); });
}

}  // namespace clray
