// SPDX-License-Identifier: Apache-2.0
// Reads an MTL material library into Materials: rho = F0 = min(1, mean Kd + mean Ks), d = Kd / (Kd + Ks), n = Ns;
// Ashikhmin-Shirley where Ks > 0 and illum >= 2, else Lambert with mean Kd.
#pragma once

#include <string>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// All materials of the library `path`, in its order. Appends warnings with file:line.
/// Throws Error(input) where Kd or Ks leave [0,1], Ns leaves [0,1e6], or a line is malformed.
std::vector<Material> read_mtl(const std::string& path, std::vector<std::string>& warnings);

}  // namespace clray
