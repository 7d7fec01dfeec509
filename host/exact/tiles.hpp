// SPDX-License-Identifier: Apache-2.0
// Cuts the beam's rectangle into tiles with few faces each. A tile keeps the faces that may be seen in it: those that
// meet it, and that no face hides which covers the whole tile (Warnock 1969). Everything depends on the faces alone, so
// the tiles are the same on every host.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

/// A tile with the faces that may be seen in it, numbers of BeamFaces::faces, the largest first; and the pieces of them
/// that are looked for.
struct TileFaces {
  double x0, x1, y0, y1;
  const std::vector<std::uint32_t>& faces;
  const std::vector<std::uint32_t>& pieces;
};

/// Calls `leaf` with every tile of the beam that holds a face. Stops when it returns false; returns whether it never
/// did.
bool cut_tiles(const BeamFaces& beam, const std::function<bool(const TileFaces&)>& leaf);
/// The same where only pieces of faces are looked for: with every tile that holds one.
bool cut_tiles(const BeamFaces& beam, const std::vector<ClrayPiece>& pieces,
               const std::function<bool(const TileFaces&)>& leaf);

}  // namespace clray
