// SPDX-License-Identifier: Apache-2.0
// What the command line shows a person; see report.hpp. Text is UTF-8.
#include "report.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "clray/constants.hpp"
#include "text/columns.hpp"

namespace clray::cli {

namespace {

using text::characters;
using text::Columns;

std::string with_unit(const std::string& number, const char* unit) {
  return number == "n/a" ? number : number + " " + unit;
}

std::string amount(const Estimate& e, double scale, const char* unit) {
  return with_unit(format_with_error(e.value * scale, e.standard_error * scale), unit);
}

std::string percent_error(const Estimate& e) {
  if (!(e.value != 0.0) || !std::isfinite(e.value)) return "n/a";
  return fmt::format("{:.2g} %", 100.0 * 0.5 * (e.high - e.low) / std::fabs(e.value));
}

}  // namespace

std::string short_count(double value) {
  if (value >= 1e9) return fmt::format("{:.3g} G", value * 1e-9);
  if (value >= 1e6) return fmt::format("{:.3g} M", value * 1e-6);
  if (value >= 1e4) return fmt::format("{:.3g} k", value * 1e-3);
  return fmt::format("{:.0f}", value);
}

std::string short_time(double seconds) {
  if (!std::isfinite(seconds)) return "?";
  if (seconds < 0.0995) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 99.5) return fmt::format("{:.{}f} s", seconds, seconds < 9.95 ? 2 : 1);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

ProgressBar::ProgressBar(bool wanted) : wanted_(wanted && ::isatty(STDERR_FILENO) == 1) {}

void ProgressBar::show(const Progress& progress) {
  const auto now = std::chrono::steady_clock::now();
  if (!wanted_ || (shown_ && now - last_ < std::chrono::milliseconds(100))) return;
  last_ = now;
  const double fraction = std::clamp(std::isfinite(progress.fraction) ? progress.fraction : 0.0, 0.0, 1.0);
  constexpr int kWidth = 24;
  const int full = static_cast<int>(fraction * kWidth + 0.5);
  std::string bar;
  for (int i = 0; i < kWidth; ++i) bar += i < full ? "█" : "·";
  const std::string error =
      std::isfinite(progress.relative_error) ? fmt::format("±{:.2g} %", 100.0 * progress.relative_error) : "± ?";
  std::string line = fmt::format("{:<8} {} {:3.0f} %  {} rays  {} rays/s  {}  {} left", progress.phase, bar,
                                 100.0 * fraction, short_count(static_cast<double>(progress.rays)),
                                 short_count(progress.rays_per_s), error, short_time(progress.seconds_left));
  winsize window{};
  const std::size_t width = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0 ? window.ws_col : 80;
  // A wrapped line cannot be overwritten, so it is cut, between characters.
  while (characters(line) >= width) {
    while ((line.back() & 0xc0) == 0x80) line.pop_back();
    line.pop_back();
  }
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
  std::fflush(stderr);
  shown_ = true;
}

void ProgressBar::clear() {
  if (!shown_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  shown_ = false;
}

std::string device_line(const DeviceInfo& device) {
  return fmt::format("{} ({}, {})", device.name, device.type, device.platform);
}

std::string device_table(const std::vector<DeviceInfo>& devices) {
  Columns columns;
  columns.add({"index", "type", "name", "platform", "driver", "units", "memory", "usable"});
  for (const auto& d : devices) {
    columns.add({std::to_string(d.index), d.type, d.name, d.platform, d.driver, std::to_string(d.compute_units),
                 fmt::format("{:.1f} GiB", d.memory_GiB), d.fp64 ? "yes" : "no: lacks fp64"});
  }
  return columns.text("");
}

std::string explanation(const Result& result) {
  std::string text = "Kept, because the scene needs it:\n";
  for (const auto& line : result.kept) text += "  + " + line + "\n";
  if (result.kept.empty()) text += "  (nothing)\n";
  text += "Left out:\n";
  for (const auto& line : result.left_out) text += "  - " + line + "\n";
  if (result.left_out.empty()) text += "  (nothing)\n";
  return text;
}

namespace {

std::string member(const ResultKey& key, std::size_t orientations) {
  std::string name = key.detector;
  for (const auto& part : {key.observer, key.variant, key.band}) {
    if (!part.empty()) name += ", " + part;
  }
  if (orientations > 1) name += ", #" + std::to_string(key.orientation);
  return name;
}

/// A table of more rows would not fit a screen; the files have all of them.
constexpr std::size_t kMostRows = 12;

std::string more_rows(std::size_t count) {
  return count > kMostRows ? fmt::format("  … and {} more in the files\n", count - kMostRows) : "";
}

void one_pulse(Columns& table, const DelayResult& delay) {
  const auto& a = delay.intensity_m2_per_sr;
  table.add({"A", amount(a, 1.0, "m²/sr") + "   (95 %: ±" + percent_error(a) + ")"});
  table.add({"cross-section", amount(a, 4.0 * constants::kPi, "m²")});
  table.add({"mean delay", amount(delay.mean_delay_s, 1e9, "ns")});
  table.add({"rms width", amount(delay.rms_width_s, 1e9, "ns")});
}

std::string many_pulses(const Result& result) {
  Columns table;
  table.add({"delay", "A (m²/sr)", "cross-section (m²)", "mean delay (ns)", "rms width (ns)"});
  const auto number = [](const Estimate& e, double scale) {
    return format_with_error(e.value * scale, e.standard_error * scale);
  };
  for (std::size_t i = 0; i < std::min(result.delay.size(), kMostRows); ++i) {
    const auto& delay = result.delay[i];
    table.add({member(delay.key, result.orientations.size()), number(delay.intensity_m2_per_sr, 1.0),
               number(delay.intensity_m2_per_sr, 4.0 * constants::kPi), number(delay.mean_delay_s, 1e9),
               number(delay.rms_width_s, 1e9)});
  }
  return "\n" + table.text("  ") + more_rows(result.delay.size());
}

std::string bands(const Result& result) {
  if (result.spectrometer.empty()) return "";
  Columns table;
  table.add({"spectrometer", "band (nm)", "A (m²/sr)", "received (W/m²)", "AB magnitude", "phase angle (°)"});
  for (std::size_t i = 0; i < std::min(result.spectrometer.size(), kMostRows); ++i) {
    const auto& s = result.spectrometer[i];
    ResultKey key = s.key;
    key.band.clear();
    const std::string magnitude = format_with_error(s.magnitude_AB, s.magnitude_standard_error);
    const bool received = s.received_W_m2 > 0.0;
    table.add({member(key, result.orientations.size()), fmt::format("{:g}-{:g}", s.band.low_nm, s.band.high_nm),
               format_with_error(s.intensity_m2_per_sr.value, s.intensity_m2_per_sr.standard_error),
               received ? format_with_error(s.received_W_m2, s.received_W_m2_standard_error) : "n/a (no range)",
               magnitude, fmt::format("{:.4g}", s.phase_angle_rad * 180.0 / constants::kPi)});
  }
  return "\n" + table.text("  ") + more_rows(result.spectrometer.size());
}

double length(const Vec3& v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/// Of many directions the range of |C| says more than the first rows.
std::string force_span(const Result& result) {
  double low = length(result.pressure.front().coefficient_m2.value), high = low;
  for (const auto& p : result.pressure) {
    low = std::min(low, length(p.coefficient_m2.value));
    high = std::max(high, length(p.coefficient_m2.value));
  }
  return fmt::format("\n  pressure  {} directions: |C| = |F| c / E from {:.6g} to {:.6g} m²\n", result.pressure.size(),
                     low, high);
}

std::string forces(const Result& result) {
  constexpr double kSolarPressure = constants::kSolarConstant_W_m2 / constants::kLightSpeed_m_s;  // N/m²
  if (result.pressure.empty()) return "";
  if (result.pressure.size() > kMostRows / 3) return force_span(result);
  Columns table;
  table.add({"pressure", "", "x", "y", "z"});
  const auto three = [&](const std::string& name, const char* what, const VectorEstimate& v, double scale) {
    const auto cell = [&](int axis) {
      return format_with_error(v.value[axis] * scale, v.standard_error[axis] * scale);
    };
    table.add({name, what, cell(0), cell(1), cell(2)});
  };
  for (const auto& p : result.pressure) {
    three(member(p.key, result.orientations.size()), "force coefficient C (m²)", p.coefficient_m2, 1.0);
    three("", "torque coefficient (m³)", p.torque_coefficient_m3, 1.0);
    three("", "force at 1361 W/m² (N)", p.coefficient_m2, kSolarPressure);
  }
  return "\n" + table.text("  ");
}

/// "absorbed", or "absorbed 2" where the sum has several numbers.
std::string number_name(const TableResult& sum, std::size_t k) {
  return sum.values.size() > 1 ? sum.name + " " + std::to_string(k) : sum.name;
}

/// Sums that are results by themselves, in the units of their detectors' rows.
std::string sums(const Result& result) {
  if (result.table.empty()) return "";
  Columns table;
  table.add({"detector", "sum", "value"});
  std::size_t count = 0;
  for (const TableResult& sum : result.table) {
    for (std::size_t k = 0; k < sum.values.size(); ++k) {
      if (++count > kMostRows) continue;
      table.add({k == 0 ? member(sum.key, result.orientations.size()) : "", number_name(sum, k),
                 amount(sum.values[k], 1.0, sum.unit.c_str()) + "   (95 %: ±" + percent_error(sum.values[k]) + ")"});
    }
  }
  return "\n" + table.text("  ") + more_rows(count);
}

std::string file_list(const std::vector<std::string>& files) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(files.size(), 12); ++i) list += (i ? ", " : "") + files[i];
  if (files.size() > 12) list += fmt::format(", … ({} in all)", files.size());
  return list;
}

std::string target_row(const Result& result) {
  const std::string asked = fmt::format("{:g} %", result.target_percent);
  if (std::isnan(result.reached_percent)) return asked + ": n/a, all totals are zero";
  const std::string reached = fmt::format("{:.3g} %", result.reached_percent);
  if (result.target_reached) return asked + ": reached " + reached;
  return asked + ": " + (result.reached_percent <= result.target_percent ? "not confirmed, " : "not reached, ") +
         reached + " (stopped by: " + result.stopped_by + ")";
}

}  // namespace

std::string totals_line(const Result& result) {
  std::string text;
  for (const auto& delay : result.delay) {
    text += member(delay.key, result.orientations.size()) + ": A = " + amount(delay.intensity_m2_per_sr, 1.0, "m²/sr") +
            "\n";
  }
  for (const auto& s : result.spectrometer) {
    text += member(s.key, result.orientations.size()) + ": A = " + amount(s.intensity_m2_per_sr, 1.0, "m²/sr") + "\n";
  }
  for (const auto& p : result.pressure) {
    text += member(p.key, result.orientations.size()) + ": C =";
    for (int axis = 0; axis < 3; ++axis) {
      text +=
          (axis ? ", " : " ") + format_with_error(p.coefficient_m2.value[axis], p.coefficient_m2.standard_error[axis]);
    }
    text += " m²\n";
  }
  for (const TableResult& sum : result.table) {
    for (std::size_t k = 0; k < sum.values.size(); ++k) {
      text += member(sum.key, result.orientations.size()) + ": " + number_name(sum, k) + " = " +
              amount(sum.values[k], 1.0, sum.unit.c_str()) + "\n";
    }
  }
  return text;
}

std::string closing_table(const Result& result, const Scene& scene, const std::string& folder,
                          const std::vector<std::string>& files, const Reference* reference) {
  Columns table;
  table.add({"scene", scene.path.empty() ? scene.name : scene.path});
  table.add({"device", device_line(result.device)});
  table.add({"triangles", fmt::format("{}", result.mesh.triangles) +
                              (result.mesh.triangles ? fmt::format(", {:.6g} m²", result.mesh.area_m2) : "")});
  table.add({"extent", fmt::format("{:.6g} m across", result.extent_m)});
  if (result.orientations.size() > 1) table.add({"orientations", std::to_string(result.orientations.size())});
  table.add({"rays", short_count(static_cast<double>(result.rays)) +
                         (result.orientations.size() > 1 ? " per orientation" : "") +
                         (result.rays_total > result.rays * std::max<std::size_t>(result.orientations.size(), 1)
                              ? ", " + short_count(static_cast<double>(result.rays_total)) + " in all"
                              : "")});
  const auto& s = result.seconds;
  table.add({"time", fmt::format("{} (load {}, BVH {}, compile {}, trace {})", short_time(s.total), short_time(s.load),
                                 short_time(s.bvh), short_time(s.compile), short_time(s.trace))});
  if (result.target_asked) table.add({"target", target_row(result)});
  if (result.delay.size() == 1) one_pulse(table, result.delay.front());
  if (reference) {
    const double error = relative_true_error(result, *reference);
    table.add({"true error", std::isfinite(error) ? fmt::format("{:.3g} % against {}", 100.0 * error, reference->file)
                                                  : "n/a: " + reference->file + " has none of these totals"});
  }
  table.add({"digest", fmt::format("{:016x}", result.digest)});
  const std::string more =
      (result.delay.size() > 1 ? many_pulses(result) : "") + bands(result) + forces(result) + sums(result);
  const std::string list = folder + "/: " + file_list(files);
  if (more.empty()) table.add({"files", list});
  return table.text("  ") + (more.empty() ? "" : more + "\n  files  " + list + "\n");
}

}  // namespace clray::cli
