// SPDX-License-Identifier: Apache-2.0
// Compiles the kernels of exact passes for the host (see portable_faces.hpp).
#include "exact/portable_faces.hpp"

#include <algorithm>
#include <vector>

#include "body/host_opencl.hpp"
#include "clray/error.hpp"

// Some functions of the kernels stay unused; that a visible piece has corners is not seen.
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

#define CLRAY_LANES host_numbers.lanes
#define CLRAY_BINNINGS host_numbers.binnings
#define CLRAY_FROM_SOURCE host_numbers.from_source
#define CLRAY_CARRY host_numbers.carry

namespace clray {
namespace {

thread_local ExactNumbers host_numbers;

#include "exact/leaf.cl"

}  // namespace

bool face_hides(const ClrayFace& front, const ClrayFace& face, double margin) {
  double h[3];
  return hides(&front, &face, margin, h) == CLRAY_EVERYWHERE;
}

void exact_item_on_host(const ExactBuffers& buffers, const ExactNumbers& numbers, bool seen, std::uint32_t item,
                        std::uint32_t skip, std::vector<ClrayPiece>* lit) {
  constexpr std::uint32_t kMostWaiting = 1u << 20, kLitTogether = 1024;
  host_numbers = numbers;
  Exact g{};
#define CLRAY_TAKE(type, name) g.name = buffers.name;
  CLRAY_EXACT_BUFFERS(CLRAY_TAKE)
#undef CLRAY_TAKE
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

}  // namespace clray
