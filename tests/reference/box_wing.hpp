// SPDX-License-Identifier: Apache-2.0
// A box with two flat wings, by hand: planes y = const part the three, so who can hide whom is known, and what is
// hidden is an overlap of convex outlines. In long double; it shares no formula with kernels/ or host/.
#pragma once

#include <array>

namespace clray_reference {

/// The box is centred, with sides along the axes. A wing is a rectangle about (0, ±wing_y, 0): `half_span` along y, and
/// `half_chord` across it. It lies beyond the box: wing_y - half_span > half[1].
struct BoxWing {
  std::array<double, 3> half;
  double wing_y, half_span;
  std::array<double, 3> half_chord;  // its y is 0
};

/// Of light from `source` (unit): the sum of visible area across the beam times cosine over all faces, and the area
/// across the beam that others hide; m².
struct BoxWingView {
  long double area_times_cosine = 0, hidden = 0;
};
BoxWingView box_wing_view(const BoxWing& body, const std::array<double, 3>& source);

}  // namespace clray_reference
