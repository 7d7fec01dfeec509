// SPDX-License-Identifier: Apache-2.0
// See records.hpp.
#include "laws/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "clray/session.hpp"
#include "scene/spectrum.hpp"

namespace clray_test {

using clray::Estimate;
using clray::Result;
using clray::ResultKey;
using clray::Scene;
using clray::VectorEstimate;

namespace {

/// 2(n − 2)/(n(n + 1)): what Estimate::relative_variance_of_variance is on average for normal replicates.
double normal_doubt(const Result& result) {
  const double n = result.replicates;
  return 2.0 * (n - 2.0) / (n * (n + 1.0));
}

class Flattener {
 public:
  Flattener(const Result& result, const Scene& scene, const Names& names)
      : result_(result), scene_(scene), names_(names) {
    const double extent = result.extent_m;
    area_ = extent * extent;
    volume_ = area_ * extent;
    seconds_ = extent / 299792458.0;
  }

  Records flatten() {
    for (const auto& d : result_.delay) delay(d);
    for (const auto& s : result_.spectrometer) spectrometer(s);
    for (const auto& p : result_.pressure) pressure(p);
    for (const auto& i : result_.image) image(i);
    for (const auto& b : result_.energy) books(b);
    return std::move(records_);
  }

 private:
  /// "detector/observer/variant/band/orientation/".
  std::string stem(const ResultKey& key, bool observed) const {
    std::string observer = observed ? key.observer : "-";
    if (observed && observer.empty()) observer = scene_.observers.size() == 1 ? scene_.observers[0].name : "?";
    if (observed && !names_.observer.empty()) observer = names_.observer;
    std::string variant = key.variant, band = key.band;
    if (!names_.variant.empty()) variant = names_.variant;
    if (band.empty()) band = clray::bands_of(scene_).front().name;
    if (!names_.band.empty()) band = names_.band;
    return fmt::format("{}/{}/{}/{}/", key.detector, observer, variant, band);
  }

  std::string orientation(const ResultKey& key) const {
    if (!names_.orientation.empty()) return names_.orientation + "/";
    bool grid = false;
    for (const auto& d : scene_.detectors) grid = grid || (d.name == key.detector && is_grid(d));
    return orientation_name(result_, key.orientation, grid) + "/";
  }

  void add(const std::string& name, const std::string& kind, double value, double error, double scale,
           double variance_of_variance = 0.0, bool resolved = true) {
    const double doubt = std::isfinite(variance_of_variance) ? variance_of_variance / normal_doubt(result_) : 0.0;
    records_[name] = {value, error, scale, doubt, resolved, kind, 0.0, 0.0};
  }
  void add(const std::string& name, const std::string& kind, const Estimate& e, double scale, bool resolved = true) {
    add(name, kind, e.value, e.standard_error, scale, e.relative_variance_of_variance, resolved);
  }
  void add(const std::string& name, const std::string& kind, const VectorEstimate& v, double scale) {
    for (int k = 0; k < 3; ++k)
      add(fmt::format("{}.{}", name, "xyz"[k]), kind, v.value[k], v.standard_error[k], scale,
          v.relative_variance_of_variance[k]);
  }

  void delay(const clray::DelayResult& d) {
    const std::string at = stem(d.key, true) + orientation(d.key);
    add(at + "intensity", "total", d.intensity_m2_per_sr, area_);
    // Ratios of sums: normal, and their jackknife honest, only where the total is well known.
    const bool sharp = d.intensity_m2_per_sr.standard_error < 0.05 * d.intensity_m2_per_sr.value;
    add(at + "mean delay", "moment", d.mean_delay_s, seconds_, sharp);
    add(at + "rms width", "moment", d.rms_width_s, seconds_, sharp && d.rms_width_s.value > 1e-4 * seconds_);
    const double width = d.bin_width_s * static_cast<double>(d.bin_m2_per_sr.size());
    add(at + "window start", "window", d.first_bin_start_s, 0.0, width);
    add(at + "window width", "window", width, 0.0, width);
    for (std::size_t b = 0; b < d.bin_m2_per_sr.size(); ++b) {
      // A bin has no relative variance of the variance; 100 hits make its spread nearly normal. An exact one has none.
      const std::string name = fmt::format("{}bin {}", at, b);
      const double low = d.first_bin_start_s + static_cast<double>(b) * d.bin_width_s, high = low + d.bin_width_s;
      add(name, "bin", d.bin_m2_per_sr[b], d.bin_standard_error[b], area_, 0.0, d.hits.empty() || d.hits[b] >= 100);
      records_[name].low = low;
      records_[name].high = high;
    }
    photons(at, d, sharp);
  }

  /// Photons of a pulse that are expected in the window, at the range of the record's time and observer. They are the
  /// total times a number where the window holds all of it.
  void photons(const std::string& at, const clray::DelayResult& d, bool sharp) {
    double sum = 0.0, binned = 0.0;
    for (const double rate : d.photons_per_ns) sum += rate * d.bin_width_s * 1e9;
    for (const double bin : d.bin_m2_per_sr) binned += bin;
    const Estimate& total = d.intensity_m2_per_sr;
    if (!(sum > 0.0 && total.value > 0.0)) return;
    const double factor = sum / total.value;
    add(at + "photons", "power", sum, factor * total.standard_error, area_ * factor,
        total.relative_variance_of_variance, sharp && binned >= (1.0 - 1e-9) * total.value);
  }

  void spectrometer(const clray::SpectrometerResult& s) {
    const std::string at = stem(s.key, true) + orientation(s.key);
    const double doubt = s.intensity_m2_per_sr.relative_variance_of_variance;
    add(at + "intensity", "total", s.intensity_m2_per_sr, area_);
    const double factor = s.intensity_m2_per_sr.value > 0.0 ? s.received_W_m2 / s.intensity_m2_per_sr.value : 0.0;
    add(at + "received", "power", s.received_W_m2, s.received_W_m2_standard_error, area_ * factor, doubt);
    const bool sharp = s.magnitude_standard_error < 0.05;
    add(at + "magnitude", "power", s.magnitude_AB, s.magnitude_standard_error, 1.0, doubt, sharp);
    add(at + "source power", "exact", s.source_W_m2, 0.0, s.source_W_m2);
    add(at + "phase angle", "exact", s.phase_angle_rad, 0.0, 1.0);
  }

  void pressure(const clray::PressureResult& p) {
    const std::string at = stem(p.key, false) + orientation(p.key);
    add(at + "force", "force", p.coefficient_m2, area_);
    add(at + "torque", "torque", p.torque_coefficient_m3, volume_);
    add(at + "absorbed", "total", p.absorbed_m2, area_);
    for (std::size_t c = 0; c < p.component_m2.size(); ++c) {
      add(at + "force on " + scene_.components[c].name, "force", p.component_m2[c], area_);
      add(at + "torque on " + scene_.components[c].name, "torque", p.component_m3[c], volume_);
    }
  }

  /// Sums over all pixels: their errors are independent, and many half-differences of one degree of freedom each make
  /// a sum that is nearly normal. Bands of a picture are records of their own.
  void image(const clray::ImageResult& i) {
    const double pixel = i.pixel_m * i.pixel_m;
    double covered = 0.0;
    for (const float share : i.coverage) covered += static_cast<double>(share) * pixel;
    for (std::size_t b = 0; b < i.bands.size(); ++b) {
      ResultKey key = i.key;
      key.band = i.bands[b].name;
      const std::string at = stem(key, true) + orientation(key);
      double sum = 0.0, squares = 0.0, largest = 0.0;
      for (std::size_t p = b * i.coverage.size(); p < (b + 1) * i.coverage.size(); ++p) {
        const double error = i.standard_error_per_sr[p] * pixel;
        sum += i.radiance_per_sr[p] * pixel;
        squares += error * error;
        largest = std::max(largest, error * error);
      }
      // Few pixels that make all of the error leave it with few degrees of freedom.
      add(at + "intensity", "picture", sum, std::sqrt(squares), area_, 0.0, largest <= 0.1 * squares);
      // Two samples a pixel at least, and none can be off by more than half of it.
      add(at + "covered", "cover", covered, 0.36 * pixel * std::sqrt(static_cast<double>(i.coverage.size())), area_);
    }
  }

  /// Means over all orientations, or over a grid's.
  void books(const clray::EnergyBooks& e) {
    ResultKey key = e.key;
    key.detector = key.detector.empty() ? "books" : "books of " + key.detector;
    const std::string at = stem(key, false) + "all/";
    add(at + "incident", "book", e.incident_m2, area_);
    add(at + "reflected", "book", e.reflected_m2, area_);
    add(at + "absorbed", "book", e.absorbed_m2, area_);
    add(at + "roulette", "book", e.roulette_m2, area_);
    add(at + "truncated", "book", e.truncated_m2, area_);
    add(at + "unconnected", "book", e.unconnected_specular_m2, area_);
    // What came in, and what roulette made, must be somewhere (docs/physics.md, section 4). The books of a run are
    // correlated: the sum of their errors bounds that of the balance.
    const double balance =
        e.incident_m2.value + e.roulette_m2.value - e.reflected_m2.value - e.absorbed_m2.value - e.truncated_m2.value;
    double error = 0.0, doubt = 0.0;
    for (const Estimate* book : {&e.incident_m2, &e.roulette_m2, &e.reflected_m2, &e.absorbed_m2, &e.truncated_m2}) {
      error += book->standard_error;
      if (book->relative_variance_of_variance > doubt) doubt = book->relative_variance_of_variance;
    }
    add(at + "balance", "balance", balance, error, area_, doubt);
  }

  const Result& result_;
  const Scene& scene_;
  const Names& names_;
  double area_, volume_, seconds_;
  Records records_;
};

}  // namespace

Records records_of(const Result& result, const Scene& scene, const Names& names) {
  Result with_photons = result;
  clray::expect_photons(scene, &with_photons);
  return Flattener(with_photons, scene, names).flatten();
}

std::string orientation_name(const Result& result, std::size_t orientation, bool grid) {
  const clray::Orientation& o = result.orientations.at(orientation);
  if (grid) return fmt::format("sun {:.6f} {:.6f} {:.6f}", o.source.x + 0.0, o.source.y + 0.0, o.source.z + 0.0);
  return fmt::format("{:g} s", o.time_s);
}

bool is_grid(const clray::DetectorSpec& detector) {
  const auto steps = detector.parameters.find("azimuth_steps");
  return steps != detector.parameters.end() && steps->second > 0.0;
}

std::string warning_kind(const std::string& warning) {
  std::string kind;
  int depth = 0;
  for (const char c : warning) {
    depth += c == '(' ? 1 : 0;
    depth -= c == ')' ? 1 : 0;
    if (depth > 0) continue;
    if (std::isdigit(static_cast<unsigned char>(c)) == 0)
      kind += c;
    else if (kind.empty() || kind.back() != '#')
      kind += '#';
  }
  return kind;
}

}  // namespace clray_test
