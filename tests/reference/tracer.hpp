// SPDX-License-Identifier: Apache-2.0
// The judge of the tracer: a serial, brute-force delay tracer over plain triangles, in long double, with no
// acceleration structure and no code or formula file in common with kernels/ or host/. Single scattering,
// monostatic or bistatic. Body frame, m, s; A in m²/sr (docs/physics.md, section 1).
// A sample that lies within 1e-12 of the body's extent of a triangle's edge or of a bin's edge may be decided
// either way in fp64: it is excluded from the bins, counted, and what it could bring is bounded bin by bin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brdf.hpp"

namespace clray_reference {

struct Triangle {
  V3 a, b, c;
  std::size_t material = 0;
};

struct Body {
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
};

/// Rays start at corner + u·edge_u + v·edge_v, u and v in [0,1), and run against the source direction.
struct Beam {
  V3 corner, edge_u, edge_v;
};

/// The rectangle across the unit vector `s` that bounds the body; its axes are those of the orthonormal basis of
/// Duff et al. (2017), so x and y for s = ±z.
Beam bounding_beam(const Body& body, V3 s);

struct Window {
  Real first_s = 0;  ///< where the first bin starts
  Real bin_s = 1;
  std::size_t bins = 1;
};

struct Histogram {
  std::vector<Real> bin;            ///< decided samples, m²/sr
  std::vector<std::uint64_t> hits;  ///< decided samples with a weight above zero
  std::vector<Real> undecided;      ///< the most that excluded samples could add to each bin, m²/sr
  Real below = 0, above = 0;        ///< decided samples outside the window, m²/sr
  Real total = 0;                   ///< all decided samples, m²/sr
  std::uint64_t samples = 0, excluded = 0;
  Real sample_m2 = 0;  ///< beam area over samples
};

using Point = std::array<double, 2>;

/// Traces every point. `reference` is where the delay is zero.
Histogram trace(const Body& body, V3 s, V3 o, bool shadow_rays, const Beam& beam, const Window& window,
                const std::vector<Point>& points, V3 reference = {});

}  // namespace clray_reference
