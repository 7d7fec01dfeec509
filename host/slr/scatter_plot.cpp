// SPDX-License-Identifier: Apache-2.0
// Delay against time through gnuplot; see scatter_plot.hpp. Script and image go through temporary files in the
// result's folder, and gnuplot runs in a process group of its own, so that an interrupt does not leave half a picture.
#include "slr/scatter_plot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace clray::slr {

namespace {

// The plotting area of the picture, in its pixels: a cell of the grid is a pixel.
constexpr int kWidth = 1026, kHeight = 604;

std::string quoted(const std::string& text) {
  std::string literal = "'";
  for (const char c : text) literal.append(c == '\'' ? 2 : 1, static_cast<unsigned char>(c) < ' ' ? ' ' : c);
  return literal + "'";
}

bool write_file(const std::string& path, const void* data, std::size_t size) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return false;
  const bool written = std::fwrite(data, 1, size, file) == size;
  return std::fclose(file) == 0 && written;
}

/// Runs gnuplot on a script in `folder`; false if it cannot be started or fails.
bool run_gnuplot(const std::string& folder, const std::string& script) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::string name = script;
  char program[] = "gnuplot", settings[] = "-d";
  char* const arguments[] = {program, settings, name.data(), nullptr};
  pid_t child = 0;
  const int code = ::posix_spawnp(&child, program, &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status == 0;
}

std::string script_of(const std::string& file, const std::string& image, const std::string& title, double start_s,
                      double stop_s, double low_ns, double high_ns) {
  const double dx = (stop_s - start_s) / kWidth, dy = (high_ns - low_ns) / kHeight;
  std::string s =
      "set encoding utf8\n"
      "if (strstrt(GPVAL_TERMINALS, ' pngcairo ')) { set terminal pngcairo noenhanced size 1200,750 font "
      "'DejaVu Sans,15' background '#ffffff' } else { set terminal png noenhanced truecolor size 1200,750 }\n"
      "set border 3 linecolor '#444444' linewidth 0.8\nset tics nomirror out textcolor '#222222'\n"
      "set lmargin at screen 0.11; set rmargin at screen 0.965; set bmargin at screen 0.115; set tmargin at screen "
      "0.92\n"
      "set key top right horizontal opaque box linecolor '#cccccc'\n"
      "set xlabel 'time (s)'\nset ylabel 'delay after a path by way of the reference point (ns)'\n";
  s += fmt::format("set output {}\nset title {} font ',18'\n", quoted(file), quoted(title));
  s += fmt::format("set xrange [{:.17g}:{:.17g}]\nset yrange [{:.17g}:{:.17g}]\n", start_s, stop_s, low_ns, high_ns);
  s += fmt::format(
      "plot {} binary array=({},{}) format='%uchar' dx={:.17g} dy={:.17g} origin=({:.17g},{:.17g}) using 1:2:3:4 with "
      "rgbalpha notitle, NaN with points pointtype 7 linecolor '#0b4f94' title 'signal', NaN with points pointtype 7 "
      "linecolor '#9a9a9a' title 'noise'\n",
      quoted(image), kWidth, kHeight, dx, dy, start_s + 0.5 * dx, low_ns + 0.5 * dy);
  return s;
}

}  // namespace

ScatterPlot::ScatterPlot(double start_s, double stop_s, double low_ns, double high_ns)
    : start_s_(start_s),
      stop_s_(stop_s > start_s ? stop_s : start_s + 1.0),
      low_ns_(low_ns),
      high_ns_(high_ns),
      signal_(static_cast<std::size_t>(kWidth) * kHeight),
      noise_(signal_.size()) {}

void ScatterPlot::add(double time_s, double delay_ns, bool signal) {
  const double x = std::floor((time_s - start_s_) / (stop_s_ - start_s_) * kWidth);
  const double y = std::floor((delay_ns - low_ns_) / (high_ns_ - low_ns_) * kHeight);
  if (!(x >= 0.0 && x < kWidth && y >= 0.0 && y < kHeight)) return;
  const std::size_t cell = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
  std::uint32_t& count = (signal ? signal_ : noise_)[cell];
  if (count != UINT32_MAX) ++count;
}

std::vector<std::uint8_t> ScatterPlot::pixels() const {
  std::vector<std::uint8_t> rgba(4 * signal_.size());
  // Few dots would hardly be seen as single pixels: they become plus signs of five.
  std::uint64_t filled = 0;
  for (std::size_t i = 0; i < signal_.size(); ++i) filled += signal_[i] + noise_[i] > 0;
  const bool large = filled < 40000;
  const auto paint = [&](long x, long y, const std::uint8_t(&colour)[3], std::uint32_t count) {
    if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) return;
    std::uint8_t* p = rgba.data() + 4 * (y * kWidth + x);
    std::copy(colour, colour + 3, p);
    p[3] = static_cast<std::uint8_t>(255.0 * (1.0 - std::pow(0.35, count)));
  };
  const std::uint8_t grey[3] = {0x9a, 0x9a, 0x9a}, blue[3] = {0x0b, 0x4f, 0x94};
  for (const bool signal : {false, true}) {
    for (long y = 0; y < kHeight; ++y) {
      for (long x = 0; x < kWidth; ++x) {
        const std::uint32_t count = (signal ? signal_ : noise_)[static_cast<std::size_t>(y * kWidth + x)];
        if (count == 0) continue;
        const auto& colour = signal ? blue : grey;
        paint(x, y, colour, count + (large ? 2 : 0));
        if (!large) continue;
        for (const long step : {-1L, 1L}) {
          paint(x + step, y, colour, count);
          paint(x, y + step, colour, count);
        }
      }
    }
  }
  return rgba;
}

std::string ScatterPlot::draw(const std::string& folder, const std::string& file, const std::string& title) const {
  const std::string image = file + ".rgba", script = file + ".gnuplot";
  const auto rgba = pixels();
  const std::string commands = script_of(file, image, title, start_s_, stop_s_, low_ns_, high_ns_);
  const std::string directory = folder.empty() ? "." : folder;
  std::string fault;
  if (!write_file(directory + "/" + image, rgba.data(), rgba.size()) ||
      !write_file(directory + "/" + script, commands.data(), commands.size())) {
    fault = "no " + file + ": cannot write a temporary file";
  } else if (!run_gnuplot(directory, script) || ::access((directory + "/" + file).c_str(), R_OK) != 0) {
    fault = "no " + file + ": gnuplot is not installed (package gnuplot-nox) or failed";
  }
  std::remove((directory + "/" + image).c_str());
  std::remove((directory + "/" + script).c_str());
  return fault;
}

}  // namespace clray::slr
