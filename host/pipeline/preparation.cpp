// SPDX-License-Identifier: Apache-2.0
// See preparation.hpp.
#include "pipeline/preparation.hpp"

#include <algorithm>

#include "pipeline/memory_plan.hpp"

namespace clray {
namespace {

bool same(const Transform& a, const Transform& b) {
  return a.translate == b.translate && a.axis == b.axis && a.angle_rad == b.angle_rad && a.scale == b.scale;
}

// What a hinge follows, and its angle, are of a view.
bool same(const std::optional<Hinge>& a, const std::optional<Hinge>& b) {
  if (!a || !b) return !a && !b;
  return a->axis == b->axis && a->point == b->point;
}

bool same(const Component& a, const Component& b) {
  return a.shape == b.shape && a.parameters == b.parameters && a.mesh == b.mesh && a.materials == b.materials &&
         same(a.transform, b.transform) && same(a.hinge, b.hinge);
}

bool same(const std::vector<Component>& a, const std::vector<Component>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Component& x, const Component& y) { return same(x, y); });
}

}  // namespace

const Geometry& Preparation::body(const Scene& scene, bool trees) {
  std::optional<Kept>& kept = trees ? with_trees_ : without_;
  std::vector<std::uint32_t> ranks = material_ranks(scene);
  if (!kept || kept->material_ranks != ranks || !same(kept->components, scene.components)) {
    kept.reset();
    drop_passes();
    kept = Kept{scene.components, std::move(ranks), build_geometry(scene, trees ? TreeFaces::pieces : TreeFaces::none)};
  }
  if (on_devices_ != &kept->geometry) drop_passes();
  on_devices_ = &kept->geometry;
  return kept->geometry;
}

KeptPass* Preparation::pass(std::size_t number) {
  if (passes_.size() <= number) passes_.resize(number + 1);
  return &passes_[number];
}

Planned plan_scene(Preparation& kept, const Scene& scene) {
  const Geometry* geometry = &kept.body(scene, !may_need_no_rays(scene));
  std::vector<PassRequest> requests = pass_requests(scene, *geometry);
  const bool rays =
      std::any_of(requests.begin(), requests.end(), [](const PassRequest& r) { return !r.without_rays(); });
  if (rays && !geometry->trees) geometry = &kept.body(scene, true);
  std::vector<PassPlan> plans = plan_passes(scene, *geometry, std::move(requests));
  fit_to(kept.device(), kept.used_again(), &plans);
  fit_memory(kept.device(), scene, *geometry, &plans);
  return {*geometry, std::move(plans)};
}

}  // namespace clray
