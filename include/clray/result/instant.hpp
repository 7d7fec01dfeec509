// SPDX-License-Identifier: Apache-2.0
// The instants of a pass: where the body was, how it stood, and what stations and sites saw of it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "clray/export.hpp"
#include "clray/scene.hpp"

CLRAY_API_BEGIN
namespace clray {

/// A place on the Earth at an instant of a pass, as light from the body arrives there (from a station: midway between
/// fire and return).
struct SiteSight {
  int observer = -1;               ///< index into Scene::observers; -1: the station
  double range_m = 0.0;            ///< to the body
  double elevation_rad = 0.0;      ///< of the body over the horizon
  double azimuth_rad = 0.0;        ///< of the body, from north over east
  bool seen = false;               ///< at or above the pass's least elevation
  double sun_elevation_rad = 0.0;  ///< of the Sun at the site
  bool daylight = false;           ///< the Sun's centre is above -0.833 degrees: sunrise to sunset
};

/// An instant of a pass, traced or not.
struct PassInstant {
  Epoch epoch;                   ///< UTC
  double time_s = 0.0;           ///< from the pass's start, SI seconds
  double until_s = 0.0;          ///< it holds until then: the next instant, or where the orbit's file ends
  std::string reason;            ///< why it is not traced; empty where it is
  std::size_t orientation = 0;   ///< index into Result::orientations, if it is traced
  bool placed = false;           ///< whether orbit and attitude are known; else nothing below is
  Vec3 position_m{0.0};          ///< gcrf
  Orientation view;              ///< body_to_space: to gcrf
  Vec3 sun{0.0, 0.0, 1.0};       ///< toward the Sun, body frame
  double sun_share = 1.0;        ///< of the Sun's disk past the Earth
  std::vector<SiteSight> sites;  ///< the observers' sites and the station
  /// Whether it is one of the orientations.
  bool traced() const { return placed && reason.empty(); }
};

}  // namespace clray
CLRAY_API_END
