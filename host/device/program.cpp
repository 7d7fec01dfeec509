// SPDX-License-Identifier: Apache-2.0
// Builds flattened sources, each once per device and process.
#include "device/program.hpp"

#include <fmt/format.h>

#include <cstdlib>
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

}  // namespace

std::string program_source(const OpenedDevice& opened, const std::string& entry, const ProgramOptions& options,
                           const KernelFiles& files) {
  ProgramOptions all = options;
  for (const auto& [name, value] : opened.defines) all.defines.emplace(name, value);
  return flatten(entry, all, files);
}

std::string build_flags(const OpenedDevice& opened, bool warnings_are_errors) {
  std::string flags = "-cl-std=CL1.2";
  if (opened.no_optimiser) flags += " -cl-opt-disable";
  if (warnings_are_errors || std::getenv("CLRAY_KERNEL_WERROR")) flags += " -Werror";
  return flags;
}

cl::Program build_source(OpenedDevice& opened, const std::string& entry, const std::string& source,
                         bool warnings_are_errors) {
  const std::string flags = build_flags(opened, warnings_are_errors);
  const std::string key = flags + "\n" + source;
  const auto built = opened.programs.find(key);
  if (built != opened.programs.end()) return built->second;
  return with_cl_errors(opened.info.name, [&] {
    cl::Program program(opened.context, source);
    try {
      program.build({opened.device}, flags.c_str());
    } catch (const cl::Error& error) {
      std::string log = first_lines(build_log(program, opened.device));
      if (log.empty()) log = "(the build log is empty)";
      if (!kernel_cache_writable()) log += "\n" + unwritable_cache();
      throw Error(ErrorCode::device,
                  fmt::format("{} does not build with {} ({}):\n{}", entry, flags, cl_error_name(error.err()), log),
                  opened.info.name);
    }
    opened.programs.emplace(key, program);
    return program;
  });
}

cl::Program build_program(OpenedDevice& opened, const std::string& entry, const ProgramOptions& options) {
  return build_source(opened, entry, program_source(opened, entry, options), options.warnings_are_errors);
}

}  // namespace clray
