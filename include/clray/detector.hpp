// SPDX-License-Identifier: Apache-2.0
// What is measured: one entry per detector of a run, a row of detector.def with its options.
#pragma once

#include <map>
#include <string>

#include "clray/export.hpp"

CLRAY_API_BEGIN
namespace clray {

/// A detector asked for by a scene or by --detector.
struct DetectorSpec {
  std::string kind = "delay";  ///< scene-file name of a row of detector.def
  std::string name;            ///< key of its results; the kind unless given
  /// By the row's keys, in the unit that the key names (start_ns, bin_ps, width, exposure …);
  /// an absent key takes its default.
  std::map<std::string, double> parameters;
};

/// What results call a detector: its name, or its kind where it has none.
inline const std::string& shown_name(const DetectorSpec& detector) {
  return detector.name.empty() ? detector.kind : detector.name;
}

}  // namespace clray
CLRAY_API_END
