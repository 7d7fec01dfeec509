// SPDX-License-Identifier: Apache-2.0
// Integer sums of a pass to estimates in SI units (see outcome.hpp; PHYSICS sections 1, 4 and 6).
#include "pipeline/outcome.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "ephemeris/range.hpp"
#include "pipeline/estimate.hpp"
#include "pipeline/sum_reader.hpp"
#include "scene/spectrum.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr double kLightSpeed = 299792458.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Mean and width of delay: ratios of pooled sums, errors by jackknife.
void delay_moments(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, std::size_t c,
                   DelayResult* out) {
  double pooled[3] = {};
  for (int k = 0; k < 3; ++k) {
    for (std::uint32_t r = 0; r < plan.replicates; ++r) pooled[k] += read.total(v, l, c, r, k);
  }
  const double to_s = 1.0 / (plan.constants.inv_path_per_m * kLightSpeed);
  const double middle_s = plan.constants.path_middle_m / kLightSpeed;
  const auto mean_of = [&](const double* s) { return middle_s + s[1] / s[0] * to_s; };
  const auto width_of = [&](const double* s) {
    const double mean = s[1] / s[0];
    return std::sqrt(std::max(0.0, s[2] / s[0] - mean * mean)) * to_s;
  };
  std::vector<double> means, widths;
  for (std::uint32_t r = 0; r < plan.replicates; ++r) {
    double rest[3];
    for (int k = 0; k < 3; ++k) rest[k] = pooled[k] - read.total(v, l, c, r, k);
    means.push_back(mean_of(rest));
    widths.push_back(width_of(rest));
  }
  out->mean_delay_s = estimate_jackknife(mean_of(pooled), means);
  out->rms_width_s = estimate_jackknife(width_of(pooled), widths);
}

void delay_bins(const PassPlan& plan, const SumReader& read, const DelayPlan& delay, std::size_t v, std::uint64_t slot,
                double points, DelayResult* out) {
  const double count = plan.replicates;
  double largest = 0.0;
  for (std::uint32_t r = 0; r < plan.replicates; ++r) largest = std::max(largest, read.largest_weight(delay, slot, r));
  const double share = plan.area_m2[v] / (points * count);
  for (std::uint32_t b = 1; b <= delay.bins; ++b) {
    double sum = 0.0, squares = 0.0;
    std::uint64_t hits = 0;
    std::uint32_t replicates_hit = 0;
    for (std::uint32_t r = 0; r < plan.replicates; ++r) {
      sum += read.bin(delay, v, slot, r, b);
      const std::uint64_t h = read.hits(delay, slot, r, b);
      hits += h;
      replicates_hit += h != 0;
    }
    const double mean = sum / count;
    for (std::uint32_t r = 0; r < plan.replicates; ++r) {
      const double d = read.bin(delay, v, slot, r, b) - mean;
      squares += d * d;
    }
    const bool resolved = hits >= 10 && 2 * replicates_hit >= plan.replicates;
    out->bin_m2_per_sr.push_back(mean);
    out->bin_standard_error.push_back(std::sqrt(squares / (count * (count - 1.0))));
    out->hits.push_back(hits);
    out->resolved.push_back(resolved);
    out->bin_upper_bound.push_back(resolved ? 0.0 : largest * poisson_upper95(hits) * share);
  }
  for (std::uint32_t r = 0; r < plan.replicates; ++r) {
    out->below_m2_per_sr += read.bin(delay, v, slot, r, 0) / count;
    out->above_m2_per_sr += read.bin(delay, v, slot, r, delay.bins + 1) / count;
  }
}

/// Apparent AB magnitude of an irradiance that passed a band: against 3631 Jy through the same band.
double magnitude_of(double W_m2, const Band& band) {
  const double zero = ab_zero_W_m2(band);
  return zero > 0.0 && W_m2 > 0.0 ? -2.5 * el_log(W_m2 / zero) / el_log(10.0) : kNan;
}

class Writer {
 public:
  Writer(const Scene& scene, const PassPlan& plan, const PassOutcome& outcome, Result* out)
      : scene_(scene), plan_(plan), outcome_(outcome), read_(plan, outcome.sums), out_(*out) {
    if (scene.station) ranges_.emplace(*scene.station);
  }

  void write() {
    const std::size_t end = plan_.first_orientation + plan_.orientations.size();
    if (out_.orientations.size() < end) out_.orientations.resize(end);
    std::copy(plan_.orientations.begin(), plan_.orientations.end(),
              out_.orientations.begin() + static_cast<std::ptrdiff_t>(plan_.first_orientation));
    for (std::size_t v = 0; v < plan_.views.size(); ++v) {
      if (plan_.pixels) pictures(v);
      for (std::size_t l = 0; l < plan_.lanes.size() && !plan_.pixels; ++l) {
        if (plan_.pressure) pressure(v, l);
        for (std::size_t c = 0; c < plan_.connections && plan_.connect; ++c) {
          delays(v, l, c);
          spectrometer(v, l, c);
        }
      }
    }
    if (plan_.scatter && !plan_.pixels) energy();
    counters();
  }

 private:
  ResultKey key(int detector, std::size_t v, std::size_t l, std::size_t c) const {
    ResultKey k;
    k.detector =
        scene_.detectors[detector].name.empty() ? scene_.detectors[detector].kind : scene_.detectors[detector].name;
    if (scene_.observers.size() > 1 && !plan_.grid) k.observer = scene_.observers[c].name;
    k.variant = plan_.lanes[l].variant;
    k.band = plan_.lanes[l].band_name;
    k.orientation = plan_.first_orientation + v;
    return k;
  }

  Estimate intensity(std::size_t v, std::size_t l, std::size_t c) const {
    return estimate_mean(per_replicate(plan_, [&](std::uint32_t r) { return read_.total(v, l, c, r, 0); }));
  }

  void delays(std::size_t v, std::size_t l, std::size_t c) {
    for (const DelayPlan& delay : plan_.delays) {
      DelayResult d;
      d.key = key(delay.detector, v, l, c);
      d.intensity_m2_per_sr = intensity(v, l, c);
      if (d.intensity_m2_per_sr.value > 0.0) {
        delay_moments(plan_, read_, v, l, c, &d);
      } else {
        for (Estimate* e : {&d.mean_delay_s, &d.rms_width_s})
          e->value = e->standard_error = e->relative_variance_of_variance = kNan;
      }
      d.first_bin_start_s = delay.first_m[c] / kLightSpeed;
      d.bin_width_s = delay.bin_m[c] / kLightSpeed;
      delay_bins(plan_, read_, delay, v, read_.slot(v, l, c), static_cast<double>(outcome_.sums.points), &d);
      if (d.intensity_m2_per_sr.value > 0.0) {
        Diagnostics& g = out_.diagnostics;
        g.below_window_fraction = std::max(g.below_window_fraction, d.below_m2_per_sr / d.intensity_m2_per_sr.value);
        g.above_window_fraction = std::max(g.above_window_fraction, d.above_m2_per_sr / d.intensity_m2_per_sr.value);
      }
      out_.delay.push_back(std::move(d));
    }
  }

  void spectrometer(std::size_t v, std::size_t l, std::size_t c) {
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (scene_.detectors[d].kind != "spectrometer") continue;
      SpectrometerResult s;
      s.key = key(static_cast<int>(d), v, l, c);
      s.band = plan_.lanes[l].band;
      s.intensity_m2_per_sr = intensity(v, l, c);
      s.source_W_m2 = source_band_W_m2(scene_.source, s.band);
      s.magnitude_AB = s.magnitude_standard_error = kNan;
      const ephemeris::Instant time = ephemeris::instant_of(plan_.orientations[v].time_s);
      const double range = ephemeris::observer_range_m(scene_.observers[c], ranges_ ? &*ranges_ : nullptr, time);
      if (range > 0.0) {
        const double factor = s.source_W_m2 / (range * range);
        s.received_W_m2 = factor * s.intensity_m2_per_sr.value;
        s.received_W_m2_standard_error = factor * s.intensity_m2_per_sr.standard_error;
        s.magnitude_AB = magnitude_of(s.received_W_m2, s.band);
        s.magnitude_standard_error =
            s.received_W_m2 > 0.0 ? 2.5 / el_log(10.0) * s.received_W_m2_standard_error / s.received_W_m2 : kNan;
      }
      const Orientation& o = plan_.orientations[v];
      const vec3 a = v3(o.source.x, o.source.y, o.source.z);
      const vec3 b = v3(o.observers[c].x, o.observers[c].y, o.observers[c].z);
      s.phase_angle_rad = 2.0 * el_atan2(v3_length(v3_sub(a, b)), v3_length(v3_add(a, b)));
      out_.spectrometer.push_back(std::move(s));
    }
  }

  VectorEstimate vector_of(std::size_t v, std::size_t l, std::size_t first, std::size_t last, int k) const {
    VectorEstimate out;
    for (int axis = 0; axis < 3; ++axis) {
      const Estimate e = estimate_mean(per_replicate(plan_, [&](std::uint32_t r) {
        double sum = 0.0;
        for (std::size_t part = first; part < last; ++part) sum += read_.push(v, l, part, r, k + axis);
        return sum;
      }));
      out.value[axis] = e.value;
      out.standard_error[axis] = e.standard_error;
      out.relative_variance_of_variance[axis] = e.relative_variance_of_variance;
    }
    return out;
  }

  void pressure(std::size_t v, std::size_t l) {
    PressureResult p;
    p.key = key(plan_.pressure_detector, v, l, 0);
    p.key.observer.clear();
    p.sun = plan_.orientations[v].source;
    p.coefficient_m2 = vector_of(v, l, 0, plan_.components, 0);
    p.torque_coefficient_m3 = vector_of(v, l, 0, plan_.components, 3);
    for (std::size_t k = 0; k < plan_.components; ++k) {
      p.component_m2.push_back(vector_of(v, l, k, k + 1, 0));
      p.component_m3.push_back(vector_of(v, l, k, k + 1, 3));
    }
    p.absorbed_m2 =
        estimate_mean(per_replicate(plan_, [&](std::uint32_t r) { return read_.book(v, l, r, CLRAY_BOOK_ABSORBED); }));
    out_.pressure.push_back(std::move(p));
  }

  // Per lane, the mean over the views. Another pass may have kept the books of the same light.
  void energy() {
    for (std::size_t l = 0; l < plan_.lanes.size(); ++l) {
      EnergyBooks e;
      if (plan_.grid) e.key.detector = key(plan_.pressure_detector, 0, l, 0).detector;
      e.key.variant = plan_.lanes[l].variant;
      e.key.band = plan_.lanes[l].band_name;
      if (std::any_of(out_.energy.begin(), out_.energy.end(), [&](const EnergyBooks& known) {
            return known.key.detector == e.key.detector && known.key.variant == e.key.variant &&
                   known.key.band == e.key.band;
          }))
        continue;
      Estimate* entries[CLRAY_BOOKS] = {&e.incident_m2, &e.reflected_m2, &e.absorbed_m2,
                                        &e.roulette_m2, &e.truncated_m2, &e.unconnected_specular_m2};
      for (int book = 0; book < CLRAY_BOOKS; ++book) {
        *entries[book] = estimate_mean(per_replicate(plan_, [&](std::uint32_t r) {
          double sum = 0.0;
          for (std::size_t v = 0; v < plan_.views.size(); ++v) sum += read_.book(v, l, r, book);
          return sum / static_cast<double>(plan_.views.size());
        }));
      }
      if (e.incident_m2.value > 0.0) {
        double& fraction = out_.diagnostics.truncated_energy_fraction;
        fraction = std::max(fraction, e.truncated_m2.value / e.incident_m2.value);
      }
      out_.energy.push_back(std::move(e));
    }
  }

  void pictures(std::size_t v) {
    const std::uint64_t pixels = static_cast<std::uint64_t>(plan_.width) * plan_.height;
    for (std::size_t l = 0; l < plan_.lanes.size(); ++l) {
      ResultKey k = key(plan_.pixel_detector, v, l, static_cast<std::size_t>(plan_.pixel_observer));
      k.band.clear();
      ImageResult* image = nullptr;
      for (ImageResult& known : out_.image) {
        if (known.key.detector == k.detector && known.key.observer == k.observer && known.key.variant == k.variant &&
            known.key.orientation == k.orientation)
          image = &known;
      }
      if (image == nullptr) {
        out_.image.emplace_back();
        image = &out_.image.back();
        image->key = k;
        image->width = static_cast<int>(plan_.width);
        image->height = static_cast<int>(plan_.height);
        image->pixel_m = plan_.pixel_m;
        image->right = plan_.right[v];
        image->up = plan_.up[v];
        const double* o = plan_.views[v].toward;
        image->toward = Vec3(o[0], o[1], o[2]);
        const ClrayView& view = plan_.views[v];
        Vec3 centre;
        for (int k = 0; k < 3; ++k)
          centre[k] = view.corner[k] + 0.5 * (view.edge_u[k] + view.edge_v[k]) - scene_.reference_point[k];
        image->centre_right_m = glm::dot(centre, image->right);
        image->centre_up_m = glm::dot(centre, image->up);
        image->coverage.resize(pixels);
        const double samples = static_cast<double>(outcome_.sums.points) * plan_.replicates;
        for (std::uint64_t p = 0; p < pixels; ++p)
          image->coverage[p] = static_cast<float>(static_cast<double>(outcome_.sums.hits[v * pixels + p]) / samples);
      }
      image->bands.push_back(plan_.lanes[l].band);
      image->band_source_W_m2.push_back(source_band_W_m2(scene_.source, plan_.lanes[l].band));
      for (std::uint64_t p = 0; p < pixels; ++p) {
        const double a = read_.pixel(v, l, 0, p), b = read_.pixel(v, l, 1, p);
        image->radiance_per_sr.push_back(0.5 * (a + b));
        image->standard_error_per_sr.push_back(0.5 * std::fabs(a - b));
      }
    }
  }

  void counters() {
    const auto& n = outcome_.sums.counters;
    out_.diagnostics.non_finite += n[CLRAY_COUNT_NON_FINITE];
    out_.diagnostics.stack_overflow += n[CLRAY_COUNT_STACK];
    out_.diagnostics.lost_rays += n[CLRAY_COUNT_LOST];
    out_.diagnostics.accumulator_overflow += n[CLRAY_COUNT_OVERFLOW];
    out_.paths.started += n[CLRAY_COUNT_STARTED];
    out_.paths.escaped += n[CLRAY_COUNT_ESCAPED];
    out_.paths.killed += n[CLRAY_COUNT_KILLED];
    out_.paths.capped += n[CLRAY_COUNT_CAPPED];
  }

  const Scene& scene_;
  const PassPlan& plan_;
  const PassOutcome& outcome_;
  SumReader read_;
  std::optional<ephemeris::RangeModel> ranges_;
  Result& out_;
};

}  // namespace

namespace {

/// Places of names in the scene's own order.
class Places {
 public:
  explicit Places(const Scene& scene) {
    for (const DetectorSpec& d : scene.detectors) detectors_.push_back(d.name.empty() ? d.kind : d.name);
    for (const Observer& o : scene.observers) observers_.push_back(o.name);
    for (const Variant& v : scene.variants) variants_.push_back(v.name);
    for (const Lane& lane : lanes_of(scene)) bands_.push_back(lane.band_name);
  }
  std::array<std::size_t, 5> of(const ResultKey& k, bool by_detector) const {
    const std::size_t detector = place(detectors_, k.detector), observer = place(observers_, k.observer);
    const std::size_t variant = place(variants_, k.variant), band = place(bands_, k.band);
    if (by_detector) return {{detector, observer, k.orientation, variant, band}};
    return {{k.orientation, variant, band, observer, detector}};
  }

 private:
  static std::size_t place(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  std::vector<std::string> detectors_, observers_, variants_, bands_;
};

}  // namespace

void order_results(const Scene& scene, Result* result) {
  const Places places(scene);
  const auto order = [&](auto& records, bool by_detector) {
    std::stable_sort(records.begin(), records.end(), [&](const auto& a, const auto& b) {
      return places.of(a.key, by_detector) < places.of(b.key, by_detector);
    });
  };
  order(result->delay, false);
  order(result->spectrometer, false);
  order(result->pressure, false);
  order(result->energy, true);
  order(result->image, true);
}

void add_results(const Scene& scene, const PassPlan& plan, const PassOutcome& outcome, Result* result) {
  Writer(scene, plan, outcome, result).write();
}

}  // namespace clray
