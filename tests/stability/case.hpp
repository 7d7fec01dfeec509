// SPDX-License-Identifier: Apache-2.0
// The stiff and extreme cases: each says what must hold, measures it, and says where its tolerance comes from.
// clray-bench stability prints them all, those marked `long_run` where CLRAY_LONG_TESTS=1 or --only asks for them; the
// tests run those marked `quick`, and with CLRAY_LONG_TESTS=1 (scripts/test --long) all.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/closed_forms.hpp"

namespace clray_test {

struct Outcome {
  bool pass = false;
  std::string measured;
};

struct Case {
  std::string area;  ///< "bitwise", "geometry", "surfaces", "bins", "statistics", "coverage", "laws", "exact"
  std::string name;
  std::string must_hold;
  std::string tolerance;  ///< and where it comes from
  bool quick = true;
  std::function<Outcome()> run;
  bool long_run = false;  ///< takes many minutes: run only if it is asked for
};

/// All cases, in the order in which they are reported.
std::vector<Case> stability_cases();

std::vector<Case> bitwise_cases();
std::vector<Case> geometry_cases();
std::vector<Case> aimed_cases();
std::vector<Case> surface_cases();
std::vector<Case> lobe_cases();
std::vector<Case> bin_cases();
std::vector<Case> photon_cases();
std::vector<Case> statistics_cases();
std::vector<Case> coverage_cases();
std::vector<Case> law_cases();
std::vector<Case> exact_cases();

/// A sum of equal weights: each is rounded alike, by up to half of 2^-37 of the largest weight (docs/physics.md,
/// section 7).
constexpr double kQuantumOfTotal = 1e-11;

/// "value (off by x)" and whether |found − exact| ≤ 4·error + slack·|exact|.
Outcome near(double found, double error, double exact, double slack);

/// Passes if no failure was counted; else says which.
bool sound(const clray::Result& result, std::string* why);

}  // namespace clray_test
