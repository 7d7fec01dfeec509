// SPDX-License-Identifier: Apache-2.0
// check_result(): whether the parts of a result fit each other and the scene. Those of trace() always do. A host
// application may have made or changed a result, and writers rely on the fit. Errors name the member by its path.
#include <fmt/format.h>

#include <cmath>

#include "clray/error.hpp"
#include "clray/result.hpp"
#include "clray/write.hpp"

namespace clray {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::usage, message, where);
}

void check_size(const std::string& where, std::size_t found, std::size_t expected, bool may_be_empty) {
  if (found == expected || (may_be_empty && found == 0)) return;
  fail(where, fmt::format("expected {} of them, found {}", expected, found));
}

void check_positive(const std::string& where, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) fail(where, fmt::format("expected a positive number, found {}", value));
}

void check_orientation(const std::string& where, const ResultKey& key, const Result& result) {
  // Without orientations there is one, the identity.
  const std::size_t count = std::max<std::size_t>(result.orientations.size(), 1);
  if (key.orientation >= count) {
    fail(where + ".key.orientation", fmt::format("expected less than {}, found {}", count, key.orientation));
  }
}

void check_delay(const std::string& where, const DelayResult& d) {
  const std::size_t bins = d.bin_m2_per_sr.size();
  if (bins == 0) fail(where + ".bin_m2_per_sr", "expected at least one bin");
  check_positive(where + ".bin_width_s", d.bin_width_s);
  if (!std::isfinite(d.first_bin_start_s)) fail(where + ".first_bin_start_s", "expected a finite number");
  check_size(where + ".bin_standard_error", d.bin_standard_error.size(), bins, false);
  check_size(where + ".bin_upper_bound", d.bin_upper_bound.size(), bins, false);
  check_size(where + ".hits", d.hits.size(), bins, d.intensity_m2_per_sr.exact());
  check_size(where + ".resolved", d.resolved.size(), bins, false);
  check_size(where + ".photons_per_ns", d.photons_per_ns.size(), bins, true);
}

void check_image(const std::string& where, const ImageResult& image) {
  constexpr int kMost = 1 << 20;  // of libpng's limits; OpenEXR's and cfitsio's are higher
  if (image.width < 1 || image.height < 1 || image.width > kMost || image.height > kMost) {
    fail(where, fmt::format("expected 1 to {} pixels a side, found {} x {}", kMost, image.width, image.height));
  }
  check_positive(where + ".pixel_m", image.pixel_m);
  if (image.bands.empty()) fail(where + ".bands", "expected at least one");
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  check_size(where + ".band_source_W_m2", image.band_source_W_m2.size(), image.bands.size(), false);
  check_size(where + ".coverage", image.coverage.size(), pixels, true);
  check_size(where + ".radiance_per_sr", image.radiance_per_sr.size(), pixels * image.bands.size(), false);
  check_size(where + ".standard_error_per_sr", image.standard_error_per_sr.size(), pixels * image.bands.size(), true);
}

void check_pressure(const std::string& where, const PressureResult& p, const Scene& scene) {
  check_size(where + ".component_m2", p.component_m2.size(), scene.components.size(), true);
  check_size(where + ".component_m3", p.component_m3.size(), p.component_m2.size(), false);
}

}  // namespace

void check_result(const Result& result, const Scene& scene) {
  const auto each = [&](const char* name, const auto& records, const auto& check) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::string where = fmt::format("{}[{}]", name, i);
      check_orientation(where, records[i].key, result);
      check(where, records[i]);
    }
  };
  each("delay", result.delay, check_delay);
  each("spectrometer", result.spectrometer, [](const std::string&, const SpectrometerResult&) {});
  each("pressure", result.pressure,
       [&](const std::string& where, const PressureResult& p) { check_pressure(where, p, scene); });
  each("image", result.image, check_image);
  for (std::size_t i = 0; i < result.instants.size(); ++i) {
    const PassInstant& instant = result.instants[i];
    if (!instant.traced()) continue;
    const std::string where = fmt::format("instants[{}]", i);
    if (instant.orientation >= result.orientations.size()) fail(where + ".orientation", "there is no such orientation");
    check_size(where + ".view.observers", instant.view.observers.size(), scene.observers.size(), false);
  }
  for (std::size_t i = 0; i < result.orientations.size(); ++i) {
    const Orientation& o = result.orientations[i];
    const std::string where = fmt::format("orientations[{}]", i);
    if (!std::isfinite(o.time_s)) fail(where + ".time_s", "expected a finite number");
    check_size(where + ".observers", o.observers.size(), scene.observers.size(), true);
  }
}

}  // namespace clray
