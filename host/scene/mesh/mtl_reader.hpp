// SPDX-License-Identifier: Apache-2.0
// Reads an MTL material library into Materials: rho = F0 = min(1, mean Kd + mean Ks), d = Kd / (Kd + Ks), n = Ns;
// Ashikhmin-Shirley where Ks > 0 and illum >= 2, else Lambert with mean Kd; the default surface where neither is given.
#pragma once

#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "text/name_index.hpp"

namespace clray {

/// What a material without a name is called.
inline const std::string kUnnamedMaterial = "(unnamed)";

struct MaterialLibrary {
  std::vector<Material> materials;  ///< in the file's order, each name once (the last counts), comments included
  text::NameIndex place_of;         ///< the place of each name in `materials`
};

/// Reads the library `path`. Values out of range are taken to its end, with one warning a kind (file:line).
/// Throws Error(input) where a value that is used is no number.
MaterialLibrary read_mtl(const std::string& path, std::vector<std::string>& warnings);

}  // namespace clray
