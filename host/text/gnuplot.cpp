// SPDX-License-Identifier: Apache-2.0
// Plots through gnuplot's standard input; see gnuplot.hpp. The script is an unnamed temporary file, so that neither a
// full pipe nor a dying gnuplot can hang or kill us. gnuplot has its own process group, so that Ctrl-C does not reach
// it.
#include "text/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "text/text.hpp"

namespace clray::text {

std::string gnuplot_text(std::string_view text) {
  std::string literal = "'";
  for (const char c : shown(text)) literal.append(c == '\'' ? 2 : 1, c);
  // "noenhanced" after a literal keeps '_' and '^' of users' names from becoming subscripts.
  return literal + "' noenhanced";
}

TimeAxis time_axis(double first_s, double last_s) {
  const double farthest = std::fmax(std::fabs(first_s), std::fabs(last_s));
  if (!(farthest > 2e4 * std::fabs(last_s - first_s)) || first_s == last_s) return {0.0, "time (s)"};
  const double zero_s = std::floor(first_s);
  return {zero_s, "time after " + number(zero_s) + " s (s)"};
}

Plot::Plot(const std::string& file, int width, int height) : file_(file) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  line("set encoding utf8");
  line("if (strstrt(GPVAL_TERMINALS, ' pngcairo ')) { set terminal pngcairo enhanced size " + size +
       " font 'DejaVu Sans,15' linewidth 1.5 background '#ffffff' }"
       " else { set terminal png enhanced truecolor size " +
       size + " font 'DejaVu Sans,13' background '#ffffff' }");
  line("set output '" + file + "'");
  line("set border 3 linecolor '#444444' linewidth 0.8");
  line("set tics nomirror textcolor '#222222'");
  line("set grid back linecolor '#dddddd' linetype 1 linewidth 0.6");
  line("set key above right horizontal nobox Left reverse width -1 samplen 2 font ',13'");
  line("set lmargin at screen 0.11; set rmargin at screen 0.965; set bmargin at screen 0.115");
  line(
      "set palette defined (0 '#440154', 1 '#472c7a', 2 '#3b518b', 3 '#2c718e', 4 '#21908d', 5 '#27ad81', "
      "6 '#5cc863', 7 '#aadc32', 8 '#fde725')");
}

Plot& Plot::line(std::string_view text) {
  script_.append(text).append("\n");
  return *this;
}

Plot& Plot::legend_beside() {
  return line(
      "set rmargin at screen 0.80; set key at screen 0.995, screen 0.91 right top vertical maxrows 30 nobox Left "
      "reverse width -1 samplen 2 font ',12'");
}

Plot& Plot::begin_data(const std::string& name) {
  return line("$" + name + " << END_OF_DATA");
}

Plot& Plot::point(std::initializer_list<double> numbers) {
  for (const double value : numbers) {
    // gnuplot reads exponents beyond those of a double as infinity; NaN means "no point" to it.
    script_ += std::isfinite(value) ? number(value) : "NaN";
    script_ += ' ';
  }
  script_.back() = '\n';
  return *this;
}

Plot& Plot::end_data() {
  return line("END_OF_DATA");
}

namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, Close>;

std::string first_words(std::FILE* file) {
  std::rewind(file);
  char buffer[300];
  const std::size_t n = std::fread(buffer, 1, sizeof buffer, file);
  return shown(std::string_view(buffer, n));
}

/// Our environment with LC_ALL=C.UTF-8, so that numbers keep their point and titles their letters.
std::vector<char*> environment(std::string& locale) {
  std::vector<char*> variables;
  for (char** variable = environ; *variable; ++variable) {
    if (std::strncmp(*variable, "LC_ALL=", 7) != 0) variables.push_back(*variable);
  }
  variables.push_back(locale.data());
  variables.push_back(nullptr);
  return variables;
}

/// Whether a file ends as every PNG does (ISO/IEC 15948: an empty chunk IEND with its checksum). gnuplot does not tell
/// of a full disk.
bool is_whole_png(const std::string& path) {
  const TemporaryFile file(std::fopen(path.c_str(), "rb"));
  char end[12];
  return file && std::fseek(file.get(), -12, SEEK_END) == 0 &&
         std::fread(end, 1, sizeof end, file.get()) == sizeof end &&
         std::memcmp(end, "\0\0\0\0IEND\xae\x42\x60\x82", sizeof end) == 0;
}

}  // namespace

std::string Plot::draw(const std::string& folder) const {
  const TemporaryFile input(std::tmpfile()), complaints(std::tmpfile());
  if (!input || !complaints || std::fwrite(script_.data(), 1, script_.size(), input.get()) != script_.size() ||
      std::fflush(input.get()) != 0) {
    return "no " + file_ + ": cannot write a temporary file";
  }
  std::rewind(input.get());
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(input.get()), 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(complaints.get()), 2);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  char program[] = "gnuplot", settings[] = "-d", standard_input[] = "-";
  char* const arguments[] = {program, settings, standard_input, nullptr};
  std::string locale = "LC_ALL=C.UTF-8";
  const auto variables = environment(locale);
  pid_t child = 0;
  const int code = ::posix_spawnp(&child, program, &actions, &attributes, arguments, variables.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (code == ENOENT) return "no " + file_ + ": gnuplot is not installed (package gnuplot-nox)";
  if (code != 0) return "no " + file_ + ": gnuplot cannot be started: " + std::strerror(code);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string path = folder + "/" + file_;
  const bool drawn = is_whole_png(path);
  if (status == 0 && drawn) return {};
  ::unlink(path.c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return "no " + file_ + ": gnuplot is not installed (package gnuplot-nox)";
  const std::string words = first_words(complaints.get());
  return "no " + file_ + ": gnuplot failed: " + (words.empty() ? "the picture is cut off (is the disk full?)" : words);
}

}  // namespace clray::text
