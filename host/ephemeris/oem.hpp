// SPDX-License-Identifier: Apache-2.0
// CCSDS Orbit Ephemeris Messages, KVN, versions 1 to 3 (CCSDS 502.0-B-3, section 5).
#pragma once

#include <string>

#include "ephemeris/trajectory.hpp"

namespace clray::ephemeris {

/// Reads a file: one segment for each block, interpolated as the file says (Lagrange, Hermite, linear), or by Hermite
/// polynomials of degree 7. Covariances are passed over. Throws Error(input) with file:line.
Trajectory read_oem(const std::string& path);

}  // namespace clray::ephemeris
