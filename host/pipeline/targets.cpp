// SPDX-License-Identifier: Apache-2.0
// What decides when a pass stops (see outcome.hpp; docs/physics.md, section 6).
#include <cmath>
#include <limits>

#include "pipeline/estimate.hpp"
#include "pipeline/outcome.hpp"

namespace clray {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The error of a mean vector's length: its error along the vector. What lies across changes the length in second
/// order.
double error_of_length(const Target& target, const std::vector<double>& means, double length, double rays) {
  std::vector<double> along(target.components.front().size());
  double solved = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    for (std::size_t r = 0; r < along.size(); ++r) along[r] += target.components[k][r] * (means[k] / length);
    solved += target.solved_of(k) * (means[k] / length);
  }
  return estimate_total(along, rays, solved).standard_error;
}

}  // namespace

void largest_error(const std::vector<Target>& targets, double rays, ErrorPoint* point) {
  point->relative_standard_error = point->first_total = point->first_standard_error = kNan;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    double value = 0.0, error = 0.0;
    std::vector<double> means;
    for (std::size_t axis = 0; axis < targets[t].components.size(); ++axis) {
      const Estimate e = estimate_total(targets[t].components[axis], rays, targets[t].solved_of(axis));
      means.push_back(e.value);
      value += e.value * e.value;
      error += e.standard_error * e.standard_error;
    }
    value = std::sqrt(value);
    error = std::sqrt(error);
    if (t == 0) {
      point->first_total = value;
      point->first_standard_error = value > 0.0 ? error_of_length(targets[t], means, value, rays) : error;
    }
    const double scale = targets[t].scale > 0.0 ? targets[t].scale : value;
    if (!(scale > 0.0)) continue;
    const double relative = error / scale;
    if (!(point->relative_standard_error >= relative)) point->relative_standard_error = relative;
  }
}

}  // namespace clray
