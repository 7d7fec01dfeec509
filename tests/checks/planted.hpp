// SPDX-License-Identifier: Apache-2.0
// Faults that checks of devices must find, planted in the kernels' text.
#pragma once

#include <string>

#include "clray/error.hpp"
#include "device/embedded.hpp"
#include "device/program.hpp"

namespace clray_test {

/// The kernels with a data race or, else, a value that nothing was written to. Throws Error(bug) where a line to be
/// replaced is not there any more.
inline clray::KernelFiles with_planted_fault(bool race) {
  clray::KernelFiles files = clray::embedded_kernels();
  std::string& text = files.at("detector/delay.cl");
  const std::string right = race ? "atomic_add(g->counts + sum_row(g, d, CLRAY_DELAY_HITS, row) + bin, hits);"
                                 : "const u32 bins = (u32)settings[0];";
  const std::string wrong = race ? "g->counts[sum_row(g, d, CLRAY_DELAY_HITS, row) + bin] += hits;"
                                 : "u32 never[3];\n  const u32 bins = (u32)settings[0] + never[row_of(tally) & 1u];";
  const std::size_t at = text.find(right);
  if (at == std::string::npos) throw clray::Error(clray::ErrorCode::bug, "the line to be replaced is not there", right);
  text.replace(at, right.size(), wrong);
  if (!race) text.insert(text.find("static void"), "static u32 row_of(const Tally* t) { return t->view; }\n\n");
  return files;
}

}  // namespace clray_test
