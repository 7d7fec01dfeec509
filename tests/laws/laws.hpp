// SPDX-License-Identifier: Apache-2.0
// The laws: pairs of scenes whose records must be the same. Most say "every record of a combined run equals that of a
// run alone"; the others are symmetries of light (docs/results.md has the quantities).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "laws/draw.hpp"
#include "laws/generator.hpp"
#include "laws/records.hpp"

namespace clray_test {

/// Two scenes and how the records of the second are those of the first.
struct Trial {
  std::string law;
  clray::Scene first, second;
  bool of_scene = false;   ///< the first is the random scene itself
  Names second_names;      ///< under which the second's records are found among the first's
  bool same_bits = false;  ///< nothing is shared by sampling: one seed, equal bits; else two seeds, joint errors
  std::function<Records(const Records&)> adjust;  ///< the second's records as they are in the first; null: as they are
  std::function<bool(const std::string& name, const Record&)> only;  ///< of the second's records; null: all
  bool warnings = false;                                             ///< warnings must be the same, too
};

/// Members of a run, -1 for all.
struct Pick {
  int detector = -1, observer = -1, variant = -1, band = -1;
  std::optional<std::size_t> orientation;  ///< index into Result::orientations
};

/// What runs alone: the members picked, everything else left out. `combined` is a result of the scene.
clray::Scene alone(const clray::Scene& scene, const clray::Result& combined, const Pick& pick, Names* names);

/// Each law's trials of a scene; `combined` is a result of it.
std::vector<Trial> alone_trials(const RandomScene& random, const clray::Result& combined, Draw& draw);
std::vector<Trial> order_trials(const RandomScene& random, Draw& draw);
std::vector<Trial> symmetry_trials(const RandomScene& random, const clray::Result& combined, Draw& draw);

}  // namespace clray_test
