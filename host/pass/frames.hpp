// SPDX-License-Identifier: Apache-2.0
// From one frame of the Earth to another, by ERFA: IAU 2006/2000A precession and nutation, Earth rotation angle, polar
// motion (docs/physics.md, section 10). Geocentric; gcrf is the frame to which all others are brought.
#pragma once

#include <glm/mat3x3.hpp>
#include <vector>

#include "pass/eop.hpp"

namespace clray::pass {

using Matrix = glm::dmat3;

/// The Earth's attitude over a span of time. Precession and nutation are computed every 15 minutes, and taken linear
/// between, which leaves 3e-12 rad; over more than 40 days for each epoch by itself.
class EarthFrames {
 public:
  /// For epochs from `start` to `stop` and an hour around them.
  EarthFrames(const ephemeris::Epoch& start, const ephemeris::Epoch& stop, EarthOrientation orientation);

  /// Takes vectors of gcrf to itrf.
  Matrix itrf_of_gcrf(const ephemeris::Epoch& epoch) const;
  /// Takes vectors of `frame` to gcrf.
  Matrix gcrf_of(Frame frame, const ephemeris::Epoch& epoch) const;

  bool orientation_known() const { return orientation_.known(); }

  /// The Earth's rate of turning, rad/s, for velocities in its frame.
  static constexpr double kEarthRate_rad_s = 7.292115146706979e-5;

 private:
  struct Node {
    double x = 0.0, y = 0.0, s = 0.0;  ///< of the celestial intermediate pole and origin
    Matrix tod_of_gcrf{1.0};
  };
  static Node exact_node(const ephemeris::Epoch& epoch);
  Node node_at(const ephemeris::Epoch& epoch) const;

  ephemeris::Epoch zero_;
  std::vector<Node> nodes_;
  EarthOrientation orientation_;
};

}  // namespace clray::pass
