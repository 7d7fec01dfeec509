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

/// Apparent AB magnitude of an irradiance that passed a band: against 3631 Jy through the same band.
double magnitude_of(double W_m2, const Band& band) {
  const double zero = ab_zero_W_m2(band);
  return zero > 0.0 && W_m2 > 0.0 ? -2.5 * el_log(W_m2 / zero) / el_log(10.0) : kNan;
}

void spectrometer_record(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c) {
  const auto observer = static_cast<std::size_t>(x.plan.request.observers[c]);
  const Orientation& instant = x.plan.request.orientations[v];
  SpectrometerResult s;
  s.key = x.key(v, l, c);
  s.band = x.band(l);
  s.intensity_m2_per_sr = intensity_estimate(x.plan, x.read, v, l, c);
  s.source_W_m2 = source_band_W_m2(x.scene.source, s.band) * instant.light;
  s.magnitude_AB = s.magnitude_standard_error = kNan;
  if (const double range = instant.ranges_m[observer]; range > 0.0) {
    const double factor = s.source_W_m2 / (range * range);
    s.received_W_m2 = factor * s.intensity_m2_per_sr.value;
    s.received_W_m2_standard_error = factor * s.intensity_m2_per_sr.standard_error;
    s.magnitude_AB = magnitude_of(s.received_W_m2, s.band);
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
  for (std::size_t v = 0; v < shape.views; ++v) {
    for (std::size_t l = 0; l < shape.lanes; ++l) {
      for (std::size_t c = 0; c < shape.connections; ++c) spectrometer_record(x, v, l, c);
    }
  }
}

}  // namespace

const DetectorRoom kSpectrometerRoom{"spectrometer", nullptr, nullptr, nullptr, spectrometer_results};

}  // namespace clray
