// SPDX-License-Identifier: Apache-2.0
// See illumination.hpp.
#include "beam/illumination.hpp"

#include <cmath>
#include <optional>

#include "clray/error.hpp"
#include "ephemeris/range.hpp"
#include "pass/instants.hpp"
#include "scene/motion.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

double sine_of_degrees(double degrees) {
  if (degrees == 0.0 || std::fabs(degrees) == 180.0) return 0.0;
  if (std::fabs(degrees) == 90.0) return degrees > 0.0 ? 1.0 : -1.0;
  double s, c;
  el_sincos(degrees * (CLRAY_PI / 180.0), &s, &c);
  return s;
}

/// The range of an observer at a time, or 0 where table or prediction do not say.
double range_or_0(const Observer& observer, const ephemeris::RangeModel* ranges, double time_s) {
  try {
    return ephemeris::observer_range_m(observer, ranges, ephemeris::instant_of(time_s));
  } catch (const Error&) {
    return 0.0;
  }
}

}  // namespace

std::vector<Orientation> views_of_motion(const Scene& scene) {
  if (scene.pass) return pass::views(scene);
  std::vector<Orientation> views = orientations(scene);
  std::optional<ephemeris::RangeModel> ranges;
  if (scene.station) ranges.emplace(*scene.station);
  for (Orientation& view : views) {
    if (ranges && view.source_range_m == 0.0) view.source_range_m = range_or_0(Observer{}, &*ranges, view.time_s);
    if (!view.ranges_m.empty()) continue;
    for (const Observer& observer : scene.observers)
      view.ranges_m.push_back(range_or_0(observer, ranges ? &*ranges : nullptr, view.time_s));
  }
  return views;
}

std::vector<Orientation> views_of_grid(const Scene& scene, int azimuths, int elevations) {
  const Orientation start = views_of_motion(scene).front();
  std::vector<Orientation> views;
  for (int e = 0; e < elevations; ++e) {
    const double elevation = -90.0 + 180.0 * e / (elevations - 1);
    const bool pole = e == 0 || e == elevations - 1;
    for (int a = 0; a < (pole ? 1 : azimuths); ++a) {
      Orientation view = start;
      view.light = 1.0;
      view.source = direction_from_degrees(360.0 * a / azimuths, elevation);
      for (std::size_t o = 0; o < scene.observers.size(); ++o) {
        if (at_source(scene.observers[o], scene.source)) view.observers[o] = view.source;
      }
      views.push_back(view);
    }
  }
  return views;
}

Vec3 direction_from_degrees(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg > 180.0 ? azimuth_deg - 360.0 : azimuth_deg;
  const auto cosine = [](double degrees) { return sine_of_degrees(90.0 - std::fabs(degrees)); };
  const double c = cosine(elevation_deg);
  return {c * cosine(azimuth), c * sine_of_degrees(azimuth), sine_of_degrees(elevation_deg)};
}

}  // namespace clray
