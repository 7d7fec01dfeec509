// SPDX-License-Identifier: Apache-2.0
// Builds flattened sources, each once per device and process. Built programs are kept beside the kernel cache, so that
// later processes need no compiler.
#include "device/program.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <optional>
#include <sstream>

#include "device/kernel_cache.hpp"

namespace clray {
namespace {

constexpr int kLogLines = 20;

std::string first_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string head;
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (++count > kLogLines) return head + "\n…";
    head += (head.empty() ? "" : "\n") + line;
  }
  return head;
}

std::string build_log(const cl::Program& program, const cl::Device& device) {
  try {
    return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
  } catch (const cl::Error&) {
    return {};
  }
}

/// Builds a program; a failure is an Error(device) with the first lines of the log.
void build(cl::Program* program, const OpenedDevice& opened, const std::string& entry, const std::string& flags) {
  try {
    program->build({opened.device}, flags.c_str());
  } catch (const cl::Error& error) {
    std::string log = first_lines(build_log(*program, opened.device));
    if (log.empty()) log = "(the build log is empty)";
    if (!kernel_cache_writable()) log += "\n" + unwritable_cache();
    throw Error(ErrorCode::device,
                fmt::format("{} does not build with {} ({}):\n{}", entry, flags, cl_error_name(error.err()), log),
                opened.info.name);
  }
}

/// The program as it was kept; none if there is none, or the driver does not take it.
std::optional<cl::Program> program_as_kept(const OpenedDevice& opened, const std::string& flags,
                                           const std::string& source) {
  const std::optional<std::string> kept = opened.has_cache ? std::nullopt : kept_binary(opened, flags, source);
  if (!kept) return std::nullopt;
  try {
    const std::vector<unsigned char> bytes(kept->begin(), kept->end());
    cl::Program program(opened.context, {opened.device}, cl::Program::Binaries{bytes});
    program.build({opened.device}, flags.c_str());
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  }
}

/// What is remembered of a program that the driver keeps.
std::string built_before(const std::string& flags, const std::string& source) {
  return "built\n" + flags + "\n" + source;
}

/// Keeps a built program, if the driver does not and gives it.
void keep(const cl::Program& program, const OpenedDevice& opened, const std::string& flags, const std::string& source) {
  if (opened.has_cache) {
    const std::string what = built_before(flags, source);
    if (!remembered(opened, what)) remember(opened, what);
    return;
  }
  try {
    const cl::Program::Binaries binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.size() == 1 && !binaries[0].empty())
      keep_binary(opened, flags, source, std::string(binaries[0].begin(), binaries[0].end()));
  } catch (const cl::Error&) {
    return;
  }
}

}  // namespace

std::string program_source(const OpenedDevice& opened, const std::string& entry, const ProgramOptions& options,
                           const KernelFiles& files) {
  ProgramOptions all = options;
  for (const auto& [name, value] : opened.defines) all.defines.emplace(name, value);
  return flatten(entry, all, files);
}

std::string build_flags(const OpenedDevice& opened, bool warnings_are_errors, bool optimised) {
  std::string flags = "-cl-std=CL1.2";
  if (opened.no_optimiser || !optimised) flags += " -cl-opt-disable";
  if (warnings_are_errors || std::getenv("CLRAY_KERNEL_WERROR")) flags += " -Werror";
  return flags;
}

cl::Program build_source(OpenedDevice& opened, const std::string& entry, const std::string& source,
                         bool warnings_are_errors, bool optimised) {
  const std::string flags = build_flags(opened, warnings_are_errors, optimised);
  const std::string key = flags + "\n" + source;
  const auto built = opened.programs.find(key);
  if (built != opened.programs.end()) return built->second;
  return with_cl_errors(opened.info.name, [&] {
    std::optional<cl::Program> kept = program_as_kept(opened, flags, source);
    if (kept) return opened.programs.emplace(key, *kept).first->second;
    cl::Program program(opened.context, source);
    build(&program, opened, entry, flags);
    keep(program, opened, flags, source);
    opened.programs.emplace(key, program);
    return program;
  });
}

std::string program_name(const std::string& entry, const ProgramOptions& options) {
  std::string name = entry;
  for (const auto& [key, value] : options.defines) name.append("\n").append(key).append("=").append(value);
  for (const std::vector<int>* rows : {&options.brdfs, &options.shapes, &options.detectors}) {
    name += "\n";
    for (const int row : *rows) name.append(" ").append(std::to_string(row));
  }
  return name + fmt::format("\n{} {} {}", options.walk, options.warnings_are_errors, options.optimised);
}

bool program_is_kept(const OpenedDevice& opened, const std::string& entry, const ProgramOptions& options) {
  const std::string flags = build_flags(opened, options.warnings_are_errors, options.optimised);
  const std::string source = program_source(opened, entry, options);
  return opened.has_cache ? remembered(opened, built_before(flags, source))
                          : kept_binary(opened, flags, source).has_value();
}

cl::Program build_program(OpenedDevice& opened, const std::string& entry, const ProgramOptions& options) {
  const std::string name = program_name(entry, options);
  const auto built = opened.by_name.find(name);
  if (built != opened.by_name.end()) return built->second;
  cl::Program program = build_source(opened, entry, program_source(opened, entry, options), options.warnings_are_errors,
                                     options.optimised);
  opened.by_name.emplace(name, program);
  return program;
}

}  // namespace clray
