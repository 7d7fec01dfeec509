// SPDX-License-Identifier: Apache-2.0
// Exact answers for tests and benchmarks. Nothing here comes from kernels/ or host/: single scattering A = ∫ f μ_i μ_o
// dA worked out by hand (docs/physics.md, section 1) and, for convex polyhedra, facet by facet. m, s, sr.
#pragma once

#include <functional>
#include <vector>

#include "support/scenes.hpp"

namespace clray_test {

/// Share of a pulse that has come back by a delay in s: 0 … 1.
using Cdf = std::function<double(double)>;

/// A pulse: its total, m²/sr, and the share of it up to each two-way delay.
struct Pulse {
  double total_m2_per_sr = 0.0;
  Cdf share;
};

/// One-way depth CDF (m from the body's origin, away from the station) as a monostatic delay CDF.
Cdf two_way(const std::function<double(double)>& share_of_depth);

/// A convex polyhedron of Lambert reflectance `rho`: sum over the facets lit and seen; within a facet the delay
/// -(s + o)·x/c is linear, so its CDF over a triangle is piecewise quadratic.
Pulse convex_lambert(const clray::Mesh& mesh, double rho, clray::Vec3 s, clray::Vec3 o);

/// Facets of which none hides another, seen from where they are lit: `intensity` is A per m² at a cosine.
Pulse monostatic_facets(const clray::Mesh& mesh, clray::Vec3 s, const std::function<double(double)>& intensity);

Pulse lambert_sphere(double rho, double radius);
Pulse lambert_disc(double rho, double radius, double tilt);
Pulse lambert_plate(double rho, double a, double b, double tilt);  ///< tilted about the edge b
Pulse lambert_cone(double rho, double radius, double height);      ///< apex toward the station, base at 0
Pulse lambert_cylinder_side(double rho, double radius, double length);

/// [sin α + (π − α) cos α]/π: Lambert sphere's phase function, 1 at α = 0.
double lambert_phase(double alpha);

/// Monostatic A of a square metre of Ashikhmin-Shirley facet at a cosine (docs/physics.md, section 2,
/// with h = s, u = 1).
double ashikhmin_shirley_facet(double rho, double d, double n, double mu);
/// Monostatic A of an Ashikhmin-Shirley sphere: specular part R²/4·s·F0·(n+1)/(n+2), diffuse part by quadrature.
double ashikhmin_shirley_sphere(double rho, double d, double n, double radius);
/// Its specular part alone, in closed form.
double ashikhmin_shirley_sphere_specular(double rho, double d, double n, double radius);

/// ∫ f over [a, b], adaptive Simpson, to ~1e-12 of the largest |f|·(b − a).
double integrate(const std::function<double(double)>& f, double a, double b);

}  // namespace clray_test
