// SPDX-License-Identifier: Apache-2.0
// See tiles_sums.hpp.
#include "pipeline/tiles_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/detector/room.hpp"

namespace clray {
namespace {

/// As how many of its units a sum of the view counts.
Sum times(const TilesFound& found) {
  return static_cast<Sum>(found.points) << found.view.smaller();
}

/// Calls `add` with each observer's row of a lane and replicate.
template <class Add>
void each_row(const TilesFound& found, std::uint64_t lane, std::uint64_t replicate, const Add& add) {
  const SumShape& shape = found.plan.layout.shape;
  for (const std::size_t c : found.sight.connections)
    add(((found.number * shape.lanes + lane) * shape.connections + c) * shape.replicates + replicate);
}

void add_histogram(const TilesFound& found, const PassDetector& d, const i64* numbers, std::uint64_t lane,
                   std::uint64_t replicate, Sums* sums) {
  const SumBlock& block = found.plan.layout.blocks[d.first_block];
  each_row(found, lane, replicate, [&](std::uint64_t row) {
    for (std::uint64_t k = 0; k < block.width; ++k)
      sums->values.add(block.offset + row * block.width + k, numbers[k] * times(found));
  });
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
double largest_share(const TilesFound& found, std::uint64_t lane) {
  const std::uint64_t lanes = found.plan.request.lanes.size();
  const SampledTiles& mixed = found.stage.mixed;
  double largest = 0.0;
  for (const ClrayTile& t : mixed.tiles) {
    for (std::uint32_t k = 0; k < t.count; ++k) {
      const double w = found.view.group().on_device.weights[mixed.listed[t.first + k] * lanes + lane];
      largest = std::max(largest, w * (t.x1 - t.x0) * (t.y1 - t.y0));
    }
  }
  return largest;
}

/// What the counts of a histogram say: hits of each bin, and the largest share of a point.
void set_counts(const TilesFound& found, const PassDetector& d, const u32* hits, double largest, std::uint64_t lane,
                std::uint64_t replicate, Sums* sums) {
  for (std::uint32_t k = d.first_block; k < d.last_block; ++k) {
    const SumBlock& block = found.plan.layout.blocks[k];
    if (!block.counts()) continue;
    each_row(found, lane, replicate, [&](std::uint64_t row) {
      for (std::uint64_t bin = 0; bin < block.width; ++bin)
        sums->counts.set(block.offset + row * block.width + bin,
                         block.scale == SumScale::greatest ? bits_above(largest) : hits[bin]);
    });
  }
}

void add_moments(const TilesFound& found, const PassDetector& d, const i64* moments, std::uint64_t lane,
                 std::uint64_t replicate, Sums* sums) {
  const SumBlock& block = found.plan.layout.blocks[d.first_block];
  each_row(found, lane, replicate, [&](std::uint64_t row) {
    for (std::uint64_t k = 0; k < 3; ++k) sums->values.add(block.offset + 3 * row + k, moments[k] * times(found));
  });
}

}  // namespace

void add_covered(const TilesFound& found, Sums* sums, Pause* pause) {
  const FaceGroup& group = found.view.group().on_device;
  const TilesView::Stage& stage = found.stage;
  const std::size_t lanes = found.plan.request.lanes.size();
  const std::vector<ClrayBinning>& binnings = group.binnings;
  const std::uint64_t numbers = binnings.empty() ? 0 : binnings.back().offset + lanes * (binnings.back().bins + 2);
  std::vector<i64> face_sums(group.faces.size() * CLRAY_FACE_SUMS), bins(numbers);
  ExactBuffers host;
  host.faces = group.faces.data();
  host.weights = group.weights.data();
  host.tiles = stage.covered.data();
  host.binnings = binnings.data();
  host.sums = face_sums.data();
  host.bins = bins.data();
  const ExactNumbers known = exact_numbers(found.plan);
  for (std::uint32_t k = 0; k < stage.covered.size(); ++k) {
    covered_tile_on_host(host, known, k, stage.covering[k]);
    (*pause)();
  }
  std::vector<VisibleFace> visible;
  for (std::size_t f = 0; f < group.faces.size(); ++f)
    visible.push_back(visible_face(group.faces[f], face_sums.data() + f * CLRAY_FACE_SUMS));
  const SolvedView solved{found.number,
                          is_source(found.sights, found.sight),
                          found.sight.connections,
                          found.view.group().beams.front(),
                          visible.data(),
                          group.weights.data(),
                          found.points};
  std::size_t n = 0;
  for (const PassDetector& d : found.plan.detectors) {
    if (const auto add = room_of(d).solved) add({found.plan, d, found.geometry, solved}, sums);
    if (room_of(d).binning == nullptr) continue;
    const ClrayBinning& b = binnings[n++];
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::uint32_t r = 0; r < found.plan.request.replicates; ++r)
        add_histogram(found, d, bins.data() + b.offset + l * (b.bins + 2), l, r, sums);
    }
  }
}

void add_sampled(const TilesFound& found, const SampleSums& samples, Sums* sums) {
  const std::uint64_t lanes = found.plan.request.lanes.size(), replicates = found.plan.request.replicates;
  const double per_point = static_cast<double>(found.points) / found.plan.beams.area_m2[found.number];
  for (std::uint64_t l = 0; l < lanes; ++l) {
    const double largest = largest_share(found, l) * per_point;
    for (std::uint64_t r = 0; r < replicates; ++r) {
      const std::uint64_t row = l * replicates + r;
      std::size_t n = 0;
      for (const PassDetector& d : found.plan.detectors) {
        if (room_of(d).binning != nullptr) {
          const ClrayBinning& b = found.view.group().on_device.binnings[n++];
          const std::uint64_t at = b.offset * replicates + row * (b.bins + 2);
          add_histogram(found, d, samples.bins.data() + at, l, r, sums);
          set_counts(found, d, samples.hits.data() + at, largest, l, r, sums);
        } else if (room_of(d).solved != nullptr) {
          add_moments(found, d, samples.moments.data() + 3 * row, l, r, sums);
        }
      }
    }
  }
}

}  // namespace clray
