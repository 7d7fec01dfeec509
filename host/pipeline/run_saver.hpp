// SPDX-License-Identifier: Apache-2.0
// Keeps what the passes of a run find, reads it from files of sums and writes it there while the run goes on.
#pragma once

#include <string>
#include <vector>

#include "pipeline/pass_runner.hpp"
#include "pipeline/saved_sums.hpp"

namespace clray {

class RunSaver {
 public:
  explicit RunSaver(const Saving& saving) : saving_(saving) {}

  /// Takes what the files to go on from have. Throws Error(usage) where they belong to another scene or not together,
  /// Error(input) where they are damaged.
  void begin(const std::vector<PassPlan>& plans, const Geometry& geometry);

  /// What a plan's pass has found.
  SavedPass& pass(const PassPlan& plan);
  const Share& share() const { return saving_.share; }
  bool has_one_of_several() const { return saving_.share.of > 1; }
  bool writes() const { return !saving_.file.empty(); }
  /// Whether any pass has found anything that the file could have.
  bool has_anything() const;
  /// The sums of a pass that is over, for its result. Where the file is to have them, they are in it before they go.
  Sums hand_over(const PassPlan& plan, bool whole);

  /// When runners should stop for a moment to save, and how.
  Checkpoint checkpoint();
  /// Writes the file, if there is one. Throws Error(output).
  void save();

 private:
  void check(const std::vector<SavedPass>& passes, const std::string& name) const;

  Saving saving_;
  SavedSums sums_;
  std::vector<const PassPlan*> plans_;  // of each pass
  const Geometry* geometry_ = nullptr;
  double last_s_ = 0.0, cost_s_ = 0.0;  // when it was saved, and what that took
};

}  // namespace clray
