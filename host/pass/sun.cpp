// SPDX-License-Identifier: Apache-2.0
// The Sun by ERFA; see sun.hpp.
#include "pass/sun.hpp"

#include <erfa.h>

#include <glm/geometric.hpp>

#include "clray/constants.hpp"

namespace clray::pass {

namespace {

constexpr double kAu_m = 149597870700.0;
constexpr double kDay_s = 86400.0;

/// Of the Earth: about the Sun, and about the barycentre.
struct EarthMotion {
  Vec3 about_sun_m, place_m, velocity_m_s;
};

EarthMotion earth_at(const ephemeris::Epoch& epoch) {
  const ephemeris::TwoPartDate tt = ephemeris::tt_of(epoch);  // TDB is within 2 ms, in which the Earth moves 60 m
  double helio[2][3], bary[2][3];
  eraEpv00(tt.day, tt.rest, helio, bary);
  const auto vector = [](const double v[3], double scale) { return scale * Vec3(v[0], v[1], v[2]); };
  return {vector(helio[0], kAu_m), vector(bary[0], kAu_m), vector(bary[1], kAu_m / kDay_s)};
}

}  // namespace

SunSight sun_at(const ephemeris::Epoch& epoch) {
  const EarthMotion now = earth_at(epoch);
  Vec3 from_earth = -now.about_sun_m;
  // The Sun moves 13 m/s about the barycentre, so one round is enough: 500 s of light make 7 km, or 0.01 arcsec.
  const EarthMotion then = earth_at(ephemeris::later(epoch, -glm::length(from_earth) / constants::kLightSpeed_m_s));
  from_earth = (then.place_m - then.about_sun_m) - now.place_m;
  return {from_earth, now.velocity_m_s};
}

}  // namespace clray::pass
