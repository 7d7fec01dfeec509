// SPDX-License-Identifier: Apache-2.0
// Reads an MTL material library into Materials: rho = F0 = min(1, mean Kd + mean Ks), d = Kd / (Kd + Ks), n = Ns;
// Ashikhmin-Shirley where Ks > 0 and illum >= 2, else Lambert with mean Kd; the default surface where neither is given.
#pragma once

#include <string>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// What a material without a name is called.
inline const std::string kUnnamedMaterial = "(unnamed)";

/// The materials of the library `path`, in its order, each name once (the last counts), as the file writes them,
/// comments included. Values out of range are taken to its end, with one warning a kind (file:line).
/// Throws Error(input) where a value that is used is no number.
std::vector<Material> read_mtl(const std::string& path, std::vector<std::string>& warnings);

}  // namespace clray
