// SPDX-License-Identifier: Apache-2.0
// Statistics of replicates. Everything here decides when a run stops, so it uses + - * / sqrt and clray's own
// elementary functions only: the same bits on every host.
#include "pipeline/estimate.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "shared/elementary.h"

namespace clray {
namespace {

/// P(|T| <= t) for integer degrees of freedom: the finite sums of Abramowitz & Stegun 26.7.3 and 26.7.4.
double student_probability(double t, int freedom) {
  const double n = freedom;
  const double theta = el_atan2(t, std::sqrt(n));
  const double c2 = n / (n + t * t);
  const double s = t / std::sqrt(n + t * t), c = std::sqrt(c2);
  double term = 1.0, sum = 0.0;
  if (freedom % 2 == 0) {
    for (int k = 0; k <= freedom - 2; k += 2) {
      sum += term;
      term *= c2 * (k + 1.0) / (k + 2.0);
    }
    return s * sum;
  }
  term = c;
  for (int k = 1; k <= freedom - 2; k += 2) {
    sum += term;
    term *= c2 * (k + 1.0) / (k + 2.0);
  }
  return 2.0 * CLRAY_INV_PI * (theta + s * sum);
}

double solve_student_t95(int freedom) {
  double low = 0.0, high = 16.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (student_probability(middle, freedom) < 0.95 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// MCNP's VOV, from the sums of squares and of fourth powers of the deviations.
double variance_of_variance(double second, double fourth, double count) {
  return second > 0.0 ? fourth / (second * second) - 1.0 / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double normal_variance_of_variance(int replicates) {
  const double count = replicates;
  return 2.0 * (count - 2.0) / (count * (count + 1.0));
}

double student_t95(int freedom) {
  // Each estimate of each bin asks for it, and a run has few counts of replicates.
  static const std::array<double, 64> table = [] {
    std::array<double, 64> t{};
    for (int n = 1; n < 64; ++n) t[static_cast<std::size_t>(n)] = solve_student_t95(n);
    return t;
  }();
  return freedom < 64 ? table[static_cast<std::size_t>(freedom)] : solve_student_t95(freedom);
}

Estimate exact_number(double value) {
  Estimate e;
  e.value = e.low = e.high = value;
  e.relative_variance_of_variance = std::numeric_limits<double>::quiet_NaN();
  return e;
}

void set_error(double standard_error, std::size_t replicates, Estimate* estimate) {
  const double half = student_t95(static_cast<int>(replicates) - 1) * standard_error;
  estimate->standard_error = standard_error;
  estimate->low = estimate->value - half;
  estimate->high = estimate->value + half;
}

Estimate estimate_mean(const std::vector<double>& replicates) {
  if (replicates.size() == 1) return exact_number(replicates.front());
  const double count = static_cast<double>(replicates.size());
  double sum = 0.0;
  for (const double x : replicates) sum += x;
  Estimate e;
  e.value = sum / count;
  double second = 0.0, fourth = 0.0;
  for (const double x : replicates) {
    const double square = (x - e.value) * (x - e.value);
    second += square;
    fourth += square * square;
  }
  set_error(std::sqrt(second / (count * (count - 1.0))), replicates.size(), &e);
  e.relative_variance_of_variance = variance_of_variance(second, fourth, count);
  return e;
}

double error_of_agreement(std::uint64_t replicates) {
  return poisson_upper95(0) / (static_cast<double>(replicates) * student_t95(static_cast<int>(replicates) - 1));
}

bool agree(double value, double standard_error) {
  constexpr double kRounding = 1e-9;  // of weights that are alike but for their last digits
  return standard_error <= kRounding * std::fabs(value);
}

Estimate estimate_total(const std::vector<double>& replicates, double rays, double solved, double most) {
  if (replicates.size() == 1) return exact_number(replicates.front() + solved);
  Estimate e = estimate_mean(replicates);
  double error = e.standard_error;
  if (agree(e.value, error) && rays > 0.0) {
    const double brought = e.value != 0.0 ? e.value : solved != 0.0 ? solved : most;
    error = error_of_agreement(replicates.size()) * std::fabs(brought) / rays;
  }
  e.value += solved;
  set_error(error, replicates.size(), &e);
  return e;
}

Estimate estimate_jackknife(double pooled, const std::vector<double>& left_out) {
  if (left_out.size() == 1) return exact_number(pooled);
  const double count = static_cast<double>(left_out.size());
  double mean = 0.0;
  for (const double x : left_out) mean += x / count;
  double second = 0.0, fourth = 0.0;
  for (const double x : left_out) {
    const double square = (x - mean) * (x - mean);
    second += square;
    fourth += square * square;
  }
  Estimate e;
  e.value = pooled;
  set_error(std::sqrt(second * (count - 1.0) / count), left_out.size(), &e);
  e.relative_variance_of_variance = variance_of_variance(second, fourth, count);
  return e;
}

Estimate sum_of_parts(const Estimate& a, const Estimate& b) {
  Estimate e = a;
  e.value += b.value;
  e.standard_error += b.standard_error;
  e.low += b.low;
  e.high += b.high;
  e.rounding_bound += b.rounding_bound;
  e.relative_variance_of_variance = std::fmax(a.relative_variance_of_variance, b.relative_variance_of_variance);
  return e;
}

namespace {

/// Solves P(N <= hits; mean) = 0.05 by bisection.
double solve_poisson_upper95(std::uint64_t hits) {
  double low = static_cast<double>(hits), high = low + 4.0 * std::sqrt(low) + 8.0;
  for (int k = 0; k < 60; ++k) {
    const double mean = 0.5 * (low + high);
    double term = el_exp(-mean), sum = term;
    for (std::uint64_t n = 1; n <= hits; ++n) sum += term *= mean / static_cast<double>(n);
    (sum > 0.05 ? low : high) = mean;
  }
  return high;
}

}  // namespace

double poisson_upper95(std::uint64_t hits) {
  if (hits == 0) return 3.0;
  if (hits > 400) return static_cast<double>(hits) + 1.6449 * std::sqrt(static_cast<double>(hits)) + 2.0;  // normal
  // Each unresolved bin asks for it.
  static const std::array<double, 64> table = [] {
    std::array<double, 64> t{};
    for (std::uint64_t n = 1; n < 64; ++n) t[n] = solve_poisson_upper95(n);
    return t;
  }();
  return hits < 64 ? table[hits] : solve_poisson_upper95(hits);
}

}  // namespace clray
