// SPDX-License-Identifier: Apache-2.0
// Comparing the records of two runs: Student's t for each, thresholds by the number of comparisons (Bonferroni), a
// second run with 16 times the rays for what deviates, and the mean of t² over all, which shows claims that are too
// small.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "laws/records.hpp"

namespace clray_test {

/// P(|T| > t) of Student's t with 15 degrees of freedom, the least that the difference of two runs of 16 replicates
/// has.
double student_tail(double t);
/// The t that is exceeded with this probability.
double student_limit(double probability);

/// One record of both runs.
struct Comparison {
  std::string name;
  Record first, second;
  double t = 0.0;      ///< difference over joint error; infinite where a record is missing or zero errors disagree
  bool counts = true;  ///< false: one of the claims is said to be untrustworthy, so no test can rest on it
};

/// Every record of `second` against that of the same name in `first`. What they have in common, and how:
/// - a record that `first` lacks deviates, but for bins, of which the window speaks;
/// - errors are joint, with the rounding of integer sums (1e-9 of the scale) beside them: two runs of no error at all
///   (a flat face that fills the beam) must agree to 1e-7 of the scale;
/// - bins count where both runs put 100 hits there or more, and their ends are the same;
/// - moments and magnitudes count where both totals are known to 5 %; NaN stands for "no light", which the totals
/// compare;
/// - "balance" records are tested against 0, each by itself.
std::vector<Comparison> compare_records(const Records& first, const Records& second);

/// Names of the records of `second` that differ from those of `first` in any bit.
std::vector<std::string> different_bits(const Records& first, const Records& second);

/// Mean of t² by kind of record, over many scenes. Records of one scene are correlated, scenes are not: the error of
/// the mean comes from the spread between scenes.
class ChiSquare {
 public:
  void add_scene(const std::vector<Comparison>& comparisons);
  struct Mean {
    int scenes = 0;
    double records = 0.0, mean = 0.0, error = 0.0;
  };
  std::map<std::string, Mean> means() const;

 private:
  std::map<std::string, std::vector<std::pair<double, double>>> sums_;  ///< kind -> per scene (Σt², count)
};

}  // namespace clray_test
