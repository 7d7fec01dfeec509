// SPDX-License-Identifier: Apache-2.0
// The beam of a view cut into tiles of two kinds: those that one face covers, which are solved, and those whose points
// must be asked which face they see. Cutting those again that spread most makes the rest of them matter less and less:
// the error of a point in each falls with the power -1.5 of their number (docs/exact.md). Where the light comes from
// elsewhere, a tile that one face covers is solved if no other face may shade it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "exact/seen_faces.hpp"
#include "exact/shadows.hpp"

namespace clray {

class Frontier {
 public:
  struct Tile {
    Rectangle at;
    std::vector<std::uint32_t> faces;     ///< that may be seen in it
    std::vector<std::uint32_t> blockers;  ///< faces of the light's beam that may shade them
    std::uint32_t level = 0;              ///< cuts of each side, and one
  };

  /// `shines`: whether a face sends anything; tiles without such faces are left out. `shadows`: null where the light
  /// comes from where the beam is seen. Both must stay.
  Frontier(const BeamFaces& beam, const Shadows* shadows, std::function<bool(std::uint32_t)> shines);

  const std::vector<Tile>& mixed() const { return mixed_; }      ///< to be sampled
  const std::vector<Tile>& covered() const { return covered_; }  ///< by the one face that they hold

  /// Cuts the mixed tiles of the largest spread until there are `count`, or none that can be cut. False: nothing was
  /// cut.
  bool cut(const std::vector<double>& spread, std::size_t count);

 private:
  void add(const Rectangle& at, const Tile& whole, std::vector<Tile>* mixed);

  const SeenFaces seen_;
  const Shadows* shadows_;
  const std::function<bool(std::uint32_t)> shines_;
  std::vector<Tile> mixed_, covered_;
};

}  // namespace clray
