// SPDX-License-Identifier: Apache-2.0
// The material table of a pass: one row per lane (variant and band), one column per scene material, with the tables
// that models look up. Also the bound of first-bounce weights, from which the fixed-point scale follows.
#pragma once

#include <cstdint>
#include <vector>

#include "body/lanes.hpp"
#include "shared/abi.h"

namespace clray {

struct MaterialTable {
  std::vector<ClrayMaterial> rows;  ///< [lane][material]
  std::vector<double> tables;
  std::uint32_t columns = 0;
  std::vector<int> models;  ///< rows of brdf.def in use, ascending
  bool one_sided = false;   ///< some material has a black back
  bool delta = false;       ///< some material is an ideal reflector

  const ClrayMaterial& of(std::size_t lane, std::uint32_t material) const { return rows[lane * columns + material]; }
};

/// Materials of `lanes`; with `reflectances`, tables of directional reflectance too.
MaterialTable material_table(const Scene& scene, const std::vector<Lane>& lanes, bool reflectances = false);

/// Bound of f·mu_o over all lanes and materials at cos(phase/2); 1/sr.
double weight_bound(const MaterialTable& table, double cos_half_phase);

}  // namespace clray
