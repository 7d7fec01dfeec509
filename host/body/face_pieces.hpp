// SPDX-License-Identifier: Apache-2.0
// The boxes that a tree is built over. A long face that lies askew fills little of its box, so rays that miss it open
// the leaf all the same. Such faces are cut into pieces with boxes of their own, and stand in several leaves.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "body/bvh.hpp"

namespace clray {

/// The faces (or shapes) of a body to those who build its tree. Both are asked by several threads.
struct BoxSource {
  std::size_t count = 0;
  std::function<Box(std::size_t)> box;
  std::function<const double*(std::size_t)> corners;  ///< nine numbers of a triangle; null for what is not cut
};

class FacePieces {
 public:
  /// Cuts, where it may, as Karras & Aila (2013), "Fast parallel construction of high-quality bounding volume
  /// hierarchies", section 4: at planes that halve the body's cube again and again, the coarser first; a face is cut
  /// the more often, the more of its box it does not need and the coarser the first plane through it. About kFurther
  /// pieces for each face are added, and none where boxes shrink by less than kLeastGain in all: a fine mesh has
  /// nothing to cut. Same faces, same pieces, on any host and with any number of threads (0: those of the processor).
  /// `body`: a box around all faces.
  FacePieces(BoxSource faces, const Box& body, bool may_cut, unsigned threads = 0);

  /// Boxes in all: those of the faces, or of their first pieces, then those of further pieces.
  std::size_t count() const { return faces_.count + further_.size(); }
  Box box(std::size_t k) const;
  std::uint32_t face(std::size_t k) const;

  static constexpr double kFurther = 0.2, kLeastGain = 0.1;

 private:
  struct Piece {
    std::uint32_t face;
    Box box;
  };
  struct Cube;
  struct Cut;
  double cuts_per_priority(const Cube& cube) const;
  void cut(const Cube& cube, double per_priority, unsigned threads);

  BoxSource faces_;
  std::vector<Piece> first_, further_;   // of faces that are cut, in their order
  std::vector<std::uint32_t> first_of_;  // of each face: its place in first_, or kWhole; empty where none is cut
};

}  // namespace clray
