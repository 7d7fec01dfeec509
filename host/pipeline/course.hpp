// SPDX-License-Identifier: Apache-2.0
// The course of a pass as data: which points come next, and when it is over (docs/physics.md, section 6, "Stopping"). A
// course is stepped: next() names points to trace, took() tells what their error is, cut() that they were not finished.
// Its state is a plain value, so that a run can be saved between two steps and go on from there.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "clray/trace.hpp"

namespace clray {

constexpr std::uint64_t kDefaultRays = 1u << 22;  ///< over all views together, with no stopping option
constexpr std::uint64_t kFirstPoints = 1u << 10;  ///< of a view's first step, per replicate

/// The least power of two that is not below `value`.
inline std::uint64_t power_of_two_above(std::uint64_t value) {
  std::uint64_t p = 1;
  while (p < value) p *= 2;
  return p;
}

/// What a course is given.
struct CourseRules {
  std::uint64_t first_points = kFirstPoints;  ///< per replicate, of the first step
  std::uint64_t fixed_points = 0;             ///< not 0: that many, and no search
  std::uint64_t least_points = 0;             ///< of a confirmation
  std::uint64_t most_points = 0;              ///< of a search
  std::uint64_t enough_points = 0;            ///< from which on a total of zero counts as zero
  std::uint64_t least_to_stop = 1;            ///< of fixed points, before the target ends them
  double target = 0.0;                        ///< 95 % half-width over the value; 0: none
  bool target_asked = false;                  ///< by the user
  double t95 = 2.0;                           ///< half-width over standard error
  /// Not 0: each number of points is found anew, and the error falls with this power of it. A search then leaps to
  /// where the target is expected, and a confirmation takes one step.
  double anew_power = 0.0;
  const char* fixed_end = "rays";  ///< what ends fixed points: see Result::stopped_by
};

/// Points to trace: a phase's points are numbered from 0, on the scrambles of `epoch`.
struct CourseStep {
  const char* phase = "";  ///< "trace", "search" or "confirm"
  std::uint32_t epoch = 0;
  std::uint64_t points = 0;  ///< per replicate, in all, when the step is done
  bool confirms = false;     ///< apart from the search's points
};

/// Where a course stands.
struct CourseState {
  enum Phase { fixed, search, confirm, over } phase = search;
  std::uint64_t points = 0;        ///< that the next step reaches
  std::uint64_t confirm_size = 0;  ///< that the confirmation is to reach
  std::uint32_t epoch = 0;
  std::uint64_t searched = 0, confirmed = 0;  ///< points of the search, of all confirmations that were finished
  double error = std::numeric_limits<double>::quiet_NaN();  ///< relative, of the last step; NaN: all totals are zero
  double search_error = std::numeric_limits<double>::quiet_NaN();
  const char* ended_by = "";
  bool answer_confirmed = false;  ///< the result is the last confirmation's
  bool reached = false, partial = false;
};

class Course {
 public:
  explicit Course(const CourseRules& rules);
  Course(const CourseRules& rules, const CourseState& state) : rules_(rules), state_(state) {}

  /// The next step, or none when the course is over.
  std::optional<CourseStep> next() const;
  /// The step was traced; `relative_error` of its totals, NaN where all are zero.
  void took(double relative_error);
  /// The step was not finished: time or an interrupt (`by`) ended it.
  void cut(const char* by);

  const CourseRules& rules() const { return rules_; }
  const CourseState& state() const { return state_; }

 private:
  bool passes() const;
  std::uint64_t growth() const;
  void end(const char* by, bool reached);

  CourseRules rules_;
  CourseState state_;
};

}  // namespace clray
