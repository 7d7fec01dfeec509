// SPDX-License-Identifier: Apache-2.0
// Where the Sun and the Earth are, by ERFA (Bretagnon and Francou 2001, to 11 km in 1900-2100). Axes of gcrf.
#pragma once

#include "ephemeris/epoch.hpp"

namespace clray::pass {

inline constexpr double kSunRadius_m = 6.957e8;  // nominal, IAU 2015 resolution B3

/// As light arriving at an epoch shows it.
struct SunSight {
  Vec3 from_earth_m{0.0};        ///< from the Earth's centre at that epoch to the Sun when the light left it
  Vec3 earth_velocity_m_s{0.0};  ///< of the Earth's centre about the barycentre
};

SunSight sun_at(const ephemeris::Epoch& epoch);

}  // namespace clray::pass
