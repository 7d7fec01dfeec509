// SPDX-License-Identifier: Apache-2.0
// The program clray: arguments -> public API -> files. Maps every error to an exit status. After a signal (signals.hpp)
// a run ends with what is finished.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <new>
#include <random>
#include <set>

#include "arguments.hpp"
#include "clray/device.hpp"
#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "clray/pass.hpp"
#include "clray/ranks.hpp"
#include "clray/result.hpp"
#include "clray/saved.hpp"
#include "clray/session.hpp"
#include "clray/sizes.hpp"
#include "clray/write.hpp"
#include "cluster/job.hpp"
#include "environment.hpp"
#include "helper.hpp"
#include "report.hpp"
#include "signals.hpp"
#include "text/temporaries.hpp"
#include "text/text.hpp"

namespace {

using namespace clray;
using Clock = std::chrono::steady_clock;

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
    session.plots = options.plots && !*options.stop;
    session.device = &device;
    session.warnings = options.warnings;
    MoreFiles files = session_files(result, scene, folder, session);
    *told = files.text;
    return files;
  });
  return told;
}

/// A run from its scene to its files.
class Run {
 public:
  Run(const cli::Arguments& arguments, const Scene& scene, cli::Signals& signals, cli::KernelFolder& kernels,
      cluster::Job* job, Warnings& warnings)
      : arguments_(arguments), scene_(scene), signals_(signals), kernels_(kernels), job_(job), warnings_(warnings) {}

  int trace_and_write(Clock::time_point start, double load_s) {
    const std::string asked = output_folder(arguments_, scene_);
    check_output(asked);
    if (const std::string fault = size_fault(scene_, asked); !fault.empty()) throw Error(ErrorCode::output, fault);
    if (!arguments_.reference.empty()) reference_ = fitting_reference();
    prepare_saving(asked);
    Device device(arguments_.device, job_ != nullptr ? NodePlace{job_->on_node(), job_->of_node()} : NodePlace{});
    device.limit_memory(arguments_.memory_bytes);
    Result result = traced(device);
    warnings_.show(result.warnings);
    if (saving_.share.of > 1) return say_share(result);
    if (result.partial && !finished_something_) {
      if (signals_.taken() != 0) return nothing_saved();
      throw Error(ErrorCode::usage,
                  "too short: not even the first doubling was finished, so there is no result" +
                      (is_saved(saving_.file) ? "; its sums are in " + saving_.file + ": clray --resume goes on"
                                              : std::string()),
                  "--time-limit");
    }
    result.seconds.load = load_s;
    result.seconds.total = seconds_since(start);
    write(result, device, result_folder(result, asked));
    if (!result.partial && !saving_.keep && is_saved(saving_.file)) std::remove(saving_.file.c_str());
    if (signals_.taken() == 0) return 0;
    std::fputs(result.partial ? "clray: interrupted: the result holds what was finished and is marked partial\n"
                              : "clray: interrupted when all was traced: the result is complete\n",
               stderr);
    say_how_to_go_on();
    return 128 + signals_.taken();
  }

 private:
  Reference fitting_reference() const {
    Reference reference = load_reference(arguments_.reference);
    check_reference(reference, scene_);
    return reference;
  }

  /// Where sums are saved, and what stands there.
  void prepare_saving(const std::string& folder) {
    saving_.keep = arguments_.keep_sums || arguments_.share.of > 1;
    saving_.every_s = arguments_.checkpoint_s;
    saving_.note = arguments_.note;
    saving_.from = arguments_.from;
    saving_.share = arguments_.share;
    const std::string file = cli::sums_file(folder);
    text::remove_unfinished(file);
    if (saving_.keep || saving_.every_s > 0.0) saving_.file = file;
    if (saving_.file.empty() || ::access(file.c_str(), F_OK) != 0) return;
    if (!is_saved(file))
      throw Error(ErrorCode::output, "will not replace " + file + ": it holds no sums of clray; choose another --out");
    if (saving_.from.empty())
      warnings_.show({file + " holds the sums of an earlier run and will be replaced; --resume goes on with them"});
  }

  void say_how_to_go_on() const {
    if (is_saved(saving_.file))
      std::fprintf(stderr, "clray: its sums are in %s: clray --resume goes on\n", text::shown(saving_.file).c_str());
  }

  int say_share(const Result& result) const {
    if (!result.partial) {
      print("share " + std::to_string(saving_.share.number) + " of " + std::to_string(saving_.share.of) +
            ": its sums are in " + saving_.file + "\n");
      return 0;
    }
    std::fputs("clray: interrupted: the share is not finished\n", stderr);
    say_how_to_go_on();
    return 128 + signals_.taken();
  }

  Result traced(Device& device) {
    cli::ProgressBar bar(!arguments_.quiet);
    TraceHooks hooks;
    hooks.progress = [&](const Progress& progress) {
      if (!finished_something_ && progress.keeps) kernels_.note_files();  // programs are built
      finished_something_ = finished_something_ || progress.keeps;
      if (progress.keeps || saving_.share.of > 1) signals_.keep_what_is_finished();
      bar.show(progress);
    };
    hooks.stop = &signals_.stop();
    if (job_ != nullptr) return trace(scene_, device, hooks, saving_, *job_);
    return trace(scene_, device, hooks, saving_);
  }

  int nothing_saved() const {
    std::fputs("clray: interrupted: nothing was finished, so there is no result\n", stderr);
    say_how_to_go_on();
    return 128 + signals_.taken();
  }

  void write(Result& result, Device& device, const std::string& folder) {
    if (folder != output_folder(arguments_, scene_))
      warnings_.show({"the older result is kept, since this one was interrupted and has less: see " + folder});
    WriteOptions options;
    options.plots = !arguments_.no_plots;
    options.netcdf = arguments_.netcdf;
    options.command = arguments_.command;
    options.reference_file = arguments_.reference;
    options.stop = &signals_.stop();
    std::vector<std::string> troubles;
    options.warnings = &troubles;
    const std::shared_ptr<std::string> ranging = range_with_station(scene_, device, result, options);
    const auto files = write_result(result, scene_, folder, options);
    warnings_.show(troubles);
    if (arguments_.explain) print(cli::explanation(result));
    if (arguments_.quiet) {
      print("device: " + cli::device_line(result.device) + "\n" + describe_result(result).totals);
    } else {
      print(cli::closing_table(result, scene_, folder, files, arguments_.reference.empty() ? nullptr : &reference_));
      if (!ranging->empty()) print("\n" + *ranging);
      if (job_ != nullptr) print(cli::ranks_line(job_->count(), job_->bytes()));
    }
  }

  const cli::Arguments& arguments_;
  const Scene& scene_;
  cli::Signals& signals_;
  cli::KernelFolder& kernels_;
  cluster::Job* job_;
  Warnings& warnings_;
  Reference reference_;
  Saving saving_;
  bool finished_something_ = false;
};

/// Computes a tenth of a run's sums again; 0 where they are the same.
int verify_sums(const cli::Arguments& arguments, const Scene& scene, cli::Signals& signals) {
  constexpr double kShare = 0.1;
  Device device(arguments.device);
  TraceHooks hooks;
  hooks.stop = &signals.stop();
  const std::string& file = arguments.from.front();
  const Verified found = verify(scene, device, file, kShare, std::random_device()(), hooks);
  const std::string compared = std::to_string(found.recomputed) + " of " + std::to_string(found.ranges) +
                               " ranges were computed again on " + cli::device_line(device.info()) + ", " +
                               std::to_string(found.numbers) + " sums";
  if (found.different.empty()) {
    print("the same: " + compared + " have the same bits\n");
    return 0;
  }
  for (const std::string& one : found.different) print("  " + one + "\n");
  throw Error(ErrorCode::bug, "not the same: " + compared + ", of which some differ", file);
}

int run(int argc, char** argv, cli::Signals& signals, cli::KernelFolder& kernels, cluster::Job* job) {
  const auto start = Clock::now();
  const auto arguments = cli::parse_arguments(argc, argv);
  if (arguments.finished) return 0;
  if (!arguments.list.empty()) {
    list(arguments.list);
    return 0;
  }
  Warnings warnings;
  Scene scene = load_scene(arguments.scene, arguments.scene_options);
  cli::apply(arguments, scene);
  try {
    if (const std::string fault = size_fault(scene, ""); !fault.empty()) throw Error(ErrorCode::input, fault);
    check_windows(scene);
    if (arguments.check) {
      print(describe_scene(scene) + describe_pass(scene));  // the warnings, too
      return 0;
    }
    warnings.show(scene.warnings);
    if (!kernels.trouble().empty()) warnings.show({kernels.trouble()});
    if (arguments.dump_kernel) {
      Device device(arguments.device);
      print(kernel_source(scene, device));
      return 0;
    }
    if (arguments.verb == "verify") return verify_sums(arguments, scene, signals);
    return Run(arguments, scene, signals, kernels, job, warnings).trace_and_write(start, seconds_since(start));
  } catch (const Error& error) {
    throw placed_in_file(error, arguments.scene);  // what a plan finds is said of the scene's member
  }
}

int fault(const char* format, const std::string& words, ErrorCode code) {
  std::fflush(stdout);
  std::fprintf(stderr, format, words.c_str());
  return static_cast<int>(code);
}

/// Whatever ends rank 0, the others wait for it no longer.
struct EndOfRun {
  cluster::Job* job;
  ~EndOfRun() {
    if (job != nullptr) leave_run(*job, {});
  }
};

/// Every error as an exit status.
int run_with_errors(int argc, char** argv, cli::Signals& signals, cli::KernelFolder& kernels) {
  std::unique_ptr<cluster::Job> job;
  try {
    job = cluster::join_job();
    if (job != nullptr && job->number() != 0) {
      cli::help_rank_0(argc, argv, *job, kernels);
      return 0;
    }
    const EndOfRun end{job.get()};
    const int status = run(argc, argv, signals, kernels, job.get());
    flush_output();
    return status;
  } catch (const Error& error) {
    signals.wait_if_ending();
    // A driver's words may have several lines.
    const bool lines = error.code() == ErrorCode::device || error.code() == ErrorCode::bug;
    return fault("clray: %s\n", lines ? text::shown_lines(error.what()) : text::shown(error.what()), error.code());
  } catch (const std::bad_alloc&) {
    return fault("clray: %s\n", "not enough memory for this scene", ErrorCode::input);
  } catch (const std::exception& error) {
    signals.wait_if_ending();
    return fault("clray: this is a fault of clray, please report it: %s\n", text::shown_lines(error.what()),
                 ErrorCode::bug);
  }
}

}  // namespace

int main(int argc, char** argv) {
  cli::Environment environment;
  cli::Signals signals;
  return run_with_errors(argc, argv, signals, environment.kernels());
}
