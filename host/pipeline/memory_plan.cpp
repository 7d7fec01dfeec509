// SPDX-License-Identifier: Apache-2.0
// See memory_plan.hpp.
#include "pipeline/memory_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "device/device_impl.hpp"
#include "pipeline/pass_buffers.hpp"
#include "pipeline/saved_sums.hpp"

namespace clray {
namespace {

constexpr double kProgram = 300e6;  // the program, drivers and their compilers
constexpr double kOfNumber = 40.0;  // bytes of a number of the results, while files are written
constexpr double kOfFace = 280.0;   // bytes of a face, most of them while its place in the tree is found
constexpr double kLeastSlab = 4e6;  // below which devices would have too little to do
constexpr double kMegabyte = 1e6;

double sums_bytes(const PassPlan& plan) {
  return 8.0 * static_cast<double>(plan.layout.values) + 4.0 * static_cast<double>(plan.layout.counts);
}

bool is_wide(const PassPlan& plan) {
  const auto found = plan.program.options.defines.find("CLRAY_WIDE");
  return found != plan.program.options.defines.end() && found->second == "1";
}

/// What a device is given to read. One that works in the host's memory reads the body and strata where they stand.
double tables_bytes(const PassPlan& plan, const Geometry& geometry, bool shared) {
  PassBuffers in(plan, geometry);
  if (shared) in.primitives.count = in.shapes.count = in.nodes.count = in.leaves.count = in.strata.count = 0;
  double bytes = 0.0;
#define CLRAY_ADD(type, name) \
  if (in.name.data != nullptr) bytes += static_cast<double>(in.name.count * sizeof(*in.name.data));
  CLRAY_BUFFERS(CLRAY_ADD)
#undef CLRAY_ADD
  return bytes;
}

std::string shown(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", std::ceil(bytes / kMegabyte)) : fmt::format("{:.1f} GB", bytes * 1e-9);
}

std::string help_with(const std::string& what) {
  if (what == "strata") return "sampler = \"sobol\" has no strata (--sampler sobol)";
  if (what == "the body") return "fewer faces would help";
  if (what == "the program") return "that is the least";
  return "fewer orientations, bins, pixels, bands or trace.replicates would help";
}

}  // namespace

double MemoryPlan::host() const {
  double all = 0.0;
  for (const auto& [what, bytes] : of_host) all += bytes;
  return all;
}

MemoryPlan memory_plan(const Scene& scene, const Geometry& geometry, const std::vector<PassPlan>& plans,
                       double slab_bytes, bool shared) {
  MemoryPlan all;
  double sums = 0.0, largest = 0.0, strata = 0.0, results = 0.0;
  for (const PassPlan* plan : passes_of(plans)) {
    const double own = sums_bytes(*plan);
    const double on_device = plan->request.without_rays() ? own : std::min(own, slab_bytes);
    // Passes follow each other, and what they found stays for files of sums until the end. Beside the sums of one there
    // are those of its open step, or of which its result is made, and those of its confirmation beside its search.
    sums += own;
    largest = std::max(largest, own);
    strata += static_cast<double>(plan->beams.strata.size() * sizeof(ClrayStratum));
    results += kOfNumber * static_cast<double>(plan->layout.values + plan->layout.counts) / plan->request.replicates;
    const double device = tables_bytes(*plan, geometry, shared) + on_device * (is_wide(*plan) ? 2.0 : 1.0);
    all.device = std::max(all.device, device);
  }
  const bool searches = scene.trace.rays == 0 && scene.trace.method != Method::exact;
  all.of_host = {{"the program", kProgram},
                 {"the body", kOfFace * static_cast<double>(geometry.primitives.size())},
                 {"strata", strata},
                 {"sums", sums + (searches ? 2.0 : 1.0) * largest},
                 {"results", results}};
  return all;
}

std::size_t views_of_slab(const PassPlan& plan, double slab_bytes) {
  const auto views = static_cast<double>(plan.layout.shape.views);
  const double bytes = sums_bytes(plan);
  if (plan.request.without_rays() || bytes <= slab_bytes) return plan.layout.shape.views;
  return static_cast<std::size_t>(std::max(1.0, std::floor(slab_bytes * views / bytes)));
}

void fit_memory(Device& device, const Scene& scene, const Geometry& geometry, std::vector<PassPlan>* plans) {
  const Device::Impl& impl = device.impl();
  double slab = impl.slab_bytes;
  const auto limit = static_cast<double>(impl.memory_bytes);
  if (limit > 0.0) {
    const bool together = impl.devices.front().info.type != "gpu", shared = impl.devices.front().shares_memory;
    const auto over = [&] {
      const MemoryPlan plan = memory_plan(scene, geometry, *plans, slab, shared);
      return std::max(plan.device, plan.host() + (together ? plan.device : 0.0)) > limit;
    };
    while (over() && slab > kLeastSlab) slab /= 2.0;
    if (over()) {
      const MemoryPlan plan = memory_plan(scene, geometry, *plans, slab, shared);
      const auto largest = std::max_element(plan.of_host.begin(), plan.of_host.end(),
                                            [](const auto& a, const auto& b) { return a.second < b.second; });
      std::string parts = fmt::format("{} on the device", shown(plan.device));
      for (const auto& [what, bytes] : plan.of_host) parts += fmt::format(", {} {}", what, shown(bytes));
      throw Error(ErrorCode::usage,
                  fmt::format("the run may take {}, and {} are allowed: {}; {}", shown(plan.host() + plan.device),
                              shown(limit), parts, help_with(largest->first)),
                  "memory");
    }
  }
  for (PassPlan& plan : *plans) plan.slab_views = views_of_slab(plan, slab);
}

}  // namespace clray
