// SPDX-License-Identifier: Apache-2.0
// check_windows(), see clray/sizes.hpp: the automatic window of a delay histogram follows from the body and the views,
// which only a plan knows.
#include <algorithm>

#include "body/geometry.hpp"
#include "clray/error.hpp"
#include "clray/sizes.hpp"
#include "pipeline/plan.hpp"

namespace clray {
namespace {

bool follows_the_body(const DetectorSpec& d) {
  const auto given = [&](const char* key) { return d.parameters.count(key) > 0; };
  return given("bin_ps") && !(given("start_ns") && given("stop_ns"));
}

/// Of the host's and the device's sums together.
double bytes_of(const SumLayout& layout) {
  return 2.0 * (8.0 * static_cast<double>(layout.values) + 4.0 * static_cast<double>(layout.counts));
}

}  // namespace

void check_windows(const Scene& scene) {
  check_scene(scene);
  const auto found = std::find_if(scene.detectors.begin(), scene.detectors.end(), follows_the_body);
  if (found == scene.detectors.end()) return;
  const Geometry geometry = build_geometry(scene);
  for (PassRequest& request : pass_requests(scene, geometry)) {
    const PassPlan plan = plan_pass(scene, geometry, std::move(request), false);
    if (const std::string fault = memory_fault(bytes_of(plan.layout)); !fault.empty())
      throw Error(ErrorCode::input, fault, member_of(scene, *found) + ".bin_ps");
  }
}

}  // namespace clray
