// SPDX-License-Identifier: Apache-2.0
// The laws on random scenes (tests/laws) as rows of the table: 20 scenes each, 334 with CLRAY_LONG_TESTS=1. The tests
// run them as tests_laws.
#include <fmt/format.h>

#include "laws/harness.hpp"
#include "stability/case.hpp"

namespace clray_test {

namespace {

Outcome lawful(LawGroup group) {
  LawHarness harness(group, law_scenes(), law_frames());
  std::vector<std::string> failures = harness.run();
  const std::vector<std::string> claims = harness.small_claims();
  failures.insert(failures.end(), claims.begin(), claims.end());
  Outcome outcome;
  outcome.pass = failures.empty();
  outcome.measured = harness.counts();
  for (const std::string& failure : failures) outcome.measured += "; " + failure.substr(0, failure.find('\n'));
  return outcome;
}

}  // namespace

std::vector<Case> law_cases() {
  const char* const kJoint =
      "Student's t of 15, Bonferroni over records and trials; again with 16 times the rays; mean t² at most 15/13·1.1";
  return {
      {"laws", "members of a run against runs alone", "every record is that of a run alone", kJoint, false,
       [] { return lawful(LawGroup::alone); }},
      {"laws", "order of bands, variants, observers, parts and detectors", "nothing changes",
       std::string("exact for parts and detectors; else ") + kJoint, false, [] { return lawful(LawGroup::order); }},
      {"laws", "scaled, turned, swapped, split, hidden, a hair apart, pictured", "the same light",
       std::string("exact for scaled, split and hidden; else ") + kJoint, false,
       [] { return lawful(LawGroup::symmetry); }},
  };
}

}  // namespace clray_test
