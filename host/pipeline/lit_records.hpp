// SPDX-License-Identifier: Apache-2.0
// Which records of a run found light. A room notes each of its records; those that are zero in every orientation make a
// warning that names them.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "clray/result.hpp"
#include "scene/tables.hpp"

namespace clray {

/// The names of a record, its orientation left out: "delay, observer b, variant dull"; `fallback` where no detector is
/// named.
std::string record_label(const ResultKey& key, const char* fallback = "");

class LitRecords {
 public:
  /// Notes a record of a detector, a row of detector.def.
  void note(const TableRow& row, const ResultKey& key, bool lit);
  /// `sampled`: rays were traced. What they did not find may be there.
  std::vector<std::string> warnings(bool sampled) const;

 private:
  // By what a detector looks at: light toward observers, light on the body, or a picture.
  std::array<std::vector<std::pair<std::string, bool>>, 3> kinds_;
};

}  // namespace clray
