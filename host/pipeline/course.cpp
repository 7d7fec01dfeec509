// SPDX-License-Identifier: Apache-2.0
// See course.hpp. A search doubles its points until the target is met. Then one confirmation of equal size runs on
// fresh scrambles, and it alone is the result. Where it misses the target, the search goes on. Where max_rays forbids
// that, the confirmation that missed is the result: the search had met the target by luck.
#include "pipeline/course.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace clray {
namespace {

constexpr double kCareful = 1.1;  // a leap that falls short costs more than one that goes a little far

}  // namespace

Course::Course(const CourseRules& rules) : rules_(rules) {
  if (rules.fixed_points != 0) {
    state_.phase = CourseState::fixed;
    state_.points = std::min(rules.fixed_points, rules.first_points);
  } else {
    state_.points = std::min(rules.first_points, power_of_two_above(rules.most_points / 2 + 1));
    if (state_.points > rules.most_points) end("max_rays", false);
  }
}

std::optional<CourseStep> Course::next() const {
  switch (state_.phase) {
    case CourseState::fixed:
      return CourseStep{"trace", 0, state_.points, false};
    case CourseState::search:
      return CourseStep{"search", 0, state_.points, false};
    case CourseState::confirm:
      return CourseStep{"confirm", state_.epoch, state_.points, true};
    case CourseState::over:
      break;
  }
  return std::nullopt;
}

bool Course::passes() const {
  if (std::isnan(state_.error)) return state_.points >= rules_.enough_points;
  return rules_.t95 * state_.error <= rules_.target;
}

/// How many times as many points a search takes next.
std::uint64_t Course::growth() const {
  if (rules_.anew_power == 0.0 || !(state_.error > 0.0)) return 2;
  const double ratio = std::pow(rules_.t95 * state_.error / rules_.target, 1.0 / rules_.anew_power);
  std::uint64_t leap =
      power_of_two_above(static_cast<std::uint64_t>(std::ceil(std::clamp(kCareful * ratio, 2.0, 16.0))));
  while (leap > 2 && leap * state_.points > rules_.most_points) leap /= 2;
  return leap;
}

void Course::end(const char* by, bool reached) {
  state_.phase = CourseState::over;
  state_.ended_by = by;
  state_.reached = reached;
}

void Course::took(double relative_error) {
  CourseState& s = state_;
  s.error = relative_error;
  const bool pass = rules_.target > 0.0 && passes();
  const char* const met = std::isnan(relative_error) ? "zero" : "target";
  if (s.phase == CourseState::fixed) {
    s.searched = s.points;
    if (pass && (s.points >= rules_.least_to_stop || 2 * s.points > rules_.fixed_points)) {
      end(met, !std::isnan(relative_error));
    } else if (2 * s.points > rules_.fixed_points) {
      end(rules_.fixed_end, false);
    }
    s.points *= 2;
  } else if (s.phase == CourseState::search) {
    s.searched = s.points;
    s.search_error = relative_error;
    s.answer_confirmed = false;
    if (pass) {
      s.phase = CourseState::confirm;
      s.confirm_size = std::max(s.points, rules_.least_points);
      ++s.epoch;
      s.points = rules_.anew_power > 0.0 ? s.confirm_size : std::min(rules_.first_points, s.confirm_size);
    } else {
      s.points *= growth();
      if (s.points > rules_.most_points) end("max_rays", false);
    }
  } else if (s.points < s.confirm_size) {
    s.points *= 2;
  } else {
    s.confirmed += s.confirm_size;
    s.answer_confirmed = true;
    if (pass) return end(met, !std::isnan(relative_error));
    s.phase = CourseState::search;
    s.points = 2 * s.searched;
    if (s.points > rules_.most_points) end("max_rays", false);
  }
}

void Course::cut(const char* by) {
  // A run that ends early must equal one with `rays` of that count, so its result is the search's.
  if (state_.phase == CourseState::confirm || state_.phase == CourseState::search) state_.error = state_.search_error;
  state_.answer_confirmed = false;
  state_.partial = true;
  end(by, false);
}

}  // namespace clray
