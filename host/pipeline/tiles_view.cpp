// SPDX-License-Identifier: Apache-2.0
// See tiles_view.hpp.
#include "pipeline/tiles_view.hpp"

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"

namespace clray {
namespace {

constexpr std::size_t kFirstTiles = 64;  // before points say where to cut
constexpr double kUnseen = 0.02;         // of the largest square that a tile's points may miss

ClrayTile tile_at(const BeamFaces& beam, const Rectangle& r, std::size_t first, std::size_t count) {
  return {r.x0,
          r.x1,
          r.y0,
          r.y1,
          beam.size,
          beam.margin,
          static_cast<std::uint32_t>(first),
          static_cast<std::uint32_t>(count)};
}

}  // namespace

TilesView::TilesView(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights,
                     const Sight& sight, std::uint32_t view)
    : replicates_(plan.request.replicates), group_(group_of(plan, geometry, sights, sight, view, view + 1)) {
  const BeamFaces& beam = group_.beams.front();
  if (!is_source(sights, sight)) {
    lit_ = beam_faces(geometry, plan.materials, plan.motions[view],
                      {v3_load(plan.beams.views[view].toward), v3_load(plan.beams.views[view].toward),
                       v3_load(plan.constants.reference), view});
    shadows_ = std::make_unique<Shadows>(beam, lit_);
    light_ = {lit_.faces, shadows_->carried()};
    // Points see what is in shadow too, and the view may be much larger than the beam of the light: sums must hold it.
    const double ratio = (beam.x1 - beam.x0) * (beam.y1 - beam.y0) / plan.beams.area_m2[view];
    smaller_ = std::clamp(std::ilogb(ratio) + 1, 0, 40);
  }
  for (ClrayFace& face : group_.on_device.faces) {
    face.view = 0;  // histograms are those of one view
    face.bin_scale = std::ldexp(face.bin_scale, -smaller_);
  }
  const std::vector<double>& weights = group_.on_device.weights;
  const std::size_t lanes = plan.request.lanes.size();
  for (std::size_t f = 0; f < weights.size(); f += lanes) {
    double sum = 0.0;
    for (std::size_t l = 0; l < lanes; ++l) sum += weights[f + l];
    largest_ = std::max(largest_, sum);
  }
}

void TilesView::begin(Pause* pause) {
  frontier_ = std::make_unique<Frontier>(group_.beams.front(), shadows_.get(), [this, pause](std::uint32_t face) {
    (*pause)();
    return group_.shines(face) && (shadows_ == nullptr || shadows_->may_be_lit(face));
  });
}

TilesView::Stage TilesView::stage_now() const {
  const BeamFaces& beam = group_.beams.front();
  Stage stage;
  SampledTiles& mixed = stage.mixed;
  for (const Frontier::Tile& t : frontier_->mixed()) {
    mixed.tiles.push_back(tile_at(beam, t.at, mixed.listed.size(), t.faces.size()));
    mixed.listed.insert(mixed.listed.end(), t.faces.begin(), t.faces.end());
    if (shadows_ == nullptr) continue;
    mixed.shaded.push_back(static_cast<std::uint32_t>(mixed.blockers.size()));
    mixed.shaded.push_back(static_cast<std::uint32_t>(t.blockers.size()));
    mixed.blockers.insert(mixed.blockers.end(), t.blockers.begin(), t.blockers.end());
  }
  for (const Frontier::Tile& t : frontier_->covered()) {
    stage.covered.push_back(tile_at(beam, t.at, 0, 1));
    stage.covering.push_back(t.faces.front());
  }
  return stage;
}

/// How much each tile adds to the variance, as far as the points of the first epoch tell, and what they may have
/// missed. `size`: the number of tiles that was asked for.
std::vector<double> TilesView::spreads(std::uint64_t size, const Ask& ask) {
  std::vector<double>& values = values_[size];
  if (values.empty()) values = ask(stage_now().mixed, size);
  const std::size_t count = frontier_->mixed().size();
  if (values.size() != count * replicates_) throw Error(ErrorCode::bug, "points of other tiles", "tiles");
  std::vector<double> spread(count);
  for (std::size_t t = 0; t < count; ++t) {
    const double* of_tile = values.data() + t * replicates_;
    double mean = 0.0, squares = 0.0;
    for (std::size_t r = 0; r < replicates_; ++r) mean += of_tile[r] / static_cast<double>(replicates_);
    for (std::size_t r = 0; r < replicates_; ++r) squares += (of_tile[r] - mean) * (of_tile[r] - mean);
    const double most = largest_ * frontier_->mixed()[t].at.area();
    spread[t] = squares + kUnseen * most * most;
  }
  return spread;
}

const TilesView::Stage& TilesView::stage(std::uint64_t points, const Ask& ask, Pause* pause) {
  const auto known = stages_.find(points);
  if (known != stages_.end()) return known->second;
  // The same steps on the way to any number of points, whatever was asked for before: from twice to twice as many.
  if (frontier_ == nullptr || cut_to_ > points || !on_the_way_) {
    begin(pause);
    for (bool go = true; go && frontier_->mixed().size() < std::min<std::uint64_t>(kFirstTiles, points);) {
      std::vector<double> areas;
      for (const Frontier::Tile& t : frontier_->mixed()) areas.push_back(t.at.area());
      go = frontier_->cut(areas, kFirstTiles);
    }
    cut_to_ = kFirstTiles;
    on_the_way_ = true;
  }
  while (cut_to_ < points) {
    const std::uint64_t next = std::min(2 * cut_to_, points);
    if (2 * cut_to_ > frontier_->mixed().size() && !frontier_->cut(spreads(cut_to_, ask), next)) break;
    on_the_way_ = next == 2 * cut_to_;
    cut_to_ = next;
  }
  return stages_.emplace(points, stage_now()).first->second;
}

}  // namespace clray
