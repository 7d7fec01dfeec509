// SPDX-License-Identifier: Apache-2.0
// See lanes.hpp. Wavelengths in nm.
#include "body/lanes.hpp"

#include <algorithm>
#include <utility>

#include "body/light_parts.hpp"
#include "body/materials.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

/// A lane for each variant and band; those of the parts of one band have no band's name, but shares.
std::vector<Lane> lanes_in(const Scene& scene, const std::vector<Band>& bands, const std::vector<double>& shares) {
  std::vector<Lane> lanes;
  for (std::size_t v = 0; v < std::max<std::size_t>(scene.variants.size(), 1); ++v) {
    for (std::size_t b = 0; b < bands.size(); ++b) {
      Lane lane;
      if (!scene.variants.empty()) {
        lane.variant = scene.variants[v].name;
        lane.variant_index = static_cast<int>(v);
      }
      lane.band = bands[b];
      if (shares.empty() && bands.size() > 1) lane.band_name = bands[b].name;
      if (!shares.empty()) lane.share = shares[b];
      lanes.push_back(lane);
    }
  }
  return lanes;
}

}  // namespace

const Material& material_of(const Scene& scene, const Lane& lane, const Material& base) {
  if (lane.variant_index < 0) return base;
  for (const Material& m : scene.variants[lane.variant_index].materials) {
    if (m.name == base.name) return m;
  }
  return base;
}

std::vector<Lane> lanes_of(const Scene& scene) {
  return lanes_in(scene, bands_of(scene), {});
}

std::vector<Lane> lanes_of(const Scene& scene, const TableRow& detector) {
  const std::vector<Band> bands = bands_of(scene, detector);
  if (!takes_all_light(scene, detector)) return lanes_in(scene, bands, {});
  const LightParts parts = parts_of(scene, bands.front());
  return parts.bands.size() > 1 ? lanes_in(scene, parts.bands, parts.shares) : lanes_in(scene, bands, {});
}

std::vector<LaneRecord> lane_records(const std::vector<Lane>& lanes) {
  std::vector<LaneRecord> records;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    const bool part = l > 0 && lanes[l].share < 1.0 && lanes[l].variant_index == lanes[l - 1].variant_index;
    if (!part) records.push_back({l, l});
    records.back().end = l + 1;
  }
  return records;
}

std::vector<std::vector<Lane>> lane_groups(const Scene& scene, const std::vector<Lane>& lanes, bool scatter,
                                           std::size_t most) {
  constexpr std::size_t kMostTogether = 8;  // that share directions: a weight is at most so many times a lane's own
  struct Group {
    std::vector<bool> two_sided;
    int variant;
    bool delta;
    std::vector<Lane> lanes;
  };
  std::vector<Group> groups;
  for (const Lane& lane : lanes) {
    Group one{{}, lane.variant_index, material_table(scene, {lane}).delta, {lane}};
    for (const Material& base : scene.materials) one.two_sided.push_back(material_of(scene, lane, base).two_sided);
    const auto fits = [&](const Group& group) {
      if (one.delta || group.delta || group.two_sided != one.two_sided) return false;
      if (scatter && (group.variant != one.variant || group.lanes.size() == kMostTogether)) return false;
      return group.lanes.size() < most;
    };
    // The last group that fits; the earlier ones are full.
    const auto found = std::find_if(groups.rbegin(), groups.rend(), fits);
    if (found == groups.rend()) {
      groups.push_back(std::move(one));
    } else {
      found->lanes.push_back(lane);
    }
  }
  std::vector<std::vector<Lane>> out;
  for (Group& group : groups) out.push_back(std::move(group.lanes));
  return out;
}

}  // namespace clray
