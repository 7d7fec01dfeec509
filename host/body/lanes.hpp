// SPDX-License-Identifier: Apache-2.0
// Lanes: under which variants and bands the hits of a pass are shaded. All lanes of a pass share its rays. Wavelengths
// in nm.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "scene/tables.hpp"

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

/// A material of the scene, or what the lane's variant has in its place.
const Material& material_of(const Scene& scene, const Lane& lane, const Material& base);

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

}  // namespace clray
