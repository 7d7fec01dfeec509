// SPDX-License-Identifier: Apache-2.0
// See exact_pass.hpp. Views are taken in groups, so that small bodies fill a launch; the items of a group are launched
// in batches while the host cuts the next tiles.
#include "pipeline/exact_pass.hpp"

#include <algorithm>
#include <cmath>

#include "body/portable_tables.hpp"
#include "exact/tiles.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/exact_device.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::size_t kGroupFaces = 1u << 16;  // of a group of views, unless one view has more
constexpr std::size_t kBatchItems = 1u << 15;  // of a launch: an interrupt waits for one

/// The windows of the delay detectors among the histograms of a pass, and the numbers that all of them have.
std::vector<ClrayBinning> binnings_of(const PassPlan& plan, std::uint64_t* numbers) {
  std::vector<ClrayBinning> binnings;
  *numbers = 0;
  for (const PassDetector& d : plan.detectors) {
    const auto window = room_of(d).binning;
    if (window == nullptr) continue;
    ClrayBinning b = window(d);
    b.offset = *numbers;
    *numbers += plan.beams.views.size() * plan.request.lanes.size() * (b.bins + 2);
    binnings.push_back(b);
  }
  return binnings;
}

bool wants_all_faces(const PassPlan& plan) {
  return std::any_of(plan.detectors.begin(), plan.detectors.end(),
                     [](const PassDetector& d) { return table("detector")[static_cast<std::size_t>(d.row)].scatters; });
}

/// Some views while they are solved.
struct Group {
  std::size_t first_view = 0;
  std::vector<BeamFaces> beams;
  std::vector<std::size_t> offsets;  // of each beam's faces
  FaceGroup on_device;
};

class Solver {
 public:
  Solver(const PassPlan& plan, const Geometry& geometry, std::vector<std::unique_ptr<ExactDevice>>& devices,
         const std::function<bool(double)>& keep_going, Sums* sums)
      : plan_(plan),
        geometry_(geometry),
        devices_(devices),
        keep_going_(keep_going),
        sums_(*sums),
        all_faces_(wants_all_faces(plan)) {}

  bool run() {
    const std::size_t views = plan_.beams.views.size();
    for (std::size_t v = 0; v < views;) {
      Group group;
      group.first_view = v;
      do {
        add_view(v++, &group);
      } while (v < views && group.on_device.faces.size() + group.beams.back().faces.size() <= kGroupFaces);
      if (!solve(group)) return false;
    }
    return true;
  }

 private:
  void add_view(std::size_t v, Group* group) const {
    const ClrayView& view = plan_.beams.views[v];
    group->beams.push_back(beam_faces(geometry_, plan_.materials, plan_.motions[v], v3_load(view.toward),
                                      v3_load(plan_.constants.reference), static_cast<std::uint32_t>(v)));
    const BeamFaces& beam = group->beams.back();
    group->offsets.push_back(group->on_device.faces.size());
    const std::size_t lanes = plan_.request.lanes.size();
    for (std::size_t k = 0; k < beam.faces.size(); ++k) {
      ClrayFace face = beam.faces[k];
      face.bin_scale = view.weight_scale / plan_.beams.area_m2[v];
      group->on_device.faces.push_back(face);
      for (std::size_t l = 0; l < lanes; ++l) group->on_device.weights.push_back(weight(beam, k, l));
    }
  }

  /// f·mu_o of a face in a lane.
  double weight(const BeamFaces& beam, std::size_t face, std::size_t lane) const {
    const FaceOrigin& origin = beam.origins[face];
    if (!origin.lit || !plan_.traits.connect) return 0.0;
    return surface_weight(plan_.materials.of(lane, origin.material), plan_.materials.tables,
                          v3_load(beam.faces[face].normal), beam.toward, beam.toward);
  }

  bool solve(const Group& group) {
    for (auto& device : devices_) device->begin_group(group.on_device);
    ItemBatch batch;
    bool go = true;
    for (std::size_t k = 0; k < group.beams.size() && go; ++k) {
      const BeamFaces& beam = group.beams[k];
      go = cut_tiles(beam, [&](const TileFaces& tile) {
        add_items(group, k, tile, &batch);
        return batch.size() < kBatchItems || launch(&batch, group.first_view + k);
      });
    }
    go = go && launch(&batch, group.first_view + group.beams.size());
    std::vector<i64> found(group.on_device.faces.size() * CLRAY_FACE_SUMS);
    for (auto& device : devices_) device->end_group(&found);
    if (go) take(group, found);
    return go;
  }

  void add_items(const Group& group, std::size_t k, const TileFaces& tile, ItemBatch* batch) const {
    const BeamFaces& beam = group.beams[k];
    const auto offset = static_cast<std::uint32_t>(group.offsets[k]);
    const std::size_t lanes = plan_.request.lanes.size();
    const auto number = static_cast<std::uint32_t>(batch->tiles.size());
    batch->tiles.push_back({tile.x0, tile.x1, tile.y0, tile.y1, beam.size, beam.margin,
                            static_cast<std::uint32_t>(batch->lists.size()),
                            static_cast<std::uint32_t>(tile.faces.size())});
    for (const std::uint32_t face : tile.faces) {
      const ClrayFace& f = beam.faces[face];
      batch->lists.push_back({{f.box[0], f.box[1], f.box[2], f.box[3]}, f.nearest, offset + face, 0});
      const double* weights = group.on_device.weights.data() + (offset + face) * lanes;
      if (!all_faces_ && std::all_of(weights, weights + lanes, [](double w) { return w == 0.0; })) continue;
      batch->items.push_back(number);
      batch->items.push_back(offset + face);
    }
  }

  bool launch(ItemBatch* batch, std::size_t views_done) {
    devices_[next_device_]->launch_batch(batch);
    next_device_ = (next_device_ + 1) % devices_.size();
    return keep_going_(static_cast<double>(views_done) / static_cast<double>(plan_.beams.views.size()));
  }

  void take(const Group& group, const std::vector<i64>& found) {
    for (std::size_t k = 0; k < group.beams.size(); ++k) {
      const BeamFaces& beam = group.beams[k];
      std::vector<VisibleFace> visible(beam.faces.size());
      for (std::size_t f = 0; f < visible.size(); ++f)
        visible[f] = visible_face(beam.faces[f], found.data() + (group.offsets[k] + f) * CLRAY_FACE_SUMS);
      const double* weights = group.on_device.weights.data() + group.offsets[k] * plan_.request.lanes.size();
      const SolvedView solved{group.first_view + k, beam, visible, weights};
      for (const PassDetector& d : plan_.detectors) {
        const auto add = room_of(d).solved;
        if (add != nullptr) add({plan_, d, geometry_, solved}, &sums_);
      }
      sums_.points[solved.view] = 1;
      const double unit = plan_.beams.area_m2[solved.view] / plan_.constants.unit_scale;
      for (const VisibleFace& v : visible) sums_.area_rounding[solved.view] += v.rounding_m2 + unit;
    }
  }

  static VisibleFace visible_face(const ClrayFace& face, const i64* sum) {
    const double area = 1.0 / face.area_scale, length = area / face.inv_length, depth = area / face.inv_depth;
    const auto number = [&](int k) { return static_cast<double>(sum[k]); };
    VisibleFace v;
    v.area_m2 = number(CLRAY_FACE_AREA) * area;
    v.x_m3 = number(CLRAY_FACE_X) * length;
    v.y_m3 = number(CLRAY_FACE_Y) * length;
    v.depth_m3 = number(CLRAY_FACE_DEPTH) * depth;
    v.depth2_m4 = number(CLRAY_FACE_DEPTH2) * depth / face.inv_depth;
    v.rounding_m2 = (number(CLRAY_FACE_LOST) + number(CLRAY_FACE_PIECES)) * area;
    return v;
  }

  const PassPlan& plan_;
  const Geometry& geometry_;
  std::vector<std::unique_ptr<ExactDevice>>& devices_;
  const std::function<bool(double)>& keep_going_;
  Sums& sums_;
  const bool all_faces_;
  std::size_t next_device_ = 0;
};

/// Gives each histogram's block its rows: of a view and lane, the same for every connection.
void take_bins(const PassPlan& plan, const std::vector<ClrayBinning>& binnings, const std::vector<i64>& bins,
               Sums* sums) {
  const SumShape& shape = plan.layout.shape;
  std::size_t n = 0;
  for (const PassDetector& d : plan.detectors) {
    if (room_of(d).binning == nullptr) continue;
    const ClrayBinning& b = binnings[n++];
    const SumBlock& block = plan.layout.blocks[d.first_block];
    for (std::uint64_t row = 0; row < shape.views * shape.lanes; ++row) {
      for (std::uint64_t c = 0; c < shape.connections; ++c) {
        for (std::uint64_t k = 0; k < block.width; ++k)
          sums->values.set(block.offset + (row * shape.connections + c) * block.width + k,
                           bins[b.offset + row * block.width + k]);
      }
    }
  }
}

}  // namespace

ExactPass::ExactPass(Device& device, const PassPlan& plan, const Geometry& geometry)
    : plan_(plan), geometry_(geometry) {
  const double start = now();
  binnings_ = binnings_of(plan, &bins_);
  const ExactNumbers numbers{static_cast<std::uint32_t>(plan.request.lanes.size()),
                             static_cast<std::uint32_t>(binnings_.size())};
  for (OpenedDevice& opened : device.impl().devices)
    devices_.push_back(std::make_unique<ExactDevice>(opened, plan.program.options, numbers, binnings_, bins_));
  compile_seconds_ = now() - start;
}

ExactPass::~ExactPass() = default;

bool ExactPass::run(Sums* sums, const std::function<bool(double)>& keep_going) {
  *sums = Sums(plan_.layout);
  sums->area_rounding.assign(plan_.beams.views.size(), 0.0);
  if (!Solver(plan_, geometry_, devices_, keep_going, sums).run()) return false;
  std::vector<i64> bins(bins_);
  for (auto& device : devices_) device->read_bins(&bins);
  take_bins(plan_, binnings_, bins, sums);
  return true;
}

}  // namespace clray
