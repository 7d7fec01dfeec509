// SPDX-License-Identifier: Apache-2.0
// Runs the built program as a user would: its exit status and what it said on both channels.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace cli_test {

/// A temporary folder in which the program runs.
struct Scratch {
  std::filesystem::path path;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "clray-cli-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  bool has(const std::string& name) const { return std::filesystem::exists(path / name); }
};

inline std::string slurp(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void spit(const std::string& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// A unit square in z = 0, in metres.
inline std::string square() {
  return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
}

struct Outcome {
  int status = -1;       ///< exit status, or 128 + signal
  double peak_MB = 0.0;  ///< resident memory at most
  std::string out, err;
};

/// The program under test, from CLRAY_PROGRAM.
inline std::string program() {
  const char* name = ::getenv("CLRAY_PROGRAM");
  if (!name || !*name) throw std::runtime_error("CLRAY_PROGRAM must name the built program clray");
  return name;
}

/// A program running in the background, for signals.
class Running {
 public:
  /// `launcher`: the words of a program that starts it.
  Running(const Scratch& scratch, const std::vector<std::string>& arguments,
          const std::vector<std::string>& environment = {}, const std::vector<std::string>& launcher = {})
      : scratch_(scratch) {
    std::vector<std::string> words = launcher;
    words.push_back(program());
    words.insert(words.end(), arguments.begin(), arguments.end());
    child_ = ::fork();
    if (child_ == 0) start(words, environment);
    ::setpgid(child_, child_);  // here, too, since either may come first
  }
  void send(int signal) const { ::kill(child_, signal); }
  /// To it and to all that it started, as a terminal does.
  void send_to_group(int signal) const { ::kill(-child_, signal); }
  pid_t id() const { return child_; }
  bool alive() const {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
  }
  Outcome wait() const {
    int status = 0;
    rusage used{};
    ::wait4(child_, &status, 0, &used);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), 1024e-6 * used.ru_maxrss,
            slurp(scratch_ / ".out"), slurp(scratch_ / ".err")};
  }

 private:
  [[noreturn]] void start(std::vector<std::string>& words, const std::vector<std::string>& environment) const {
    ::setpgid(0, 0);
    const int out = ::open((scratch_ / ".out").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    const int err = ::open((scratch_ / ".err").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    ::dup2(out, 1);
    ::dup2(err, 2);
    if (::chdir(scratch_.path.c_str()) != 0) ::_exit(126);
    for (const auto& variable : environment) ::putenv(const_cast<char*>(variable.c_str()));
    std::vector<char*> pointers;
    for (auto& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
  }

  const Scratch& scratch_;
  pid_t child_ = -1;
};

inline Outcome clray(const Scratch& scratch, const std::vector<std::string>& arguments,
                     const std::vector<std::string>& environment = {}) {
  return Running(scratch, arguments, environment).wait();
}

/// Waits until a run that writes out.sums every second has found something, which a first signal then saves: whether it
/// has within two minutes.
inline bool has_found_something(const Scratch& scratch) {
  const auto begin = std::filesystem::file_time_type::clock::now();
  for (int k = 0; k < 2400; ++k) {
    std::error_code none;
    const auto written = std::filesystem::last_write_time(scratch / "out.sums", none);
    if (!none && written > begin) return true;
    ::poll(nullptr, 0, 50);
  }
  return false;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace cli_test
