// SPDX-License-Identifier: Apache-2.0
// See exact_self_test.hpp.
#include "pipeline/exact_self_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <vector>

#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "device/kernel_cache.hpp"
#include "exact/beam_faces.hpp"
#include "exact/portable_faces.hpp"
#include "exact/shadows.hpp"
#include "pipeline/exact_device.hpp"
#include "pipeline/sample_device.hpp"
#include "shared/philox.h"

namespace clray {
namespace {

constexpr std::uint32_t kFaces = 48, kBins = 64;

/// The beam that meets the test's faces.
BeamFrame test_frame() {
  return {v3(0.0, 0.0, 1.0), 4.0};
}

/// That of a light elsewhere.
BeamFrame test_light() {
  return {v3(0.48, 0.64, 0.6), 4.0};
}

/// A soup of triangles on a coarse lattice, so that many share corners, edges and planes, or lie in one place.
BeamFaces soup(const BeamFrame& frame, const vec3& source) {
  BeamFaces beam;
  static_cast<BeamFrame&>(beam) = frame;
  std::vector<ClrayFace>& faces = beam.faces;
  for (std::uint32_t n = 0; faces.size() < kFaces; ++n) {
    vec3 w[3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const u32 counter[4] = {n, k, 0x45786163u, 0u};
      u32 random[4];
      philox4x32(0x74u, 0x54657374u, counter, random);
      const auto lattice = [&](int i) { return (static_cast<double>(random[i] % 9u) - 4.0) / 4.0; };
      w[k] = v3(lattice(0), lattice(1), n % 3 == 0 ? 0.25 : lattice(2));
    }
    ClrayFace f{};
    const std::optional<FaceSide> side = place_face(frame, w[0], w[1], w[2], &f);
    if (!side) continue;
    set_path(frame, source, v3(0.0, 0.0, 0.0), &f);
    f.bin_scale = 0x1p50;
    f.order = n;
    f.carried = n % 2;
    faces.push_back(f);
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const ClrayFace& a, const ClrayFace& b) { return a.nearest > b.nearest; });
  for (const ClrayFace& f : faces) {
    beam.origins.emplace_back();
    beam.origins.back().number = f.order;
  }
  return beam;
}

void compare(const OpenedDevice& opened, const char* what, const std::vector<i64>& right,
             const std::vector<i64>& found) {
  for (std::size_t k = 0; k < right.size(); ++k) {
    if (right.size() != found.size() || right[k] != found[k])
      throw Error(ErrorCode::device,
                  fmt::format("refused: the self-test solved a small scene wrongly: {} {} is {}, not {}", what, k,
                              k < found.size() ? found[k] : 0, right[k]),
                  opened.info.name);
  }
}

/// What solving a group gives: sums of its faces, all bins, and lit pieces in an order of their own.
struct Solved {
  std::vector<i64> sums, bins;
  std::vector<ClrayPiece> lit;
};

Solved solve_on_host(const FaceGroup& group, const ItemBatch& batch, const ExactNumbers& numbers, std::size_t bins) {
  Solved out{std::vector<i64>(group.faces.size() * CLRAY_FACE_SUMS), std::vector<i64>(bins), {}};
  ExactBuffers host;
  host.faces = group.faces.data();
  host.weights = group.weights.data();
  host.tiles = batch.tiles.data();
  host.lists = batch.lists.data();
  host.items = batch.items.data();
  host.binnings = group.binnings.data();
  host.pieces = batch.pieces.data();
  host.sums = out.sums.data();
  host.bins = out.bins.data();
  for (std::uint32_t k = 0; k < batch.size(); ++k) exact_item_on_host(host, numbers, group.seen, k, 0, &out.lit);
  return out;
}

Solved solve_on_device(OpenedDevice& opened, const cl::Kernel& kernel, const FaceGroup& group, ItemBatch batch,
                       const ExactNumbers& numbers, std::size_t bins) {
  Solved out{std::vector<i64>(group.faces.size() * CLRAY_FACE_SUMS), std::vector<i64>(bins), {}};
  ExactDevice device(opened, kernel, numbers, bins);
  std::vector<std::vector<i64>> rows{std::vector<i64>(bins)};
  device.begin_group(group, {{0, bins}});
  device.launch_batch(&batch);
  device.end_group(&out.sums, &out.lit, &rows);
  out.bins = rows.front();
  return out;
}

/// Every bit of the lit pieces, whatever their order.
std::vector<i64> bits_of(std::vector<ClrayPiece> lit) {
  constexpr std::size_t kWords = sizeof(ClrayPiece) / sizeof(i64);
  std::vector<std::array<i64, kWords>> pieces(lit.size());
  for (std::size_t k = 0; k < lit.size(); ++k) std::memcpy(pieces[k].data(), &lit[k], sizeof(ClrayPiece));
  std::sort(pieces.begin(), pieces.end());
  std::vector<i64> bits;
  for (const auto& piece : pieces) {
    if (static_cast<std::uint64_t>(piece.back()) >> 32 != 0) bits.insert(bits.end(), piece.begin(), piece.end());
  }
  return bits;
}

Solved compared(OpenedDevice& opened, const cl::Kernel& kernel, const FaceGroup& group, const ItemBatch& batch,
                const ExactNumbers& numbers, std::size_t bins) {
  Solved right = solve_on_host(group, batch, numbers, bins);
  const Solved found = solve_on_device(opened, kernel, group, batch, numbers, bins);
  compare(opened, "sum", right.sums, found.sums);
  compare(opened, "bin", right.bins, found.bins);
  compare(opened, "number of a lit piece", bits_of(right.lit), bits_of(found.lit));
  return right;
}

/// The soup with weights, windows and the two tiles that it is solved in.
FaceGroup test_group(const ExactNumbers& numbers) {
  FaceGroup group;
  group.faces = soup(test_frame(), test_frame().toward).faces;
  for (std::size_t k = 0; k < group.faces.size() * numbers.lanes; ++k)
    group.weights.push_back(0.25 + static_cast<double>(k % 7) / 8.0);
  const std::uint64_t row = static_cast<std::uint64_t>(numbers.lanes) * (kBins + 2);
  for (std::uint32_t n = 0; n < numbers.binnings; ++n)
    group.binnings.push_back({-1.5, kBins / (3.0 + n), n * row, kBins});
  return group;
}

std::vector<ClrayTile> test_tiles() {
  const BeamFrame frame = test_frame();
  return {{-1.0, 0.1, -1.0, 1.0, frame.size, frame.margin, 0, kFaces},
          {0.1, 1.0, -1.0, 1.0, frame.size, frame.margin, 0, kFaces}};
}

/// Samples a view on the host and on the device.
void compare_samples(OpenedDevice& opened, const cl::Kernel& kernel, const ExactNumbers& numbers,
                     const FaceGroup& group, const LightBeam& light, const SampledTiles& tiles,
                     const ClraySampling& sampling) {
  const std::uint32_t replicates = sampling.replicates;
  const std::uint64_t bins = static_cast<std::uint64_t>(numbers.binnings) * numbers.lanes * (kBins + 2) * replicates;
  std::vector<double> values(tiles.tiles.size() * replicates);
  std::vector<i64> sums(std::size_t{3} * numbers.lanes * replicates), histogram(bins);
  std::vector<u32> hits(bins);
  SampleBuffers host;
  host.faces = group.faces.data();
  host.weights = group.weights.data();
  host.tiles = tiles.tiles.data();
  host.listed = tiles.listed.data();
  host.carried = light.carried.data();
  host.lit_faces = light.faces.data();
  host.shaded = tiles.shaded.data();
  host.blockers = tiles.blockers.data();
  host.binnings = group.binnings.data();
  host.sampling = &sampling;
  host.values = values.data();
  host.sums = sums.data();
  host.bins = histogram.data();
  host.hits = hits.data();
  for (std::uint32_t k = 0; k < sample_items(tiles.tiles.size(), replicates); ++k)
    sample_item_on_host(host, numbers, k);
  SampleDevice device(opened, kernel, numbers);
  device.begin_view(group, light);
  const auto bits = [](const std::vector<double>& x) {
    std::vector<i64> out(x.size());
    std::memcpy(out.data(), x.data(), x.size() * sizeof(double));
    return out;
  };
  const SampleSums found = device.sample(tiles, sampling, nullptr);
  compare(opened, "value", bits(values), bits(found.values));
  compare(opened, "sampled sum", sums, found.moments);
  compare(opened, "sampled bin", histogram, found.bins);
  compare(opened, "hit", std::vector<i64>(hits.begin(), hits.end()),
          std::vector<i64>(found.hits.begin(), found.hits.end()));
}

}  // namespace

void run_exact_self_test(OpenedDevice& opened, const std::string& source, const cl::Kernel& kernel,
                         const ExactNumbers& numbers) {
  const std::string what = "solved\n" + source;
  if (remembered(opened, what)) return;
  FaceGroup group = test_group(numbers);
  const std::uint64_t row = static_cast<std::uint64_t>(numbers.lanes) * (kBins + 2);
  ItemBatch batch;
  batch.tiles = test_tiles();
  for (std::uint32_t f = 0; f < kFaces; ++f) {
    const ClrayFace& face = group.faces[f];
    batch.lists.push_back({{face.box[0], face.box[1], face.box[2], face.box[3]}, face.nearest, f, 0});
    for (const std::uint32_t tile : {0u, 1u}) batch.items.insert(batch.items.end(), {tile, f});
  }
  const std::uint64_t bins = numbers.binnings * row;
  const Solved lit = compared(opened, kernel, group, batch, numbers, bins);
  if (numbers.carry) {
    // As if an observer elsewhere saw them in the same places.
    group.seen = true;
    batch.items.clear();
    for (const ClrayPiece& piece : lit.lit) {
      if (piece.corners == 0) continue;
      for (const std::uint32_t tile : {0u, 1u}) {
        batch.items.insert(batch.items.end(), {tile, piece.face});
        batch.pieces.push_back(piece);
      }
    }
    compared(opened, kernel, group, batch, numbers, bins);
  }
  remember(opened, what);
}

void run_sample_self_test(OpenedDevice& opened, const std::string& source, const cl::Kernel& kernel,
                          const ExactNumbers& numbers) {
  const std::string what = "sampled\n" + source;
  if (remembered(opened, what)) return;
  FaceGroup group = test_group(numbers);
  SampledTiles tiles;
  tiles.tiles = test_tiles();
  for (std::uint32_t f = 0; f < kFaces; ++f) tiles.listed.push_back(f);
  ClraySampling sampling{};
  sampling.inv_path_per_m = 0.25;
  sampling.key0 = 0x74u;
  sampling.key1 = 0x65737453u;
  sampling.replicates = 60;
  sampling.adds = 1;
  compare_samples(opened, kernel, numbers, group, {}, tiles, sampling);
  if (numbers.carry) {
    const BeamFaces seen = soup(test_frame(), test_light().toward), lit = soup(test_light(), test_light().toward);
    const Shadows shadows(seen, lit);
    group.faces = seen.faces;
    tiles.blockers = shadows.blockers();
    tiles.shaded = {0, kFaces, 0, kFaces};
    sampling.elsewhere = 1;
    compare_samples(opened, kernel, numbers, group, {lit.faces, shadows.carried()}, tiles, sampling);
  }
  remember(opened, what);
}

}  // namespace clray
