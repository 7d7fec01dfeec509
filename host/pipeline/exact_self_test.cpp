// SPDX-License-Identifier: Apache-2.0
// See exact_self_test.hpp.
#include "pipeline/exact_self_test.hpp"

#include <fmt/format.h>

#include <vector>

#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "device/kernel_cache.hpp"
#include "exact/beam_faces.hpp"
#include "exact/portable_faces.hpp"
#include "pipeline/exact_device.hpp"
#include "shared/philox.h"

namespace clray {
namespace {

constexpr std::uint32_t kFaces = 48, kBins = 64;

/// The beam that meets the test's faces.
BeamFrame test_frame() {
  return {v3(0.0, 0.0, 1.0), 4.0};
}

/// A soup of triangles on a coarse lattice, so that many share corners, edges and planes, or lie in one place.
std::vector<ClrayFace> soup() {
  const BeamFrame frame = test_frame();
  std::vector<ClrayFace> faces;
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
    if (!place_face(frame, w[0], w[1], w[2], &f)) continue;
    f.path_m = -2.0 * f.depth0;
    f.bin_scale = 0x1p50;
    f.order = static_cast<std::uint32_t>(faces.size());
    faces.push_back(f);
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const ClrayFace& a, const ClrayFace& b) { return a.nearest > b.nearest; });
  return faces;
}

void compare(const OpenedDevice& opened, const char* what, const std::vector<i64>& right,
             const std::vector<i64>& found) {
  for (std::size_t k = 0; k < right.size(); ++k) {
    if (right[k] != found[k])
      throw Error(ErrorCode::device,
                  fmt::format("refused: the self-test solved a small scene wrongly: {} {} is {}, not {}", what, k,
                              found[k], right[k]),
                  opened.info.name);
  }
}

}  // namespace

void run_exact_self_test(OpenedDevice& opened, const std::string& source, const cl::Kernel& kernel,
                         const ExactNumbers& numbers) {
  const std::string what = "solved\n" + source;
  if (remembered(opened, what)) return;
  FaceGroup group;
  group.faces = soup();
  for (std::size_t k = 0; k < group.faces.size() * numbers.lanes; ++k)
    group.weights.push_back(0.25 + static_cast<double>(k % 7) / 8.0);
  const std::uint64_t row = static_cast<std::uint64_t>(numbers.lanes) * (kBins + 2);
  std::vector<ClrayBinning> windows;
  for (std::uint32_t n = 0; n < numbers.binnings; ++n) windows.push_back({-1.5, kBins / (3.0 + n), n * row, kBins});
  ItemBatch batch;
  const BeamFrame frame = test_frame();
  batch.tiles = {{-1.0, 0.1, -1.0, 1.0, frame.size, frame.margin, 0, kFaces},
                 {0.1, 1.0, -1.0, 1.0, frame.size, frame.margin, 0, kFaces}};
  for (std::uint32_t f = 0; f < kFaces; ++f) {
    const ClrayFace& face = group.faces[f];
    batch.lists.push_back({{face.box[0], face.box[1], face.box[2], face.box[3]}, face.nearest, f, 0});
    for (const std::uint32_t tile : {0u, 1u}) batch.items.insert(batch.items.end(), {tile, f});
  }
  std::vector<i64> sums(group.faces.size() * CLRAY_FACE_SUMS), bins(numbers.binnings * row);
  ExactBuffers host{group.faces.data(), group.weights.data(), batch.tiles.data(),
                    batch.lists.data(), batch.items.data(),   windows.data(),
                    sums.data(),        bins.data(),          nullptr};
  for (std::uint32_t k = 0; k < batch.size(); ++k) exact_item_on_host(host, numbers, k, 0);
  ExactDevice device(opened, kernel, numbers, windows, bins.size());
  std::vector<i64> found_sums(sums.size()), found_bins(bins.size());
  device.begin_group(group);
  device.launch_batch(&batch);
  device.end_group(&found_sums);
  device.read_bins(&found_bins);
  compare(opened, "sum", sums, found_sums);
  compare(opened, "bin", bins, found_bins);
  remember(opened, what);
}

}  // namespace clray
