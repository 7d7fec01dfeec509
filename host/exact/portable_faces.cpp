// SPDX-License-Identifier: Apache-2.0
// Compiles the kernels of exact passes for the host (see portable_faces.hpp).
#include "exact/portable_faces.hpp"

#include <algorithm>
#include <vector>

#include "body/host_opencl.hpp"
#include "clray/error.hpp"

// Some functions of the kernels stay unused; that a visible piece has corners is not seen.
#pragma GCC diagnostic ignored "-Wunused-function"
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#define CLRAY_LANES host_numbers.lanes
#define CLRAY_BINNINGS host_numbers.binnings
#define CLRAY_FROM_SOURCE host_numbers.from_source
#define CLRAY_CARRY host_numbers.carry

namespace clray {
namespace {

thread_local ExactNumbers host_numbers;

#include "exact/leaf.cl"
#include "exact/sample.cl"

Exact exact_of(const ExactBuffers& buffers) {
  Exact g{};
#define CLRAY_TAKE(type, name) g.name = buffers.name;
  CLRAY_EXACT_BUFFERS(CLRAY_TAKE)
#undef CLRAY_TAKE
  return g;
}

}  // namespace

bool face_hides(const ClrayFace& front, const ClrayFace& face, double margin) {
  double h[3];
  return hides(&front, &face, margin, h) == CLRAY_EVERYWHERE;
}

bool face_may_hide(const ClrayFace& front, const ClrayFace& face, double margin) {
  double h[3];
  return hides(&front, &face, margin, h) != CLRAY_NOWHERE;
}

void exact_item_on_host(const ExactBuffers& buffers, const ExactNumbers& numbers, bool seen, std::uint32_t item,
                        std::uint32_t skip, std::vector<ClrayPiece>* lit) {
  constexpr std::uint32_t kMostWaiting = 1u << 20, kLitTogether = 1024;
  host_numbers = numbers;
  Exact g = exact_of(buffers);
  thread_local std::vector<Fragment> stack(1024);
  std::vector<ClrayPiece> pieces(numbers.carry ? kLitTogether : 0);
  std::uint32_t full = 0, count[2];
  g.lit = pieces.data();
  g.lit_count = count;
  for (;;) {
    count[0] = 0;
    count[1] = static_cast<std::uint32_t>(pieces.size());
    const std::uint32_t done =
        exact_item(&g, item, seen ? 1u : 0u, stack.data(), static_cast<u32>(stack.size()), skip, &full);
    lit->insert(lit->end(), pieces.begin(), pieces.begin() + std::min(count[0], count[1]));
    if (!full) return;
    skip = std::max(skip, done);
    if (count[0] > count[1]) continue;  // the pieces had no room, not the fragments
    if (stack.size() >= kMostWaiting) throw Error(ErrorCode::bug, "a face falls into too many pieces", "exact pass");
    stack.resize(2 * stack.size());
  }
}

void covered_tile_on_host(const ExactBuffers& buffers, const ExactNumbers& numbers, std::uint32_t tile,
                          std::uint32_t face) {
  host_numbers = numbers;
  Exact g = exact_of(buffers);
  const ClrayTile& t = g.tiles[tile];
  Fragment f;
  f.corners = 0;
  fragment_add(&f, t.x0, t.y0);
  fragment_add(&f, t.x1, t.y0);
  fragment_add(&f, t.x1, t.y1);
  fragment_add(&f, t.x0, t.y1);
  fragment_close(&f);
  const f64 area = 0.5 * fragment_area2(&f);
  Kept kept{};
  keep_piece(g.faces + face, &f, area, &kept);
  add_to_bins(&g, face, &f, area);
  for (u32 k = 0; k < CLRAY_FACE_SUMS; ++k) atomic_add_i64(g.sums + face * CLRAY_FACE_SUMS + k, kept.sum[k]);
}

std::size_t sample_items(std::size_t tiles, std::uint32_t replicates) {
  return tiles * ((replicates + CLRAY_TOGETHER - 1u) / CLRAY_TOGETHER);
}

void sample_item_on_host(const SampleBuffers& buffers, const ExactNumbers& numbers, std::uint32_t item) {
  host_numbers = numbers;
  Sampled g{};
#define CLRAY_TAKE(type, name) g.name = buffers.name;
  CLRAY_SAMPLE_BUFFERS(CLRAY_TAKE)
#undef CLRAY_TAKE
  sample_item(&g, item);
}

}  // namespace clray
