// SPDX-License-Identifier: Apache-2.0
// The numbers of a plan as the kernels take them: one member for each row of shared/buffers.h. A device and the host's
// own pass both take them from here.
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

#include "pipeline/plan.hpp"
#include "shared/buffers.h"

namespace clray {

/// `count` numbers from `data` on, owned by others. Null stands for as many zeros, to which a pass adds.
template <class T>
struct Numbers {
  const T* data = nullptr;
  std::size_t count = 0;
};

/// The numbers of all views, in order.
std::vector<std::uint32_t> all_views(const PassPlan& plan);

/// The buffers of a pass. Plan and geometry must outlive it.
class PassBuffers {
 public:
  PassBuffers(const PassPlan& plan, const Geometry& geometry);
  PassBuffers(const PassBuffers&) = delete;
  PassBuffers& operator=(const PassBuffers&) = delete;

#define CLRAY_MEMBER(type, name) Numbers<std::remove_cv_t<type>> name;
  CLRAY_BUFFERS(CLRAY_MEMBER)
#undef CLRAY_MEMBER

 private:
  std::vector<ClrayBlock> own_blocks_;
  std::vector<ClrayDetector> own_detectors_;
  std::vector<double> own_settings_;
  std::vector<std::uint32_t> own_directions_, own_asked_;
};

}  // namespace clray
