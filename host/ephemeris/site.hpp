// SPDX-License-Identifier: Apache-2.0
// Places on the Earth: geodetic coordinates of the WGS 84 ellipsoid (ERFA), the local horizon, and where a line of
// sight points there. Earth-fixed metres, radians; no refraction.
#pragma once

#include "clray/scene.hpp"

namespace clray::ephemeris {

/// WGS 84.
inline constexpr double kEarthRadius_m = 6378137.0, kEarthFlattening = 1.0 / 298.257223563;

struct Geodetic {
  double latitude_rad = 0.0, longitude_rad = 0.0, height_m = 0.0;
};

Vec3 place_of(const Geodetic& geodetic);
Geodetic geodetic_of(const Vec3& place_m);

/// Where something is in the sky.
struct Sight {
  double elevation_rad = 0.0;  ///< above the plane across the ellipsoid's normal
  double azimuth_rad = 0.0;    ///< from north over east, in [0, 2 pi)
};

/// Along an Earth-fixed vector away from the place.
Sight sight_of(const Vec3& place_m, const Vec3& toward);

}  // namespace clray::ephemeris
