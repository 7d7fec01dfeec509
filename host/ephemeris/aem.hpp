// SPDX-License-Identifier: Apache-2.0
// CCSDS Attitude Ephemeris Messages, KVN, versions 1 and 2 (CCSDS 504.0-B-1 section 4, 504.0-B-2 section 5).
#pragma once

#include <string>

#include "ephemeris/attitude_table.hpp"

namespace clray::ephemeris {

/// Reads a file: quaternions, Euler angles or a spin, with or without rates, which are not used. Quaternions are
/// interpolated along the great circle, or by Lagrange's polynomial where the file asks for it. Throws Error(input)
/// with file:line.
AttitudeTable read_aem(const std::string& path);

}  // namespace clray::ephemeris
