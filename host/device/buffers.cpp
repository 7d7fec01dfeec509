// SPDX-License-Identifier: Apache-2.0
// See buffers.hpp.
#include "device/buffers.hpp"

#include <fmt/format.h>

namespace clray {

void check_buffer_size(OpenedDevice& opened, double bytes, const char* what, const char* fewer) {
  const double limit = with_cl_errors(
      opened.info.name, [&] { return static_cast<double>(opened.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>()); });
  if (bytes > limit)
    throw Error(ErrorCode::input,
                fmt::format("{} need {:.3g} GiB in one buffer, {} gives at most {:.3g}: fewer {} are needed", what,
                            bytes / 1073741824.0, opened.info.name, limit / 1073741824.0, fewer));
}

}  // namespace clray
