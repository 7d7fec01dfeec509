// SPDX-License-Identifier: Apache-2.0
// Faults that checks of devices must find, planted in the kernels' text.
#pragma once

#include <string>

#include "clray/error.hpp"
#include "device/embedded.hpp"
#include "device/program.hpp"

namespace clray::test {

/// The kernel files, where the first `text` in file `path` reads `fault`. Throws Error(bug) where it is not there.
inline KernelFiles files_with_fault(const std::string& path, const std::string& text, const std::string& fault) {
  KernelFiles files = embedded_kernels();
  std::string& file = files.at(path);
  const std::size_t at = file.find(text);
  if (at == std::string::npos) throw Error(ErrorCode::bug, "the line to be replaced is not there: " + text, path);
  file.replace(at, text.size(), fault);
  return files;
}

/// The kernels with a data race, or else with a value that nothing was written to.
inline KernelFiles with_planted_fault(bool race) {
  const char* path = "detector/delay.cl";
  if (race)
    return files_with_fault(path, "atomic_add(g->counts + sum_row(g, d, CLRAY_DELAY_HITS, row) + bin, hits);",
                            "g->counts[sum_row(g, d, CLRAY_DELAY_HITS, row) + bin] += hits;");
  KernelFiles files =
      files_with_fault(path, "const u32 bins = (u32)settings[0];",
                       "u32 never[3];\n  const u32 bins = (u32)settings[0] + never[row_of(tally) & 1u];");
  std::string& text = files.at(path);
  text.insert(text.find("static void"), "static u32 row_of(const Tally* t) { return t->view; }\n\n");
  return files;
}

}  // namespace clray::test
