// SPDX-License-Identifier: Apache-2.0
// Sizes of results; see clray/sizes.hpp. Host and device keep a sum of 64 bits and a count of 32 of each replicate
// (more where sums are large), and a result has five numbers a bin. Bytes of files are those of rows as they are
// written, rounded up.
#include "clray/sizes.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scene/motion.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"
#include "text/text.hpp"

namespace clray {
namespace {

constexpr double kReplicateBytes = 12.0 + 12.0;
constexpr double kHalves = 2.0;  // of a picture's samples
constexpr double kResultBytes = 40.0;
constexpr double kTableRow = 110.0;     // of delay.csv, pressure.csv and the like
constexpr double kCurveRow = 600.0;     // of lightcurve.csv and spectrum.csv together
constexpr double kFitsBin = 32.0;       // two to four doubles
constexpr double kManyViews = 100.0;    // beyond, A(t) is in the FITS file alone
constexpr double kPhotonBytes = 100.0;  // a row of observations.csv and one of the CRD file

double value_of(const DetectorSpec& d, const TableRow& row, const char* key) {
  const auto given = d.parameters.find(key);
  if (given != d.parameters.end()) return given->second;
  const TableKey* known = find_key(row, key);
  return known != nullptr ? known->default_value : 0.0;
}

/// Bins of a delay histogram; of an automatic window with `bin_ps` the plan knows better.
double bins_of(const DetectorSpec& d, const TableRow& row) {
  const double start = value_of(d, row, "start_ns"), stop = value_of(d, row, "stop_ns");
  const double bin_ps = value_of(d, row, "bin_ps");
  if (bin_ps > 0.0 && stop > start) return std::ceil((stop - start) * 1e3 / bin_ps);
  return value_of(d, row, "bins");
}

/// At most so many instants of a pass are traced; of steps by angle, as far as a spin tells, or a few turns.
double instants_of(const Pass& pass) {
  if (!pass.times_s.empty()) return static_cast<double>(pass.times_s.size());
  if (pass.step_s > 0.0) return std::floor(pass.stop_s / pass.step_s) + 1.0;
  const bool spins = pass.attitude.law == PassAttitude::Law::spin && pass.attitude.spin_period_s > 0.0;
  const double turns = spins ? pass.stop_s / pass.attitude.spin_period_s : 2.0;
  return std::floor(turns * 2.0 * CLRAY_PI / pass.step_rad) + 1.0;
}

/// What makes the most of a scene's memory, with its keys: "3601 orientations (motion.step_deg) of 1e7 bins".
struct Largest {
  double memory = 0.0;
  std::string what;

  void note(double bytes, const std::string& text) {
    if (bytes > memory) *this = {bytes, text};
  }
};

const char* step_key(const Scene& scene) {
  if (!scene.views.empty()) return "views";
  if (scene.motion) return scene.motion->attitudes.empty() ? "motion.step_deg" : "motion.attitudes";
  if (!scene.pass->times_s.empty()) return "pass.times";
  return scene.pass->step_s > 0.0 ? "pass.step_s" : "pass.step_deg";
}

std::string bytes_text(double bytes) {
  const char* const units[] = {"kB", "MB", "GB", "TB", "PB", "EB"};
  std::size_t unit = 0;
  double value = bytes / 1e3;
  for (; value >= 1000.0 && unit + 1 < std::size(units); ++unit) value /= 1e3;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

}  // namespace

namespace {

SceneSizes sizes_of(const Scene& scene, Largest* largest) {
  SceneSizes sizes;
  const double views = !scene.views.empty() ? static_cast<double>(scene.views.size())
                       : scene.motion       ? static_cast<double>(orientation_count(*scene.motion))
                       : scene.pass         ? instants_of(*scene.pass)
                                            : 1.0;
  const double observers = static_cast<double>(std::max<std::size_t>(scene.observers.size(), 1));
  const double variants = static_cast<double>(std::max<std::size_t>(scene.variants.size(), 1));
  const double replicates = static_cast<double>(scene.trace.replicates);
  for (const DetectorSpec& d : scene.detectors) {
    const TableRow& row = table_row("detector", d.kind);
    const double bands = static_cast<double>(bands_of(scene, row).size());
    const double records =
        variants * bands * (row.pixel || d.kind == "delay" || d.kind == "spectrometer" ? observers : 1.0);
    double numbers = 1.0, directions = views, file_bytes = kTableRow;
    const char* name = "";
    if (d.kind == "delay") {
      numbers = bins_of(d, row);
      name = value_of(d, row, "bin_ps") > 0.0 ? " bins (bin_ps)" : " bins (bins)";
      file_bytes = views > kManyViews ? kFitsBin : kTableRow + (views > 1.0 ? kFitsBin : 0.0);
    } else if (d.kind == "spectrometer" && views > 1.0) {
      file_bytes = kCurveRow;
    } else if (row.pixel) {
      numbers = value_of(d, row, "width") * value_of(d, row, "height");
      name = " pixels (width, height)";
      file_bytes = d.kind == "rgb" ? 12.0 : 16.0;
    } else if (value_of(d, row, "azimuth_steps") > 0.0) {
      directions = value_of(d, row, "azimuth_steps") * value_of(d, row, "elevation_steps");
      numbers = 6.0 * static_cast<double>(scene.components.size());
      name = " numbers (azimuth_steps, elevation_steps)";
    }
    const double memory =
        directions * records * numbers * ((row.pixel ? kHalves : replicates) * kReplicateBytes + kResultBytes);
    sizes.memory += memory;
    if (largest != nullptr) {
      const std::string each = *name == '\0' ? "" : fmt::format(" of {:.6g}{}", numbers, name);
      const std::string when =
          views > 1.0 ? fmt::format(", {:.6g} orientations ({})", views, step_key(scene)) : std::string();
      largest->note(memory, fmt::format("detector {}: {}{}{}", shown_name(d),
                                        text::counted(static_cast<std::uint64_t>(records), "record"), each, when));
    }
    sizes.disk += directions * records * numbers * file_bytes;
  }
  const double shooting_s = scene.motion ? scene.motion->stop_s - scene.motion->start_s
                            : scene.pass ? scene.pass->stop_s
                                         : 0.0;
  if (scene.station) sizes.disk += kPhotonBytes * variants * std::max(0.0, shooting_s) * scene.station->rate_Hz;
  return sizes;
}

double machine_memory() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
}

}  // namespace

SceneSizes scene_sizes(const Scene& scene) {
  return sizes_of(scene, nullptr);
}

std::string size_text(const Scene& scene) {
  const SceneSizes sizes = scene_sizes(scene);
  return fmt::format("about {} of memory and {} on disk", bytes_text(sizes.memory), bytes_text(sizes.disk));
}

std::string memory_fault(double bytes) {
  const double memory = machine_memory();
  if (!(memory > 0.0 && bytes > memory)) return "";
  return fmt::format("the results need about {} of memory, and this machine has {}", bytes_text(bytes),
                     bytes_text(memory));
}

std::string size_fault(const Scene& scene, const std::string& folder) {
  Largest largest;
  const SceneSizes sizes = sizes_of(scene, &largest);
  if (const std::string fault = memory_fault(sizes.memory); !fault.empty())
    return fault + "; most of it is for " + largest.what;
  if (folder.empty()) return "";
  std::error_code error;
  std::filesystem::path place = std::filesystem::absolute(folder, error);
  while (!place.empty() && place.has_parent_path() && place != place.parent_path() &&
         !std::filesystem::exists(place, error))
    place = place.parent_path();
  const auto space = std::filesystem::space(place, error);
  if (error || sizes.disk <= static_cast<double>(space.available)) return "";
  return fmt::format("the result needs about {} of disk, and {} has {} free", bytes_text(sizes.disk),
                     text::shown(place.string()), bytes_text(static_cast<double>(space.available)));
}

}  // namespace clray
