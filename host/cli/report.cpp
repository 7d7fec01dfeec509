// SPDX-License-Identifier: Apache-2.0
// What the command line shows a person; see report.hpp. Text is UTF-8.
#include "report.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "clray/write.hpp"
#include "text/columns.hpp"

namespace clray::cli {

using text::characters;
using text::Columns;

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
  const int full = static_cast<int>(std::lround(fraction * kWidth));
  std::string bar;
  for (int i = 0; i < kWidth; ++i) bar += i < full ? "█" : "·";
  const std::string error =
      std::isfinite(progress.relative_error) ? fmt::format("±{:.2g} %", 100.0 * progress.relative_error) : "± ?";
  std::string line = fmt::format("{:<8} {} {:3.0f} %", progress.phase, bar, 100.0 * fraction);
  if (progress.rays != 0)
    line += fmt::format("  {} rays  {} rays/s  {}", short_count(static_cast<double>(progress.rays)),
                        short_count(progress.rays_per_s), error);
  line += fmt::format("  {} left", short_time(progress.seconds_left));
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

std::string rays_row(const Result& result) {
  if (result.rays_total == 0 && !result.partial) return "none: visibility is solved";
  const std::size_t orientations = std::max<std::size_t>(result.orientations.size(), 1);
  std::string row = short_count(static_cast<double>(result.rays));
  if (orientations > 1) row += " per orientation";
  if (result.rays_total > result.rays * orientations)
    row += ", " + short_count(static_cast<double>(result.rays_total)) + " in all";
  return row;
}

}  // namespace

std::string ranks_line(std::uint32_t ranks, std::uint64_t bytes) {
  return fmt::format("shared by {} ranks; {:.3g} MB came to rank 0\n", ranks, 1e-6 * static_cast<double>(bytes));
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
  table.add({"rays", rays_row(result)});
  const auto& s = result.seconds;
  table.add({"time", fmt::format("{} (load {}, BVH {}, compile {}, trace {})", short_time(s.total), short_time(s.load),
                                 short_time(s.bvh), short_time(s.compile), short_time(s.trace))});
  if (result.target_asked) table.add({"target", target_row(result)});
  const ResultText text = describe_result(result);
  for (const auto& row : text.rows) table.add({row.first, row.second});
  if (reference) {
    const double error = relative_true_error(result, *reference);
    table.add({"true error", std::isfinite(error) ? fmt::format("{:.3g} % against {}", 100.0 * error, reference->file)
                                                  : "n/a: " + reference->file + " has none of these totals"});
  }
  table.add({"digest", fmt::format("{:016x}", result.digest)});
  const std::string list = folder + "/: " + file_list(files);
  if (text.tables.empty()) table.add({"files", list});
  return table.text("  ") + (text.tables.empty() ? "" : text.tables + "\n  files  " + list + "\n");
}

}  // namespace clray::cli
