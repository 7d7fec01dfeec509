// SPDX-License-Identifier: Apache-2.0
// Lit pieces of faces, carried from the beam of the light to where an observer sees them. A piece lies in the plane of
// its face, so it is the face that carries it: no face is projected along a foreign direction, and nothing becomes
// huge.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

/// Faces of one beam in another.
class Carrier {
 public:
  Carrier(const BeamFaces& lit, const BeamFaces& seen);

  /// Where a lit face is seen from the side that is lit: its number in the other beam. -1: it is not.
  std::int64_t seen(std::uint32_t lit) const { return seen_[lit]; }
  /// A piece of a face of the light's beam in the other; its `face` is known there (seen()).
  ClrayPiece carry(const ClrayPiece& piece) const;

 private:
  const BeamFaces &from_, &to_;
  std::vector<std::int64_t> seen_;  // of each lit face
};

}  // namespace clray
