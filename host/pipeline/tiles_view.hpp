// SPDX-License-Identifier: Apache-2.0
// One view of a body, from the source or from an observer elsewhere, while its tiles are cut further and further. Where
// they are cut is decided by the points of the first epoch in half as many tiles: so the tiles of so many points are
// the same whatever comes before, and points in them are independent of the cuts.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "exact/frontier.hpp"
#include "exact/shadows.hpp"
#include "pipeline/exact_group.hpp"
#include "pipeline/sample_device.hpp"

namespace clray {

class TilesView {
 public:
  /// The tiles at some number of points.
  struct Stage {
    SampledTiles mixed;
    std::vector<ClrayTile> covered;
    std::vector<std::uint32_t> covering;  ///< the face of each
  };
  /// What points of the first epoch bring in some tiles of a view of so many points, of each tile and replicate.
  using Ask = std::function<std::vector<double>(const SampledTiles&, std::uint64_t points)>;

  TilesView(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights, const Sight& sight,
            std::uint32_t view);

  const Group& group() const { return group_; }
  const LightBeam& light() const { return light_; }
  /// The power of two by which sums of the view are smaller than those of the pass.
  int smaller() const { return smaller_; }
  /// The view in tiles of which so many are mixed, or as many as can be had.
  const Stage& stage(std::uint64_t points, const Ask& ask, Pause* pause);
  /// What the points of the first epoch brought in such tiles: it need not be asked for again.
  void note(std::uint64_t points, std::vector<double> values) { values_[points] = std::move(values); }

 private:
  void begin(Pause* pause);
  Stage stage_now() const;
  std::vector<double> spreads(std::uint64_t size, const Ask& ask);

  const std::uint32_t replicates_;
  Group group_;
  BeamFaces lit_;  // of the light, for an observer elsewhere
  LightBeam light_;
  int smaller_ = 0;
  std::unique_ptr<Shadows> shadows_;
  std::unique_ptr<Frontier> frontier_;
  std::uint64_t cut_to_ = 0;                             // the number of tiles that its last cut was asked for
  bool on_the_way_ = true;                               // that any number of points passes
  std::map<std::uint64_t, Stage> stages_;                // by points
  std::map<std::uint64_t, std::vector<double>> values_;  // what the first epoch's points brought, the same
  double largest_ = 0.0;                                 // sum of the lanes' weights of a face
};

}  // namespace clray
