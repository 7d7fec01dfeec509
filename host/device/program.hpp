// SPDX-License-Identifier: Apache-2.0
// From kernel files to a built program: includes resolved among the embedded files, #line so that a compile error
// names the true file and line, options as one sorted name -> value map (the #defines, and the cache's key), and
// only the rows of the tables (brdf.def, shape.def, detector.def, walk.def) that a scene uses compiled.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "device/device_impl.hpp"
#include "device/embedded.hpp"

namespace clray {

/// What a program is specialised for.
struct ProgramOptions {
  std::map<std::string, std::string> defines;  ///< emitted as `#define name value` at the top
  std::vector<int> brdfs, shapes, detectors;   ///< row numbers used, in any order
  int walk = 0;                                ///< row number of the walk
  bool warnings_are_errors = false;            ///< also switched on by the environment's CLRAY_KERNEL_WERROR
  bool optimised = true;                       ///< false: compiled sooner, and slower; the same numbers

  bool operator==(const ProgramOptions& o) const {
    return defines == o.defines && brdfs == o.brdfs && shapes == o.shapes && detectors == o.detectors &&
           walk == o.walk && warnings_are_errors == o.warnings_are_errors && optimised == o.optimised;
  }
};

/// Kernel files by their path under kernels/.
using KernelFiles = std::map<std::string, std::string>;

/// The ids of a table's rows in their order (`table` is "brdf", "shape", "detector" or "walk").
std::vector<std::string> table_row_ids(const std::string& table, const KernelFiles& files);

/// One source for `entry` (a path under kernels/, such as "trace.cl"). Every file is taken once. Beside the files,
/// `#include "generated/brdf_all.inc"` (and shape_, detector_, walk_) gives the row numbers CLRAY_BRDF_<id> of all
/// rows, the files of the used rows, CLRAY_BRDFS(X) with X(id) for each used row, and CLRAY_BRDF_ONLY if there is just
/// one. Shapes with the trait `faces` are not in CLRAY_SHAPES.
/// Throws Error(bug) with file:line for a missing or cyclic include.
std::string flatten(const std::string& entry, const ProgramOptions& options);

/// The same from other files than the embedded ones.
std::string flatten(const std::string& entry, const ProgramOptions& options, const KernelFiles& files);

/// The source that build_program compiles on that device: flatten with the device's capability defines.
std::string program_source(const OpenedDevice& opened, const std::string& entry, const ProgramOptions& options,
                           const KernelFiles& files = embedded_kernels());

/// Names a program of the embedded files: entry and options. Cheaper than its source, and as telling on one device.
std::string program_name(const std::string& entry, const ProgramOptions& options);

/// Builds `entry` for the device, or takes what was built before. Throws Error(device) with device, build options and
/// the first lines of the log.
cl::Program build_program(OpenedDevice& opened, const std::string& entry, const ProgramOptions& options);

/// Builds a source made by flatten, or takes what was built before.
cl::Program build_source(OpenedDevice& opened, const std::string& entry, const std::string& source,
                         bool warnings_are_errors, bool optimised = true);

/// Whether the program that build_program would make is kept from earlier, here or by the driver.
bool program_is_kept(const OpenedDevice& opened, const std::string& entry, const ProgramOptions& options);

/// The options given to the OpenCL compiler.
std::string build_flags(const OpenedDevice& opened, bool warnings_are_errors, bool optimised = true);

}  // namespace clray
