// SPDX-License-Identifier: Apache-2.0
// Scenes of the exact method and what is asked of their results. Numbers are integers of a unit near 2^-61 of the beam
// times the largest weight; coordinates carry the rounding of fp64. So closed forms must hold to 1e-12.
#pragma once

#include <array>
#include <vector>

#include "clray/trace.hpp"
#include "support/checks.hpp"

namespace clray_test {

constexpr double kExact = 1e-12;

/// A scene of one Lambert mesh, lit and seen from `s`.
clray::Scene lambert_scene(const MeshPtr& mesh, clray::Vec3 s, double rho = 0.5);

/// Runs a scene by the exact method.
clray::Result solve(clray::Scene scene);

/// A of the first record.
const clray::Estimate& total(const clray::Result& result);

/// A is as it must be, to 1e-12 and within the bound that it claims, and its parts add up.
void check_exact(const clray::Result& result, double expected);

/// The bins of the first record are those of a pulse.
void check_exact_bins(const clray::Result& result, const Pulse& exact);

using Triangles = std::vector<std::array<clray::Vec3, 3>>;

MeshPtr mesh_of(const Triangles& triangles);

/// Adds the quadrilateral with these corners.
void add_quad(Triangles* triangles, clray::Vec3 a, clray::Vec3 b, clray::Vec3 c, clray::Vec3 d);

/// Random triangles in general position: each within `size` of a random point of the cube [-1, 1]^3.
Triangles soup(std::uint64_t seed, int count, double size);

}  // namespace clray_test
