// SPDX-License-Identifier: Apache-2.0
// The geometry of an instant; see geometry.hpp.
#include "pass/geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "ephemeris/site.hpp"
#include "pass/shadow.hpp"

namespace clray::pass {

namespace {

constexpr double kSunrise_rad = -0.8333 * constants::kPi / 180.0;  // half a disk and refraction at the horizon
constexpr int kLightRounds = 3;  // each reduces the error of the light time by v/c < 1e-4

}  // namespace

/// What all directions of an instant are made of. gcrf.
struct Geometry::Moment {
  double time_s = 0.0;
  ephemeris::Motion3 body;
  SunSight sun;
  Matrix itrf_of_gcrf{1.0};
  Quaternion body_to_space{1.0, 0.0, 0.0, 0.0};

  /// Into the body frame, as a body of velocity `v` meets light that comes from there (sign 1) or goes there (-1).
  Vec3 in_body(const Vec3& toward, const Vec3& v_m_s, double sign) const {
    const Vec3 met = glm::normalize(toward) + (sign / constants::kLightSpeed_m_s) * v_m_s;
    return snapped(glm::conjugate(body_to_space) * met);
  }
};

Vec3 snapped(const Vec3& direction) {
  constexpr double kGrid = 0x1p36;
  const Vec3 unit = glm::normalize(direction);
  const Vec3 r(std::rint(unit.x * kGrid), std::rint(unit.y * kGrid), std::rint(unit.z * kGrid));
  return r / std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z);
}

Geometry::Geometry(const Scene& scene) : scene_(scene), pass_(*scene.pass), orbit_(pass_), attitude_(pass_) {}

Vec3 Geometry::along_table(const Moment& m, const Directions& table, PassInstant* instant, double* range_m) const {
  const auto& rows = table.rows;
  const auto next = std::upper_bound(rows.begin(), rows.end(), m.time_s,
                                     [](double t, const Directions::Row& row) { return t < row.time_s; });
  if (next == rows.begin() || (next == rows.end() && m.time_s > rows.back().time_s)) {
    instant->reason = "no direction";
    return {0.0, 0.0, 1.0};
  }
  const Directions::Row& low = *(next - 1);
  const Directions::Row& high = next == rows.end() ? low : *next;
  const double share = high.time_s > low.time_s ? (m.time_s - low.time_s) / (high.time_s - low.time_s) : 0.0;
  *range_m = low.range_m > 0.0 && high.range_m > 0.0 ? low.range_m + share * (high.range_m - low.range_m) : 0.0;
  const Vec3 v = low.direction + share * (high.direction - low.direction);
  if (table.in_body) return snapped(v);
  const Vec3 space = table.frame == Frame::itrf ? glm::transpose(m.itrf_of_gcrf) * v : v;
  return snapped(glm::conjugate(m.body_to_space) * space);
}

void Geometry::see_sun(const Moment& m, const Vec3& site_m, SiteSight* sight) const {
  const Vec3 sun = m.itrf_of_gcrf * m.sun.from_earth_m - site_m;
  sight->sun_elevation_rad = ephemeris::sight_of(site_m, sun).elevation_rad;
  sight->daylight = sight->sun_elevation_rad > kSunrise_rad;
  sight->seen = sight->elevation_rad >= pass_.min_elevation_rad;
}

/// From a station that fires before the instant and receives behind it: the mean of both ways is that of one time, to
/// 1e-4 m.
SiteSight Geometry::station_sight(const Moment& m) const {
  const Vec3& site_m = scene_.station->position_m;
  const Vec3 sight = orbit_.earth_fixed(m.time_s) - site_m;
  const ephemeris::Sight s = ephemeris::sight_of(site_m, sight);
  SiteSight seen{-1, glm::length(sight), s.elevation_rad, s.azimuth_rad};
  see_sun(m, site_m, &seen);
  return seen;
}

/// From a site that light of the instant reaches behind it; `toward` leads from the body to where the site then is.
SiteSight Geometry::sight_from(const Moment& m, const Vec3& site_m, Vec3* toward) const {
  Matrix fixed = m.itrf_of_gcrf;
  double flight_s = 0.0;
  for (int round = 0; round < kLightRounds; ++round) {
    *toward = glm::transpose(fixed) * site_m - m.body.value;
    flight_s = glm::length(*toward) / constants::kLightSpeed_m_s;
    fixed = orbit_.frames().itrf_of_gcrf(orbit_.epoch(m.time_s + flight_s));
  }
  *toward = glm::transpose(fixed) * site_m - m.body.value;
  const ephemeris::Sight s = ephemeris::sight_of(site_m, fixed * -*toward);
  SiteSight seen{-1, glm::length(*toward), s.elevation_rad, s.azimuth_rad};
  see_sun(m, site_m, &seen);
  return seen;
}

void Geometry::place_source(const Moment& m, PassInstant* instant) const {
  const Source& source = scene_.source;
  Orientation& view = instant->view;
  const Vec3 speed = pass_.aberration ? m.body.rate : Vec3(0.0);
  const Vec3 sun_speed = pass_.aberration ? m.body.rate + m.sun.earth_velocity_m_s : Vec3(0.0);
  instant->sun = m.in_body(m.sun.from_earth_m - m.body.value, sun_speed, 1.0);
  instant->sun_share = sun_share(m.itrf_of_gcrf * m.body.value, m.itrf_of_gcrf * m.sun.from_earth_m);
  switch (source.toward) {
    case Toward::sun:
      view.source = instant->sun;
      view.light = instant->sun_share;
      break;
    case Toward::station: {
      Matrix fixed = m.itrf_of_gcrf;
      Vec3 toward(0.0);
      for (int round = 0; round < kLightRounds; ++round) {
        toward = glm::transpose(fixed) * scene_.station->position_m - m.body.value;
        const double flight_s = glm::length(toward) / constants::kLightSpeed_m_s;
        fixed = orbit_.frames().itrf_of_gcrf(orbit_.epoch(m.time_s - flight_s));
      }
      view.source = m.in_body(toward, speed, 1.0);
      instant->sites.push_back(station_sight(m));
      view.source_range_m = instant->sites.back().range_m;
      break;
    }
    case Toward::table:
      view.source = along_table(m, source.directions, instant, &view.source_range_m);
      break;
    default:
      view.source = m.in_body(source.direction, Vec3(0.0), 1.0);
  }
}

void Geometry::place_observers(const Moment& m, PassInstant* instant) const {
  Orientation& view = instant->view;
  const Vec3 speed = pass_.aberration ? m.body.rate : Vec3(0.0);
  for (std::size_t i = 0; i < scene_.observers.size(); ++i) {
    const Observer& o = scene_.observers[i];
    Vec3 direction = view.source;
    double range_m = 0.0, elevation_rad = std::numeric_limits<double>::quiet_NaN();
    if (at_source(o, scene_.source)) {
      range_m = view.source_range_m;
      if (scene_.source.toward == Toward::station) elevation_rad = instant->sites.front().elevation_rad;
    } else if (o.toward == Toward::site || o.toward == Toward::station) {
      Vec3 toward(0.0);
      SiteSight sight = sight_from(m, o.toward == Toward::site ? o.site_m : scene_.station->position_m, &toward);
      sight.observer = static_cast<int>(i);
      range_m = sight.range_m;
      elevation_rad = sight.elevation_rad;
      direction = m.in_body(toward, speed, -1.0);
      instant->sites.push_back(sight);
    } else if (o.toward == Toward::table) {
      direction = along_table(m, o.directions, instant, &range_m);
    } else if (o.toward == Toward::sun) {
      direction = instant->sun;
    } else {
      direction = m.in_body(o.direction, Vec3(0.0), 1.0);
    }
    view.observers.push_back(direction);
    view.ranges_m.push_back(range_m > 0.0 ? range_m : o.range_m);
    view.elevations_rad.push_back(elevation_rad);
  }
}

std::string Geometry::reason(const PassInstant& instant) const {
  if (!instant.reason.empty()) return instant.reason;
  if (scene_.source.toward == Toward::sun && instant.sun_share == 0.0) return "in the Earth's shadow";
  bool some = instant.sites.empty();
  for (const SiteSight& sight : instant.sites) {
    if (sight.observer < 0 && !sight.seen) return "below min_elevation_deg";
    some = some || sight.seen;
  }
  return some ? "" : "below min_elevation_deg";
}

PassInstant Geometry::at(double time_s) const {
  PassInstant instant;
  instant.time_s = instant.view.time_s = time_s;
  instant.epoch = orbit_.epoch(time_s);
  if (!orbit_.covers(time_s)) instant.reason = "no ephemeris";
  if (instant.reason.empty() && !attitude_.covers(time_s)) instant.reason = "no attitude";
  if (!instant.reason.empty()) return instant;
  Moment m;
  m.time_s = time_s;
  m.body = orbit_.at(time_s);
  m.sun = sun_at(instant.epoch);
  m.itrf_of_gcrf = orbit_.frames().itrf_of_gcrf(instant.epoch);
  if (const double radius = glm::length(m.body.value); !(radius > 6.35e6)) {
    throw Error(
        ErrorCode::input,
        fmt::format("at {} the body is {:.6g} m from the Earth's centre, inside the Earth; are the lengths those "
                    "of the columns' names?",
                    ephemeris::iso_text(instant.epoch), radius),
        pass_.ephemeris);
  }
  m.body_to_space = attitude_.at(time_s, m.body, m.sun.from_earth_m - m.body.value, orbit_.frames());
  instant.placed = true;
  instant.position_m = m.body.value;
  instant.view.body_to_space = m.body_to_space;
  place_source(m, &instant);
  place_observers(m, &instant);
  instant.reason = reason(instant);
  return instant;
}

}  // namespace clray::pass
