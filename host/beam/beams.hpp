// SPDX-License-Identifier: Apache-2.0
// Where rays start: for every orientation the rectangle that rays start from, the directions that hits are connected
// to, and where hinged parts stand. Body frame, metres.
#pragma once

#include <cstdint>
#include <vector>

#include "body/geometry.hpp"
#include "clray/result.hpp"
#include "shared/abi.h"

namespace clray {

/// A picture's size.
struct PictureSize {
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0;  ///< per pixel; 0: from the error target
};

/// Which rays are wanted.
struct BeamRequest {
  std::vector<Orientation> orientations;  ///< one per view
  /// Indices into Scene::observers: of a beam all that its hits are connected to, of pixels the one that looks.
  std::vector<int> observers;
  bool pixels = false;   ///< rays start at pixels, else at the beam
  bool mirrors = false;  ///< they start at the beam, and are followed from mirrors on: the rest of a picture
  PictureSize picture;

  /// Whether the sums of these rays are those of a picture: two halves and no totals.
  bool paints() const { return pixels || mirrors; }
};

/// How the pictures of a pass lie: axes per view, one pixel size, and the centre of each, from the body's origin
/// (middle) and from the reference point.
struct PictureFrame {
  std::vector<Vec3> right, up;
  std::vector<double> middle_right_m, middle_up_m;
  std::vector<double> centre_right_m, centre_up_m;
  double pixel_m = 0.0;
};

/// Where rays start, and what hits are connected to.
struct Beams {
  std::vector<ClrayView> views;
  std::vector<ClrayConnection> connections;  ///< [view][connection]
  std::vector<ClrayInstance> instances;
  std::vector<ClrayNode> nodes;      ///< the geometry's, then the top levels; empty: there are none
  std::vector<double> area_m2;       ///< that a ray of share 1 stands for, times the rays: of a beam, or of a pixel
  std::vector<ClrayStratum> strata;  ///< of all views' beams, see strata.hpp
  PictureFrame frame;
};

/// A range of path lengths, m, relative to the reference point.
struct PathRange {
  double low_m = 1e300, high_m = -1e300;

  void add(const PathRange& other);
};

/// The path lengths that one bounce can have.
struct PathRanges {
  std::size_t connections = 1;
  std::vector<PathRange> of;  ///< [view][connection]

  PathRange view(std::size_t view) const;
  PathRange connection(std::size_t connection) const;
};

/// Where rays start, what hits are connected to, and where hinged parts stand. Strata come later (strata.hpp).
Beams build_beams(const Scene& scene, const Geometry& geometry, const BeamRequest& request);

/// Where the parts of the body stand in an orientation.
std::vector<RigidMotion> motions_of(const Scene& scene, const Geometry& geometry, const Orientation& orientation);

/// Path lengths of one bounce.
PathRanges path_ranges(const Scene& scene, const Geometry& geometry, const BeamRequest& request, const Beams& beams);

}  // namespace clray
