// SPDX-License-Identifier: Apache-2.0
// The material table of a pass: one row per lane (variant and band), one column per scene material, with the tables
// that models look up. Also the bound of first-bounce weights, from which the fixed-point scale follows.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clray/scene.hpp"
#include "scene/tables.hpp"
#include "shared/abi.h"

namespace clray {

/// A variant and band under which hits are shaded.
struct Lane {
  std::string variant, band_name;
  int variant_index = -1;  ///< -1: the scene as it is
  Band band;
  double share = 1.0;  ///< of its record's light: below 1 where several lanes are parts of one band
};

/// Lanes first … end - 1 of a pass that make one record: one lane, or the parts of one band.
struct LaneRecord {
  std::size_t first = 0, end = 0;
};

struct Surfaces {
  std::vector<ClrayMaterial> materials;  ///< [lane][material]
  std::vector<double> tables;
  std::uint32_t columns = 0;
  std::vector<int> models;  ///< rows of brdf.def in use, ascending
  bool one_sided = false;   ///< some material has a black back
  bool delta = false;       ///< some material is an ideal reflector
};

/// Every (variant, band) of the scene, variants outermost.
std::vector<Lane> lanes_of(const Scene& scene);

/// The same as a detector, a row of detector.def, wants them: a band that it takes whole is in parts where a surface's
/// keys change within it (light_parts.hpp).
std::vector<Lane> lanes_of(const Scene& scene, const TableRow& detector);

/// The records that lanes make; parts of one band stand together.
std::vector<LaneRecord> lane_records(const std::vector<Lane>& lanes);

/// Lanes that one pass can trace, in groups of at most `most`; the scene's order is kept. What decides whether a face
/// is hit (its lit sides) is one for a whole pass. Where paths `scatter`, lanes share their directions: the bands of
/// one variant, 8 at most, and a lane with ideal reflections goes alone.
std::vector<std::vector<Lane>> lane_groups(const Scene& scene, const std::vector<Lane>& lanes, bool scatter,
                                           std::size_t most);

/// Materials of `lanes`; with `reflectances`, tables of directional reflectance too.
Surfaces build_surfaces(const Scene& scene, const std::vector<Lane>& lanes, bool reflectances = false);

/// Bound of f·mu_o over all lanes and materials at cos(phase/2); 1/sr.
double weight_bound(const Surfaces& surfaces, double cos_half_phase);

}  // namespace clray
