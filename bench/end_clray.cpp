// SPDX-License-Identifier: Apache-2.0
// See end_methods.hpp: what clray itself offers.
#include <algorithm>
#include <iterator>

#include "clray/trace.hpp"
#include "end_methods.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

namespace {

Answer answer_of(const clray::Result& result) {
  const clray::DelayResult& d = result.delay.at(0);
  return {d.intensity_m2_per_sr.value, d.bin_m2_per_sr, result.seconds.trace, result.seconds.bvh};
}

}  // namespace

std::vector<EndMethod> clray_methods(const EndCase& which, const std::vector<int>& log2_rays, clray::Device& device) {
  const auto sampled = [&which, &device](clray::Method method) {
    return [&which, &device, method](int effort, std::uint64_t seed) {
      clray::Scene scene = which.scene;
      clray_test::rays(scene, effort, seed);
      scene.trace.method = method;
      return answer_of(clray::trace(scene, device));
    };
  };
  const auto exact = [&which, &device](int, std::uint64_t) {
    clray::Scene scene = which.scene;
    scene.trace.method = clray::Method::exact;
    scene.trace.rays = 0;
    return answer_of(clray::trace(scene, device));
  };
  std::vector<int> log2_points;  // of tiles: more are dearer than the exact pulse
  std::copy_if(log2_rays.begin(), log2_rays.end(), std::back_inserter(log2_points), [](int k) { return k <= 22; });
  return {{"clray, exact", true, {0}, exact},
          {"clray, tiles", false, log2_points, sampled(clray::Method::tiles)},
          {"clray, points", false, log2_rays, sampled(clray::Method::points)}};
}

}  // namespace clray_bench
