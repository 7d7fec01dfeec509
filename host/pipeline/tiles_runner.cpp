// SPDX-License-Identifier: Apache-2.0
// See tiles_runner.hpp. Where a view's tiles are cut is decided by the points of the first epoch in half as many tiles:
// so the tiles of so many points are the same whatever comes before, and points in them are independent of the cuts.
#include "pipeline/tiles_runner.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "exact/frontier.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/exact_group.hpp"
#include "pipeline/sample_device.hpp"

namespace clray {
namespace {

constexpr std::size_t kFirstTiles = 64;           // before points say where to cut
constexpr std::uint32_t kPurpose = 0x74696c65u;   // of the random numbers
constexpr double kUnseen = 0.02;                  // of the largest square that a tile's points may miss
constexpr std::size_t kMostKeptFaces = 1u << 20;  // of views that are kept between two steps

/// A view's tiles at some number of points.
struct Stage {
  SampledTiles mixed;
  std::vector<ClrayTile> covered;
  std::vector<std::uint32_t> covering;  // the face of each
};

/// A view while it is cut further and further.
struct CutView {
  Group group;
  std::unique_ptr<Frontier> frontier;
  std::map<std::uint64_t, Stage> stages;                // by points
  std::map<std::uint64_t, std::vector<double>> values;  // what the first epoch's points brought, the same
  double largest = 0.0;                                 // sum of the lanes' weights of a face
};

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

Stage stage_of(const BeamFaces& beam, const Frontier& frontier) {
  Stage stage;
  for (const Frontier::Tile& t : frontier.mixed()) {
    stage.mixed.tiles.push_back(tile_at(beam, t.at, stage.mixed.listed.size(), t.faces.size()));
    stage.mixed.listed.insert(stage.mixed.listed.end(), t.faces.begin(), t.faces.end());
  }
  for (const Frontier::Tile& t : frontier.covered()) {
    stage.covered.push_back(tile_at(beam, t.at, 0, 1));
    stage.covering.push_back(t.faces.front());
  }
  return stage;
}

}  // namespace

struct TilesRunner::Parts {
  const PassPlan& plan;
  const Geometry& geometry;
  std::vector<Sight> sights;
  std::vector<std::unique_ptr<SampleDevice>> devices;
  std::map<std::uint32_t, std::unique_ptr<CutView>> kept;

  bool keeps_views() const { return plan.beams.views.size() * geometry.primitives.size() <= kMostKeptFaces; }
  SampleDevice& device_of(std::uint32_t view) { return *devices[view % devices.size()]; }

  std::unique_ptr<CutView> new_view(std::uint32_t v) const {
    auto view = std::make_unique<CutView>();
    view->group = group_of(plan, geometry, sights, sights.front(), v, v + 1);
    for (ClrayFace& face : view->group.on_device.faces) face.view = 0;  // histograms are those of one view
    const std::vector<double>& weights = view->group.on_device.weights;
    const std::size_t lanes = plan.request.lanes.size();
    for (std::size_t f = 0; f < weights.size(); f += lanes) {
      double sum = 0.0;
      for (std::size_t l = 0; l < lanes; ++l) sum += weights[f + l];
      view->largest = std::max(view->largest, sum);
    }
    return view;
  }

  ClraySampling sampling(std::uint32_t v, std::uint32_t epoch, std::uint64_t round, bool adds) const {
    const ClrayView& view = plan.beams.views[v];
    ClraySampling s{};
    s.path_middle_m = view.path_middle_m;
    s.inv_path_per_m = view.inv_path_per_m;
    s.key0 = plan.constants.key0 ^ view.key0;
    s.key1 = plan.constants.key1 ^ view.key1 ^ kPurpose;
    s.epoch = epoch;
    s.round = static_cast<std::uint32_t>(round);
    s.replicates = plan.request.replicates;
    s.adds = adds ? 1 : 0;
    return s;
  }

  /// How much each tile adds to the variance, as far as the points of the first epoch tell, and what they may have
  /// missed. `size`: the number of tiles that was asked for.
  std::vector<double> spreads(std::uint32_t v, CutView& view, std::uint64_t size) {
    std::vector<double>& values = view.values[size];
    if (values.empty()) {
      const SampledTiles mixed = stage_of(view.group.beams.front(), *view.frontier).mixed;
      values = device_of(v).sample(mixed, sampling(v, 0, size, false)).values;
    }
    const std::size_t count = view.frontier->mixed().size(), replicates = plan.request.replicates;
    std::vector<double> spread(count);
    for (std::size_t t = 0; t < count; ++t) {
      double mean = 0.0, squares = 0.0;
      for (std::size_t r = 0; r < replicates; ++r) mean += values[t * replicates + r] / static_cast<double>(replicates);
      for (std::size_t r = 0; r < replicates; ++r) {
        const double off = values[t * replicates + r] - mean;
        squares += off * off;
      }
      const double most = view.largest * view.frontier->mixed()[t].at.area();
      spread[t] = squares + kUnseen * most * most;
    }
    return spread;
  }

  /// Cuts a view until it has so many mixed tiles, or no more can be had.
  const Stage& stage(std::uint32_t v, CutView* view, std::uint64_t points) {
    const auto known = view->stages.find(points);
    if (known != view->stages.end()) return known->second;
    const auto count = [&] { return view->frontier->mixed().size(); };
    const Group& group = view->group;
    if (view->frontier == nullptr || count() > points)
      view->frontier =
          std::make_unique<Frontier>(group.beams.front(), [&group](std::uint32_t f) { return group.shines(f); });
    for (bool go = true; go && count() < std::min<std::uint64_t>(kFirstTiles, points);) {
      std::vector<double> areas;
      for (const Frontier::Tile& t : view->frontier->mixed()) areas.push_back(t.at.area());
      go = view->frontier->cut(areas, kFirstTiles);
    }
    // The same steps on the way to any number of points.
    for (std::uint64_t size = kFirstTiles; size < points; size *= 2) {
      if (2 * size <= count()) continue;
      if (!view->frontier->cut(spreads(v, *view, size), std::min(2 * size, points))) break;
    }
    return view->stages.emplace(points, stage_of(group.beams.front(), *view->frontier)).first->second;
  }

  void solve_covered(const Stage& stage, std::uint32_t v, std::uint64_t points, Group* group, Sums* sums) const;
  void add_sampled(const Stage& stage, const SampleSums& found, std::uint32_t v, std::uint64_t points,
                   const Group& group, Sums* sums) const;
  void add_histogram(const PassDetector& d, const i64* numbers, std::uint32_t v, std::uint64_t lane, std::uint64_t r,
                     std::uint64_t times, Sums* sums) const;
  std::uint64_t row_of(std::uint32_t v, std::uint64_t lane, std::size_t c, std::uint64_t r) const {
    const SumShape& shape = plan.layout.shape;
    return ((v * shape.lanes + lane) * shape.connections + c) * shape.replicates + r;
  }
};

/// Adds a row of a histogram for every observer.
void TilesRunner::Parts::add_histogram(const PassDetector& d, const i64* numbers, std::uint32_t v, std::uint64_t lane,
                                       std::uint64_t r, std::uint64_t times, Sums* sums) const {
  const SumBlock& block = plan.layout.blocks[d.first_block];
  for (const std::size_t c : sights.front().connections) {
    const std::uint64_t at = block.offset + row_of(v, lane, c, r) * block.width;
    for (std::uint64_t k = 0; k < block.width; ++k) sums->values.add(at + k, static_cast<Sum>(numbers[k]) * times);
  }
}

/// Tiles that one face covers, the same in every replicate.
void TilesRunner::Parts::solve_covered(const Stage& stage, std::uint32_t v, std::uint64_t points, Group* group,
                                       Sums* sums) const {
  const std::size_t lanes = plan.request.lanes.size();
  const std::vector<ClrayBinning>& binnings = group->on_device.binnings;
  const std::uint64_t numbers = binnings.empty() ? 0 : binnings.back().offset + lanes * (binnings.back().bins + 2);
  std::vector<i64> face_sums(group->on_device.faces.size() * CLRAY_FACE_SUMS), bins(numbers);
  ExactBuffers host;
  host.faces = group->on_device.faces.data();
  host.weights = group->on_device.weights.data();
  host.tiles = stage.covered.data();
  host.binnings = binnings.data();
  host.sums = face_sums.data();
  host.bins = bins.data();
  const ExactNumbers known = exact_numbers(plan);
  for (std::uint32_t k = 0; k < stage.covered.size(); ++k) covered_tile_on_host(host, known, k, stage.covering[k]);
  group->visible.clear();
  for (std::size_t f = 0; f < group->on_device.faces.size(); ++f)
    group->visible.push_back(visible_face(group->on_device.faces[f], face_sums.data() + f * CLRAY_FACE_SUMS));
  const SolvedView solved{v,
                          true,
                          sights.front().connections,
                          group->beams.front(),
                          group->visible.data(),
                          group->on_device.weights.data(),
                          points};
  std::size_t n = 0;
  for (const PassDetector& d : plan.detectors) {
    if (const auto add = room_of(d).solved) add({plan, d, geometry, solved}, sums);
    if (room_of(d).binning == nullptr) continue;
    const ClrayBinning& b = binnings[n++];
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::uint32_t r = 0; r < plan.request.replicates; ++r)
        add_histogram(d, bins.data() + b.offset + l * (b.bins + 2), v, l, r, points, sums);
    }
  }
}

/// The least f32 that is not below x, as its bits.
std::uint32_t bits_above(double x) {
  auto near = static_cast<float>(x);
  if (static_cast<double>(near) < x) near = std::nextafter(near, HUGE_VALF);
  std::uint32_t bits;
  std::memcpy(&bits, &near, sizeof bits);
  return bits;
}

/// What a point of a lane brings at most, m²/sr.
double largest_share(const Stage& stage, const Group& group, std::uint64_t lane, std::uint64_t lanes) {
  double largest = 0.0;
  for (const ClrayTile& t : stage.mixed.tiles) {
    for (std::uint32_t k = 0; k < t.count; ++k) {
      const double w = group.on_device.weights[stage.mixed.listed[t.first + k] * lanes + lane];
      largest = std::max(largest, w * (t.x1 - t.x0) * (t.y1 - t.y0));
    }
  }
  return largest;
}

void TilesRunner::Parts::add_sampled(const Stage& stage, const SampleSums& found, std::uint32_t v, std::uint64_t points,
                                     const Group& group, Sums* sums) const {
  const std::uint64_t lanes = plan.request.lanes.size(), replicates = plan.request.replicates;
  std::size_t n = 0;
  for (const PassDetector& d : plan.detectors) {
    const bool bins = room_of(d).binning != nullptr;
    if (!bins && room_of(d).solved == nullptr) continue;
    for (std::uint64_t l = 0; l < lanes; ++l) {
      const double largest =
          largest_share(stage, group, l, lanes) * (static_cast<double>(points) / plan.beams.area_m2[v]);
      for (std::uint64_t r = 0; r < replicates; ++r) {
        const std::uint64_t row = l * replicates + r;
        if (!bins) {
          const SumBlock& block = plan.layout.blocks[d.first_block];
          for (const std::size_t c : sights.front().connections) {
            for (std::uint64_t k = 0; k < 3; ++k)
              sums->values.add(block.offset + 3 * row_of(v, l, c, r) + k,
                               static_cast<Sum>(found.moments[3 * row + k]) * points);
          }
          continue;
        }
        const ClrayBinning& b = group.on_device.binnings[n];
        const std::uint64_t at = b.offset * replicates + row * (b.bins + 2);
        add_histogram(d, found.bins.data() + at, v, l, r, points, sums);
        for (std::uint32_t k = d.first_block; k < d.last_block; ++k) {
          const SumBlock& block = plan.layout.blocks[k];
          if (!block.counts()) continue;
          for (const std::size_t c : sights.front().connections) {
            const std::uint64_t own = block.offset + row_of(v, l, c, r) * block.width;
            for (std::uint64_t bin = 0; bin < block.width; ++bin)
              sums->counts.set(own + bin,
                               block.scale == SumScale::greatest ? bits_above(largest) : found.hits[at + bin]);
          }
        }
      }
    }
    n += bins ? 1 : 0;
  }
}

TilesRunner::TilesRunner(Device& device, const PassPlan& plan, const Geometry& geometry)
    : parts_(new Parts{plan, geometry, sights_of(plan), {}, {}}) {
  const double start = now();
  std::uint64_t numbers = 0;
  for (ClrayBinning& b : (lay_out_bins(plan, &parts_->sights), parts_->sights.front().binnings)) {
    b.offset = numbers;  // of one view
    numbers += plan.request.lanes.size() * (b.bins + 2);
  }
  parts_->devices = on_each_device(&device.impl(), [&](OpenedDevice& opened) {
    return std::make_unique<SampleDevice>(opened, plan.program.options, exact_numbers(plan));
  });
  compile_seconds_ = now() - start;
}

TilesRunner::~TilesRunner() = default;

bool TilesRunner::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                      const Checkpoint& checkpoint) {
  const PassPlan& plan = parts_->plan;
  const std::uint64_t points = step->points;
  if (step->more.points.empty()) step->more = Sums(plan.layout);
  while (step->done < step->views.size()) {
    const std::uint32_t v = step->views[step->done];
    if (!keep_going(static_cast<double>(step->done) / static_cast<double>(step->views.size()))) return false;
    std::unique_ptr<CutView>& kept = parts_->kept[v];
    if (kept == nullptr) kept = parts_->new_view(v);
    parts_->device_of(v).begin_view(kept->group.on_device);
    const Stage& stage = parts_->stage(v, kept.get(), points);
    parts_->solve_covered(stage, v, points, &kept->group, &step->more);
    SampleSums found = parts_->device_of(v).sample(stage.mixed, parts_->sampling(v, step->epoch, points, true));
    parts_->add_sampled(stage, found, v, points, kept->group, &step->more);
    if (step->epoch == 0) kept->values[points] = std::move(found.values);
    step->more.points[v] = points;
    if (!parts_->keeps_views()) kept.reset();
    ++step->done;
    if (step->done < step->views.size() && checkpoint.due && checkpoint.due()) checkpoint.save();
  }
  for (const std::uint32_t v : step->views) sums->set_view(plan.layout, v, &step->more);
  return true;
}

}  // namespace clray
