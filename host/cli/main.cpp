// SPDX-License-Identifier: Apache-2.0
// The program clray: arguments -> public API -> files. Maps every error to an exit status, turns the first SIGINT or
// SIGTERM into an early end with what is finished, and the second into an end at once.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <new>
#include <set>

#include "arguments.hpp"
#include "clray/device.hpp"
#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "clray/pass.hpp"
#include "clray/result.hpp"
#include "clray/session.hpp"
#include "clray/sizes.hpp"
#include "environment.hpp"
#include "report.hpp"
#include "text/text.hpp"

namespace {

using namespace clray;
using Clock = std::chrono::steady_clock;

std::atomic<bool> stop_asked{false};
std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch only lock-free atomics");

extern "C" void on_signal(int signal) {
  if (stop_asked.exchange(true)) ::_exit(128 + signal);
  stop_signal = signal;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  // Calls such as write() are resumed, since an early end must not look like a failing disk.
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    // If the signal was ignored when we started (nohup, a shell's background job), it stays so.
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

/// Warnings on standard error, each once.
class Warnings {
 public:
  void show(const std::vector<std::string>& texts) {
    for (const auto& text : texts) {
      if (seen_.insert(text).second) std::fprintf(stderr, "clray: warning: %s\n", text::shown(text).c_str());
    }
  }

 private:
  std::set<std::string> seen_;
};

void print(const std::string& text) {
  const std::string shown = text::shown_lines(text);
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

void flush_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw Error(ErrorCode::output, "cannot write to standard output");
}

int interrupted(const char* what) {
  std::fprintf(stderr, "clray: interrupted %s\n", what);
  return 128 + stop_signal;
}

void list(const std::string& kind) {
  if (kind != "devices") return print(list_table(kind));
  const auto devices = list_devices();
  if (devices.empty()) Device none;  // throws, naming the packages to install
  print(cli::device_table(devices));
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string output_folder(const cli::Arguments& arguments, const Scene& scene) {
  if (!arguments.out.empty()) return arguments.out;
  return "clray-out/" + (scene.name.empty() ? std::string("scene") : scene.name);
}

/// Turns the pulse into photons if there is a station. With a motion there is also a session, run when the files are
/// written. Returns a text that then says what the session found.
std::shared_ptr<std::string> range_with_station(const Scene& scene, Device& device, Result& result,
                                                WriteOptions& options) {
  auto told = std::make_shared<std::string>();
  expect_photons(scene, &result);
  *told = link_budget_text(scene, result);
  if (!has_session(scene) || result.delay.empty()) return told;
  options.more.push_back([&, told](const std::string& folder) {
    SessionOptions session;
    session.plots = options.plots;
    session.device = &device;
    session.warnings = options.warnings;
    MoreFiles files = session_files(result, scene, folder, session);
    *told = files.text;
    return files;
  });
  return told;
}

int trace_and_write(const cli::Arguments& arguments, const Scene& scene, Warnings& warnings, Clock::time_point start,
                    double load_s) {
  const std::string folder = output_folder(arguments, scene);
  check_output(folder);
  if (const std::string fault = size_fault(scene, folder); !fault.empty()) throw Error(ErrorCode::output, fault);
  Reference reference;
  if (!arguments.reference.empty()) reference = load_reference(arguments.reference);
  Device device(arguments.device);
  if (stop_signal) return interrupted("before anything was traced");
  Result result;
  {
    cli::ProgressBar bar(!arguments.quiet);
    TraceHooks hooks;
    hooks.progress = [&](const Progress& progress) { bar.show(progress); };
    hooks.stop = &stop_asked;
    result = trace(scene, device, hooks);
  }
  warnings.show(result.warnings);
  if (result.partial && result.rays == 0) {
    if (stop_signal) return interrupted("before anything was finished; nothing is saved");
    throw Error(ErrorCode::usage, "too short: not even the first doubling was finished; nothing is saved",
                "--time-limit");
  }
  result.seconds.load = load_s;
  result.seconds.total = seconds_since(start);
  WriteOptions options;
  options.plots = !arguments.no_plots;
  options.netcdf = arguments.netcdf;
  options.command = arguments.command;
  options.reference_file = arguments.reference;
  std::vector<std::string> troubles;
  options.warnings = &troubles;
  const std::shared_ptr<std::string> ranging = range_with_station(scene, device, result, options);
  const auto files = write_result(result, scene, folder, options);
  warnings.show(troubles);
  if (arguments.explain) print(cli::explanation(result));
  if (arguments.quiet) {
    print("device: " + cli::device_line(result.device) + "\n" + describe_result(result).totals);
  } else {
    print(cli::closing_table(result, scene, folder, files, arguments.reference.empty() ? nullptr : &reference));
    if (!ranging->empty()) print("\n" + *ranging);
  }
  if (stop_signal) std::fputs("clray: interrupted: the result holds what was finished and is marked partial\n", stderr);
  return stop_signal ? 128 + stop_signal : 0;
}

int run(int argc, char** argv) {
  const auto start = Clock::now();
  const auto arguments = cli::parse_arguments(argc, argv);
  if (arguments.finished) return 0;
  if (!arguments.list.empty()) {
    list(arguments.list);
    return 0;
  }
  catch_signals();
  Warnings warnings;
  Scene scene = load_scene(arguments.scene, arguments.scene_options);
  cli::apply(arguments, scene);
  if (const std::string fault = size_fault(scene, ""); !fault.empty()) throw Error(ErrorCode::input, fault);
  check_windows(scene);
  if (arguments.check) {
    print(describe_scene(scene) + describe_pass(scene));  // the warnings, too
    return 0;
  }
  warnings.show(scene.warnings);
  if (arguments.dump_kernel) {
    Device device(arguments.device);
    print(kernel_source(scene, device));
    return 0;
  }
  return trace_and_write(arguments, scene, warnings, start, seconds_since(start));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const cli::Environment environment;
    const int status = run(argc, argv);
    flush_output();
    return status;
  } catch (const Error& error) {
    std::fflush(stdout);
    // A driver's words may have several lines.
    const bool lines = error.code() == ErrorCode::device || error.code() == ErrorCode::bug;
    std::fprintf(stderr, "clray: %s\n", (lines ? text::shown_lines(error.what()) : text::shown(error.what())).c_str());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    std::fputs("clray: not enough memory for this scene\n", stderr);
    return static_cast<int>(ErrorCode::input);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "clray: this is a fault of clray, please report it: %s\n",
                 text::shown_lines(error.what()).c_str());
    return static_cast<int>(ErrorCode::bug);
  }
}
