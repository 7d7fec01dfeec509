// SPDX-License-Identifier: Apache-2.0
// See case.hpp.
#include "stability/case.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clray_test {

std::vector<Case> stability_cases() {
  std::vector<Case> all;
  for (const auto& some : {bitwise_cases(), geometry_cases(), aimed_cases(), surface_cases(), lobe_cases(), bin_cases(),
                           photon_cases(), statistics_cases(), coverage_cases(), law_cases(), exact_cases()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

Outcome near(double found, double error, double exact, double slack) {
  const double off = std::fabs(found - exact), scale = std::fabs(exact) > 0.0 ? std::fabs(exact) : 1.0;
  Outcome outcome;
  outcome.pass = std::isfinite(found) && std::isfinite(error) && off <= 4.0 * error + slack * std::fabs(exact);
  outcome.measured = fmt::format("{:.9g}, off by {:.1e}, claimed {:.1e}", found, off / scale, error / scale);
  return outcome;
}

bool sound(const clray::Result& result, std::string* why) {
  const clray::Diagnostics& d = result.diagnostics;
  if (d.non_finite == 0 && d.stack_overflow == 0 && d.lost_rays == 0 && d.accumulator_overflow == 0) return true;
  *why += fmt::format("; non-finite {}, stack {}, lost {}, overflow {}", d.non_finite, d.stack_overflow, d.lost_rays,
                      d.accumulator_overflow);
  return false;
}

}  // namespace clray_test
