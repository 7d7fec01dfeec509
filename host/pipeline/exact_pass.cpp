// SPDX-License-Identifier: Apache-2.0
// See exact_pass.hpp. Views are taken in groups, so that small bodies fill a launch; the items of a group are launched
// in batches while the host cuts the next tiles, and finds the faces of the next group in threads of its own.
#include "pipeline/exact_pass.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "exact/carry.hpp"
#include "exact/tiles.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/exact_group.hpp"
#include "pipeline/exact_sights.hpp"
#include "pipeline/exact_team.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::size_t kGroupFaces = 1u << 16;  // of a group of views, about, unless one view has more
constexpr std::size_t kBatchItems = 1u << 15;  // of a launch: an interrupt waits for one

bool wants_all_faces(const PassPlan& plan) {
  return std::any_of(plan.detectors.begin(), plan.detectors.end(),
                     [](const PassDetector& d) { return table("detector")[static_cast<std::size_t>(d.row)].scatters; });
}

class Solver {
 public:
  Solver(const PassPlan& plan, const Geometry& geometry, const std::vector<Sight>& sights, ExactTeam& devices,
         const std::function<bool(double)>& keep_going, Sums* sums)
      : plan_(plan),
        geometry_(geometry),
        sights_(sights),
        devices_(devices),
        keep_going_(keep_going),
        sums_(*sums),
        all_faces_(wants_all_faces(plan)) {}

  /// Solves views `first` to `end` - 1; `solved_before` is called behind each group but the last.
  bool run(std::size_t first, std::size_t end, const std::function<void(std::size_t)>& solved_before) {
    end_ = end;
    const std::size_t together = std::max<std::size_t>(1, kGroupFaces / (1 + geometry_.primitives.size()));
    std::vector<std::future<Group>> next;
    if (first < end) next = prepare(first, together);
    for (std::size_t v = first; v < end; v += together) {
      std::vector<std::future<Group>> groups = std::exchange(next, {});
      if (v + together < end) next = prepare(v + together, together);
      Group lit = groups.front().get();
      if (!solve_lit(&lit)) return false;
      for (std::size_t s = 1; s < sights_.size(); ++s) {
        if (!solve_seen(sights_[s], lit, groups[s].get())) return false;
      }
      if (v + together < end) solved_before(v + together);
    }
    return true;
  }

 private:
  /// The faces of some views from every sight, found in threads while devices are at work.
  std::vector<std::future<Group>> prepare(std::size_t first_view, std::size_t count) const {
    const std::size_t end_view = std::min(first_view + count, end_);
    std::vector<std::future<Group>> groups;
    for (const Sight& sight : sights_) {
      groups.push_back(std::async(std::launch::async, [this, &sight, first_view, end_view] {
        return group_of(plan_, geometry_, sights_, sight, first_view, end_view);
      }));
    }
    return groups;
  }

  bool solve_lit(Group* group) {
    const bool go = solve(sights_.front(), group, [&](std::size_t k, ItemBatch* batch) {
      return cut_tiles(group->beams[k], [&](const TileFaces& tile) {
        const std::uint32_t number = add_tile(*group, k, tile, batch);
        for (const std::uint32_t face : tile.faces) {
          if (wanted(*group, group->offsets[k] + face)) add_item(number, group->offsets[k] + face, batch);
        }
        return full(batch, *group, k);
      });
    });
    if (go) take(sights_.front(), *group);
    return go;
  }

  /// What of the lit pieces an observer elsewhere sees.
  bool solve_seen(const Sight& sight, const Group& lit, Group group) {
    std::vector<Carrier> carriers;
    for (std::size_t k = 0; k < group.beams.size(); ++k) carriers.emplace_back(lit.beams[k], group.beams[k]);
    const bool go = solve(sight, &group, [&](std::size_t k, ItemBatch* batch) {
      const std::vector<ClrayPiece> pieces = seen_pieces(carriers[k], lit.lit[k], group, k);
      return cut_tiles(group.beams[k], pieces, [&](const TileFaces& tile) {
        const std::uint32_t number = add_tile(group, k, tile, batch);
        for (const std::uint32_t piece : tile.pieces) {
          add_item(number, group.offsets[k] + pieces[piece].face, batch);
          batch->pieces.push_back(pieces[piece]);
        }
        return full(batch, group, k);
      });
    });
    if (!go) return false;
    for (std::size_t k = 0; k < group.beams.size(); ++k) carry_rounding(carriers[k], lit, k, &group);
    take(sight, group);
    return true;
  }

  std::vector<ClrayPiece> seen_pieces(const Carrier& carrier, const std::vector<ClrayPiece>& lit, const Group& group,
                                      std::size_t k) const {
    std::vector<ClrayPiece> pieces;
    pieces.reserve(lit.size());
    for (const ClrayPiece& piece : lit) {
      const std::int64_t there = carrier.seen(piece.face);
      if (there >= 0 && group.shines(group.offsets[k] + static_cast<std::size_t>(there)))
        pieces.push_back(carrier.carry(piece));
    }
    return pieces;
  }

  /// What rounding did to the lit part of a face it did to what is seen of it.
  static void carry_rounding(const Carrier& carrier, const Group& lit, std::size_t k, Group* group) {
    for (std::size_t f = 0; f < lit.beams[k].faces.size(); ++f) {
      const std::int64_t there = carrier.seen(static_cast<std::uint32_t>(f));
      if (there < 0) continue;
      const auto seen = static_cast<std::size_t>(there);
      const double ratio = group->beams[k].origins[seen].mu / lit.beams[k].origins[f].mu;
      group->visible[group->offsets[k] + seen].rounding_m2 += ratio * lit.visible[lit.offsets[k] + f].rounding_m2;
    }
  }

  /// `add_items` gives the items of beam k of the group.
  template <class AddItems>
  bool solve(const Sight& sight, Group* group, const AddItems& add_items) {
    ExactTeam::Found found;
    const auto launch_all = [&] {
      ItemBatch batch;
      for (std::size_t k = 0; k < group->beams.size(); ++k) {
        if (!add_items(k, &batch)) return false;
      }
      return launch(&batch, group->end_view());
    };
    const bool go = devices_.solve(group->on_device, rows_of(sight, *group), launch_all, &found);
    group->visible.reserve(group->on_device.faces.size());
    for (std::size_t f = 0; f < group->on_device.faces.size(); ++f)
      group->visible.push_back(visible_face(group->on_device.faces[f], found.sums.data() + f * CLRAY_FACE_SUMS));
    group->lit.resize(group->beams.size());
    for (ClrayPiece& piece : found.lit) {
      if (piece.corners == 0) continue;
      const auto next = std::upper_bound(group->offsets.begin(), group->offsets.end(), piece.face);
      const auto k = static_cast<std::size_t>(next - group->offsets.begin()) - 1;
      piece.face -= static_cast<std::uint32_t>(group->offsets[k]);
      group->lit[k].push_back(piece);
    }
    return go;
  }

  /// Where the histograms of a group's views are.
  std::vector<BinRow> rows_of(const Sight& sight, const Group& group) const {
    std::vector<BinRow> rows;
    if (sight.connections.empty()) return rows;
    for (const ClrayBinning& b : sight.binnings) {
      const std::size_t of_view = plan_.request.lanes.size() * (b.bins + 2);
      rows.push_back({b.offset + group.first_view * of_view, group.beams.size() * of_view});
    }
    return rows;
  }

  bool wanted(const Group& group, std::size_t face) const {
    return all_faces_ || group.on_device.faces[face].carried != 0 || group.shines(face);
  }

  static std::uint32_t add_tile(const Group& group, std::size_t k, const TileFaces& tile, ItemBatch* batch) {
    const BeamFaces& beam = group.beams[k];
    const auto offset = static_cast<std::uint32_t>(group.offsets[k]);
    batch->tiles.push_back({tile.x0, tile.x1, tile.y0, tile.y1, beam.size, beam.margin,
                            static_cast<std::uint32_t>(batch->lists.size()),
                            static_cast<std::uint32_t>(tile.faces.size())});
    for (const std::uint32_t face : tile.faces) {
      const ClrayFace& f = beam.faces[face];
      batch->lists.push_back({{f.box[0], f.box[1], f.box[2], f.box[3]}, f.nearest, offset + face, 0});
    }
    return static_cast<std::uint32_t>(batch->tiles.size() - 1);
  }

  static void add_item(std::uint32_t tile, std::size_t face, ItemBatch* batch) {
    batch->items.push_back(tile);
    batch->items.push_back(static_cast<std::uint32_t>(face));
  }

  /// Launches a batch that is full; false where the pass must stop.
  bool full(ItemBatch* batch, const Group& group, std::size_t k) {
    return batch->size() < kBatchItems || launch(batch, group.first_view + k);
  }

  bool launch(ItemBatch* batch, std::size_t views_done) {
    devices_.launch(batch);
    return keep_going_(static_cast<double>(views_done) / static_cast<double>(plan_.beams.views.size()));
  }

  void take(const Sight& sight, const Group& group) {
    for (std::size_t k = 0; k < group.beams.size(); ++k) {
      const BeamFaces& beam = group.beams[k];
      const double* weights = group.on_device.weights.data() + group.offsets[k] * plan_.request.lanes.size();
      const SolvedView solved{group.first_view + k,
                              is_source(sights_, sight),
                              sight.connections,
                              beam,
                              group.visible.data() + group.offsets[k],
                              weights};
      for (const PassDetector& d : plan_.detectors) {
        const auto add = room_of(d).solved;
        if (add != nullptr) add({plan_, d, geometry_, solved}, &sums_);
      }
      if (!is_source(sights_, sight)) continue;
      sums_.points[solved.view] = 1;
      const double unit = plan_.beams.area_m2[solved.view] / plan_.constants.unit_scale;
      for (std::size_t f = 0; f < beam.faces.size(); ++f)
        sums_.area_rounding[solved.view] += solved.visible[f].rounding_m2 + unit;
    }
  }

  const PassPlan& plan_;
  const Geometry& geometry_;
  const std::vector<Sight>& sights_;
  ExactTeam& devices_;
  const std::function<bool(double)>& keep_going_;
  Sums& sums_;
  const bool all_faces_;
  std::size_t end_ = 0;
};

}  // namespace

/// What the pass sees, and its devices.
struct ExactPass::Parts {
  std::vector<Sight> sights;
  std::unique_ptr<ExactTeam> devices;
};

ExactPass::ExactPass(Device& device, const PassPlan& plan, const Geometry& geometry)
    : plan_(plan), geometry_(geometry), parts_(std::make_unique<Parts>()) {
  const double start = now();
  parts_->sights = sights_of(plan);
  const std::uint64_t bins = lay_out_bins(plan, &parts_->sights);
  parts_->devices = std::make_unique<ExactTeam>(device, plan, bins);
  compile_seconds_ = now() - start;
}

ExactPass::~ExactPass() = default;

bool ExactPass::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                    const Checkpoint& checkpoint) {
  *sums = step->done > 0 ? step->more : Sums(plan_.layout);
  sums->area_rounding.resize(plan_.beams.views.size());
  parts_->devices->clear_bins();
  Solver solver(plan_, geometry_, parts_->sights, *parts_->devices, keep_going, sums);
  const bool solved = solver.run(step->from + step->done, step->points, [&](std::size_t end) {
    if (!checkpoint.due || !checkpoint.due()) return;
    step->more = *sums;
    step->done = end - step->from;
    add_bins(&step->more);
    checkpoint.save();
  });
  if (solved) add_bins(sums);
  return solved;
}

/// What devices have found of histograms since the run began.
void ExactPass::add_bins(Sums* sums) const {
  take_bins(plan_, parts_->sights, parts_->devices->bins(), sums);
}

}  // namespace clray
