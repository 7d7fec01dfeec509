// SPDX-License-Identifier: Apache-2.0
// Which faces of the light's beam may shade what an observer elsewhere sees, tile by tile. What is seen of a face in a
// rectangle across the observer's view is carried into the beam of the light (carry.hpp); there faces that meet it and
// may lie before it are its blockers.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/beam_faces.hpp"
#include "exact/carry.hpp"
#include "exact/seen_faces.hpp"

namespace clray {

class Shadows {
 public:
  /// Both must stay.
  Shadows(const BeamFaces& seen, const BeamFaces& lit);

  /// Where each seen face is in the beam of the light.
  const std::vector<ClrayCarried>& carried() const { return carried_; }
  /// Every face that may be one: all of the beam of the light.
  std::vector<std::uint32_t> blockers() const;
  /// Whether light comes to the side of a face that is seen.
  bool may_be_lit(std::uint32_t face) const { return carried_[face].there != CLRAY_NOT_THERE; }
  /// Gives *kept those blockers that may shade one of some faces in a rectangle. False: all these are in shadow.
  bool keep(const Rectangle& r, const std::vector<std::uint32_t>& faces, const std::vector<std::uint32_t>& blockers,
            std::vector<std::uint32_t>* kept) const;

 private:
  /// What is seen of a face in a rectangle, in the beam of the light.
  struct Patch {
    std::uint32_t own;
    double x[4], y[4], depth[4];
    double x0, x1, y0, y1, farthest;
    double error;  // of its corners
  };

  Patch patch(std::uint32_t face, const Rectangle& r) const;
  void near(const std::vector<Patch>& patches, const std::vector<std::uint32_t>& blockers,
            std::vector<std::uint32_t>* kept) const;
  bool may_shade(std::uint32_t blocker, const Patch& patch) const;
  bool shades_all(std::uint32_t blocker, const Patch& patch) const;

  const BeamFaces &seen_, &lit_;
  std::vector<ClrayCarried> carried_;
};

}  // namespace clray
