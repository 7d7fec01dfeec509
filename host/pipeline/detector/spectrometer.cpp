// SPDX-License-Identifier: Apache-2.0
// The one-pixel spectrometer on the host: A of each band, what is received at the observer's range, and its magnitude.
#include <cmath>
#include <limits>

#include "pipeline/detector/intensity.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"
#include "scene/spectrum.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double magnitude_of(double ratio) {
  return ratio > 0.0 ? -2.5 * el_log(ratio) / el_log(10.0) : kNan;
}

/// Air mass at a true elevation, to 0.004 down to the horizon (Young 1994, table 1); NaN below it.
double air_mass_at(double elevation_rad) {
  if (!(elevation_rad >= 0.0)) return kNan;
  double c, cosine;
  el_sincos(elevation_rad, &c, &cosine);
  return ((1.002432 * c + 0.148386) * c + 0.0096467) / (((c + 0.149864) * c + 0.0102963) * c + 0.000303978);
}

/// What a lane's band makes of every view: integrals over its light and response.
struct BandLight {
  Band band;
  double source_W_m2, ab_zero, vega_zero;
};

BandLight band_light(const RoomResults& x, std::size_t lane) {
  const Band band = x.band(lane);
  return {band, source_band_W_m2(x.scene.source, band), ab_zero_W_m2(band), vega_zero_W_m2(band)};
}

/// What the atmosphere takes on the way to an observer: 1 where the scene states no extinction.
double transmission(const Observer& observer, const Band& band, SpectrometerResult* s) {
  if (observer.extinction_mag.empty()) return 1.0;
  const auto own = observer.extinction_mag.find(band.name), every = observer.extinction_mag.find("");
  s->extinction_mag = (own != observer.extinction_mag.end() ? own : every)->second * s->air_mass;
  return s->air_mass > 0.0 ? el_exp(-0.4 * el_log(10.0) * s->extinction_mag) : 0.0;
}

void spectrometer_record(const RoomResults& x, const BandLight& light, std::size_t v, std::size_t l, std::size_t c) {
  const auto observer = static_cast<std::size_t>(x.plan.request.observers[c]);
  const Orientation& instant = x.plan.request.orientations[v];
  SpectrometerResult s;
  s.key = x.key(v, l, c);
  s.band = light.band;
  s.intensity_m2_per_sr = intensity_estimate(x.plan, x.read, v, l, c);
  s.source_W_m2 = light.source_W_m2 * instant.light;
  s.magnitude_AB = s.magnitude_Vega = s.magnitude_standard_error = kNan;
  s.air_mass = observer < instant.elevations_rad.size() ? air_mass_at(instant.elevations_rad[observer]) : kNan;
  const double passed = transmission(x.scene.observers[observer], s.band, &s);
  if (const double range = instant.ranges_m[observer]; range > 0.0) {
    const double factor = s.source_W_m2 / (range * range) * passed;
    s.received_W_m2 = factor * s.intensity_m2_per_sr.value;
    s.received_W_m2_standard_error = factor * s.intensity_m2_per_sr.standard_error;
    if (light.ab_zero > 0.0) s.magnitude_AB = magnitude_of(s.received_W_m2 / light.ab_zero);
    if (light.vega_zero > 0.0) s.magnitude_Vega = magnitude_of(s.received_W_m2 / light.vega_zero);
    s.magnitude_standard_error =
        s.received_W_m2 > 0.0 ? 2.5 / el_log(10.0) * s.received_W_m2_standard_error / s.received_W_m2 : kNan;
  }
  const Vec3& o = instant.observers[observer];
  const vec3 a = v3(instant.source.x, instant.source.y, instant.source.z), b = v3(o.x, o.y, o.z);
  s.phase_angle_rad = 2.0 * el_atan2(v3_length(v3_sub(a, b)), v3_length(v3_add(a, b)));
  x.note(s.key, s.intensity_m2_per_sr.value != 0.0);
  x.out.spectrometer.push_back(std::move(s));
}

void spectrometer_results(const RoomResults& x) {
  const SumShape& shape = x.plan.layout.shape;
  std::vector<BandLight> lights;
  for (std::size_t l = 0; l < shape.lanes; ++l) lights.push_back(band_light(x, l));
  for (std::size_t v = 0; v < shape.views; ++v) {
    for (std::size_t l = 0; l < shape.lanes; ++l) {
      for (std::size_t c = 0; c < shape.connections; ++c) spectrometer_record(x, lights[l], v, l, c);
    }
  }
}

}  // namespace

const DetectorRoom kSpectrometerRoom{"spectrometer", nullptr, nullptr, nullptr, spectrometer_results};

}  // namespace clray
