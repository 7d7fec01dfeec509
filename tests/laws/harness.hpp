// SPDX-License-Identifier: Apache-2.0
// Runs the laws on random scenes and says what they found. A trial whose worst record would be met by chance in one of
// 20 trials is run again with 16 times the rays and other seeds, and fails if it deviates again beyond what a whole run
// of the harness would show by chance once in a hundred times. CLRAY_LAWS_SEED=n runs the scene n alone.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "laws/compare.hpp"
#include "laws/laws.hpp"

namespace clray_test {

enum class LawGroup { alone, order, symmetry };

class LawHarness {
 public:
  /// `solved`: scenes of which all is solved that can be, every other one of flat faces alone.
  LawHarness(LawGroup group, int scenes, int frames, bool solved = false)
      : group_(group), scenes_(scenes), frames_(frames), solved_(solved) {}

  /// Runs scenes that no other group has (or that of CLRAY_LAWS_SEED). Returns what fails, a text each: the law, the
  /// records, the seed, and the scene as TOML.
  std::vector<std::string> run();

  /// How many trials and records there were.
  std::string counts() const;
  /// counts(), and a line a kind of record: mean of t² and its error.
  std::string summary() const;
  /// Kinds of record whose claimed errors are too small: mean t² above what t of 15 degrees of freedom gives.
  std::vector<std::string> small_claims() const;
  /// Totals of all runs that were sampled, exact in their first bounce, and exact.
  std::array<int, 3> methods() const { return methods_; }

 private:
  clray::Result run_with(clray::Scene scene, int log2_rays, std::uint64_t seed) const;
  void run_scene(std::uint64_t seed);
  bool flat(std::uint64_t seed) const { return solved_ && seed % 2 == 0; }
  void run_trial(const RandomScene& random, const Trial& trial, const clray::Result& combined);
  void judge_again(const RandomScene& random, const Trial& trial, const std::vector<std::string>& names);
  void fail(const RandomScene& random, const Trial* trial, const std::string& what);
  double trials() const;

  LawGroup group_;
  int scenes_, frames_;
  bool solved_;
  ChiSquare chi_;
  std::vector<Comparison> of_scene_;
  std::vector<std::string> failures_;
  mutable std::array<int, 3> methods_{};
  int compared_ = 0, tried_ = 0, again_ = 0, refused_ = 0, doubtful_ = 0;
  std::vector<std::string> refusals_;
};

/// Scenes to run in each of the three groups: 3, or 334 with CLRAY_LONG_TESTS=1; frames: fewer for fewer, since each
/// costs some programs.
int law_scenes();
int law_frames();

}  // namespace clray_test
