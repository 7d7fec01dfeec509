// SPDX-License-Identifier: Apache-2.0
// What a run takes of memory, known before it traces: tables and sums of its passes, results, a file of sums. Devices
// hold the sums of some views at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "body/geometry.hpp"
#include "clray/device.hpp"
#include "clray/scene.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// Bytes, by what takes them.
struct MemoryPlan {
  double device = 0.0;                                  ///< of each device: what kernels read and add to
  std::vector<std::pair<std::string, double>> of_host;  ///< what else there is

  double host() const;
};

/// What passes take while `slab_bytes` of the sums of views are on a device, about. `shared`: the device works in the
/// memory of the host. An upper bound: sums of which most are zero take less.
MemoryPlan memory_plan(const Scene& scene, const Geometry& geometry, const std::vector<PassPlan>& plans,
                       double slab_bytes, bool shared);

/// How many views of a pass a device is to hold at once.
std::size_t views_of_slab(const PassPlan& plan, double slab_bytes);

/// Notes in the plans how many views a device holds at once. Throws Error(usage) where the memory that the device is
/// allowed does not suffice, saying what would help.
void fit_memory(Device& device, const Scene& scene, const Geometry& geometry, std::vector<PassPlan>* plans);

}  // namespace clray
