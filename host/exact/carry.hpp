// SPDX-License-Identifier: Apache-2.0
// Pieces and points of faces, carried from the beam of the light to where an observer sees them, or back. They lie in
// the plane of their face, so it is the face that carries them: no face is projected along a foreign direction, and
// nothing becomes huge.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

/// Faces of one beam in another.
class Carrier {
 public:
  Carrier(const BeamFaces& lit, const BeamFaces& seen);

  /// Where a face is met from the same side: its number in the other beam. -1: it is not.
  std::int64_t seen(std::uint32_t face) const { return seen_[face]; }
  /// How steps across this beam are steps across the other, by way of such a face.
  ClrayCarried steps(std::uint32_t face) const;
  /// A piece of a face of the light's beam in the other; its `face` is known there (seen()).
  ClrayPiece carry(const ClrayPiece& piece) const;

 private:
  const BeamFaces &from_, &to_;
  std::vector<std::int64_t> seen_;  // of each lit face
};

/// What a carried place may be off, m.
double carried_error(const ClrayCarried& steps, double size);

}  // namespace clray
