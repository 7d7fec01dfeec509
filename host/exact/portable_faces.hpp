// SPDX-License-Identifier: Apache-2.0
// The kernels of exact passes on the host: the same text that devices run, for the tiles, for items that a device
// leaves unfinished, and for the self-test.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/exact_buffers.h"
#include "shared/abi.h"

namespace clray {

/// Whether `front` hides `face` wherever both are at one place of the beam.
bool face_hides(const ClrayFace& front, const ClrayFace& face, double margin);
/// Whether it hides any of it there.
bool face_may_hide(const ClrayFace& front, const ClrayFace& face, double margin);

/// The buffers of exact_item() on the host.
struct ExactBuffers {
#define CLRAY_MEMBER(type, name) type* name = nullptr;
  CLRAY_EXACT_BUFFERS(CLRAY_MEMBER)
#undef CLRAY_MEMBER
};

/// Those of sample_item().
struct SampleBuffers {
#define CLRAY_MEMBER(type, name) type* name = nullptr;
  CLRAY_SAMPLE_BUFFERS(CLRAY_MEMBER)
#undef CLRAY_MEMBER
};

/// What a device's program is built with.
struct ExactNumbers {
  std::uint32_t lanes = 1, binnings = 0;
  bool from_source = true;  ///< an observer is at the source: what is lit is seen
  bool tiles = false;       ///< tiles that are not solved are sampled
  bool carry = false;       ///< observers are elsewhere: lit pieces are carried to their views
};

/// One item, as a work-item of a device does it, from the fragment numbered `skip` on: a face in a tile, or (`seen`)
/// a lit piece in a tile of an observer's view. Appends lit pieces to *lit; `buffers` needs no room for them. Throws
/// Error(bug) where the fragments that wait grow beyond all bounds.
void exact_item_on_host(const ExactBuffers& buffers, const ExactNumbers& numbers, bool seen, std::uint32_t item,
                        std::uint32_t skip, std::vector<ClrayPiece>* lit);

/// A tile that a face covers: all of it is seen.
void covered_tile_on_host(const ExactBuffers& buffers, const ExactNumbers& numbers, std::uint32_t tile,
                          std::uint32_t face);

/// How many work-items sample so many tiles.
std::size_t sample_items(std::size_t tiles, std::uint32_t replicates);

/// The points of some replicates in one tile that is not solved, as a work-item of a device takes them.
void sample_item_on_host(const SampleBuffers& buffers, const ExactNumbers& numbers, std::uint32_t item);

}  // namespace clray
