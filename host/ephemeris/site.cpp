// SPDX-License-Identifier: Apache-2.0
// Geodetic coordinates and the local horizon; see site.hpp.
#include "ephemeris/site.hpp"

#include <erfa.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "clray/constants.hpp"

namespace clray::ephemeris {

Vec3 place_of(const Geodetic& g) {
  double place[3];
  eraGd2gc(1, g.longitude_rad, g.latitude_rad, g.height_m, place);  // 1: WGS 84
  return {place[0], place[1], place[2]};
}

Geodetic geodetic_of(const Vec3& place_m) {
  double place[3] = {place_m.x, place_m.y, place_m.z};
  Geodetic g;
  eraGc2gd(1, place, &g.longitude_rad, &g.latitude_rad, &g.height_m);
  return g;
}

Sight sight_of(const Vec3& place_m, const Vec3& toward) {
  const Geodetic g = geodetic_of(place_m);
  const double sp = std::sin(g.latitude_rad), cp = std::cos(g.latitude_rad);
  const double sl = std::sin(g.longitude_rad), cl = std::cos(g.longitude_rad);
  const Vec3 up(cp * cl, cp * sl, sp), east(-sl, cl, 0.0), north(-sp * cl, -sp * sl, cp);
  const double e = glm::dot(toward, east), n = glm::dot(toward, north);
  const double azimuth = std::atan2(e, n);
  return {std::atan2(glm::dot(toward, up), std::hypot(e, n)), azimuth < 0.0 ? azimuth + 2.0 * constants::kPi : azimuth};
}

}  // namespace clray::ephemeris
