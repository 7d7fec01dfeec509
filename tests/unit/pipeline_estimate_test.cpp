// SPDX-License-Identifier: Apache-2.0
// Statistics that decide when a run stops and how wide its error bars are: against numerical integration, direct
// summation and closed forms, none of which shares a formula with host/pipeline/estimate.cpp.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pipeline/estimate.hpp"
#include "pipeline/outcome.hpp"
#include "text/hash.hpp"

using namespace clray;

namespace {

constexpr long double kPiL = 3.14159265358979323846264338327950288L;

/// P(|T| <= t): Student's density integrated by Simpson's rule. With T = sqrt(n)·tan(a) it is cos(a)^(n-1), smooth on
/// [0, atan(t/sqrt n)], over the same up to pi/2. 20,000 panels of at most 8e-5: error below 1e-15.
long double student_two_sided(long double t, int n) {
  const auto integral = [n](long double end) {
    const int panels = 20000;
    const long double h = end / panels;
    long double sum = 0.0L;
    for (int k = 0; k <= panels; ++k)
      sum += (k == 0 || k == panels ? 1 : k % 2 ? 4 : 2) * std::pow(std::cos(k * h), n - 1);
    return sum * h / 3;
  };
  return integral(std::atan(t / std::sqrt(static_cast<long double>(n)))) / integral(kPiL / 2);
}

/// P(N <= hits) for a Poisson mean, term by term through logarithms of factorials.
long double poisson_at_most(std::uint64_t hits, long double mean) {
  long double sum = 0.0L;
  for (std::uint64_t n = 0; n <= hits; ++n)
    sum += std::exp(static_cast<long double>(n) * std::log(mean) - mean - std::lgamma(n + 1.0L));
  return sum;
}

long double poisson_exact_upper(std::uint64_t hits) {
  long double low = static_cast<long double>(hits), high = 2 * low + 20;
  for (int k = 0; k < 200; ++k) {
    const long double middle = (low + high) / 2;
    (poisson_at_most(hits, middle) > 0.05L ? low : high) = middle;
  }
  return high;
}

std::vector<double> numbers(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(3.0, 0.25);
  std::vector<double> x;
  for (std::size_t i = 0; i < count; ++i) x.push_back(normal(random));
  return x;
}

}  // namespace

TEST_CASE("Student's t: exactly 95 % of the density lies within the quantile") {
  for (int freedom = 1; freedom <= 63; ++freedom) {
    CAPTURE(freedom);
    const double t = student_t95(freedom);
    CHECK(std::fabs(static_cast<double>(student_two_sided(t, freedom)) - 0.95) < 1e-13);
  }
  // Closed forms: tan(0.475 pi) for one degree of freedom, 2·0.95/sqrt(2·(1 - 0.95²)) for two.
  CHECK(std::fabs(student_t95(1) - std::tan(0.475 * static_cast<double>(kPiL))) < 1e-12);
  CHECK(std::fabs(student_t95(2) - 1.9 / std::sqrt(2.0 * (1.0 - 0.95 * 0.95))) < 1e-13);
  // Toward the normal distribution's 1.959964 with t/z - 1 -> (z² + 1)/(4 n), as Cornish & Fisher expand it.
  const double z = 1.959963984540054;
  CHECK(std::fabs(student_t95(5000) / z - 1.0 - (z * z + 1.0) / 20000.0) < 1e-7);
}

TEST_CASE("mean, standard error and interval of replicates") {
  // 1 … 16: mean 8.5, sum of squares about it n(n²-1)/12 = 340, fourth powers n(n²-1)(3n²-7)/240 = 12937.
  std::vector<double> x;
  for (int i = 1; i <= 16; ++i) x.push_back(i);
  const Estimate e = estimate_mean(x);
  CHECK(e.value == 8.5);
  CHECK(e.standard_error == doctest::Approx(std::sqrt(340.0 / (16 * 15))).epsilon(1e-15));
  CHECK(e.high - e.value == doctest::Approx(2.131449545559323 * e.standard_error).epsilon(1e-12));
  CHECK(e.value - e.low == doctest::Approx(e.high - e.value).epsilon(1e-15));
  CHECK(e.relative_variance_of_variance == doctest::Approx(12937.0 / (340.0 * 340.0) - 1.0 / 16).epsilon(1e-14));

  // Two replicates: |a - b|/2.
  const Estimate two = estimate_mean({1.0, 4.0});
  CHECK(two.value == 2.5);
  CHECK(two.standard_error == doctest::Approx(1.5).epsilon(1e-15));

  // No spread: error 0, a variance of the variance nobody knows.
  const Estimate none = estimate_mean(std::vector<double>(16, 0.1));
  CHECK(none.value == doctest::Approx(0.1).epsilon(1e-15));
  CHECK(none.standard_error < 1e-16);
  const Estimate zero = estimate_mean(std::vector<double>(16, 0.0));
  CHECK(zero.standard_error == 0.0);
  CHECK(zero.low == 0.0);
  CHECK(std::isnan(zero.relative_variance_of_variance));

  // A million times a shift: two passes keep the digits that a sum of squares would lose.
  std::vector<double> shifted = x;
  for (double& v : shifted) v = v * 1e-7 + 1e6;
  CHECK(estimate_mean(shifted).standard_error == doctest::Approx(1e-7 * e.standard_error).epsilon(1e-3));
}

TEST_CASE("the interval of the mean covers 95 % of normal samples") {
  // 20,000 sets of 16: the share's own standard error is 0.15 %.
  std::mt19937_64 random(77);
  std::normal_distribution<double> normal(-2.0, 5.0);
  int covered = 0;
  const int sets = 20000;
  for (int s = 0; s < sets; ++s) {
    std::vector<double> x;
    for (int i = 0; i < 16; ++i) x.push_back(normal(random));
    const Estimate e = estimate_mean(x);
    covered += e.low <= -2.0 && -2.0 <= e.high;
  }
  CHECK(std::fabs(covered / double(sets) - 0.95) < 4 * 0.00154);
}

TEST_CASE("the jackknife of a mean is its standard error; of a ratio the linearised one") {
  const std::vector<double> x = numbers(16, 3), y = numbers(16, 4);
  double sum_x = 0.0, sum_y = 0.0;
  for (const double v : x) sum_x += v;
  for (const double v : y) sum_y += v;
  std::vector<double> left;
  for (const double v : x) left.push_back((sum_x - v) / 15.0);
  const Estimate mean = estimate_mean(x), jack = estimate_jackknife(sum_x / 16.0, left);
  CHECK(jack.value == sum_x / 16.0);
  CHECK(jack.standard_error == doctest::Approx(mean.standard_error).epsilon(1e-12));
  CHECK(jack.high == doctest::Approx(mean.high).epsilon(1e-12));
  CHECK(jack.low == doctest::Approx(mean.low).epsilon(1e-12));

  // Ratio r = X/Y: variance sum((x - r·y)²)·n/((n-1)·Y²) to first order; the rest is of relative order sd(y)/(n·mean).
  std::vector<double> ratios;
  const double ratio = sum_x / sum_y;
  double square = 0.0;
  for (std::size_t i = 0; i < 16; ++i) {
    ratios.push_back((sum_x - x[i]) / (sum_y - y[i]));
    square += (x[i] - ratio * y[i]) * (x[i] - ratio * y[i]);
  }
  const Estimate e = estimate_jackknife(ratio, ratios);
  CHECK(e.value == ratio);
  CHECK(e.standard_error == doctest::Approx(std::sqrt(square * 16.0 / 15.0) / sum_y).epsilon(0.02));

  // Two halves: left-out values a and b give sqrt(((a-m)² + (b-m)²)/2) = |a - b|/2.
  CHECK(estimate_jackknife(5.0, {4.0, 7.0}).standard_error == doctest::Approx(1.5).epsilon(1e-15));
}

TEST_CASE("Poisson's upper bound leaves 5 % to as few hits") {
  // No hits: -ln 0.05 = 2.99573; docs/physics.md, section 6, rounds it up to 3.0, which errs on the safe side by 0.15
  // %.
  CHECK(poisson_upper95(0) == 3.0);
  CHECK(poisson_upper95(0) >= -std::log(0.05));
  CHECK(poisson_upper95(0) < -std::log(0.05) * 1.0015);
  for (std::uint64_t hits = 1; hits <= 400; ++hits) {
    CAPTURE(hits);
    const double bound = poisson_upper95(hits);
    CHECK(std::fabs(static_cast<double>(poisson_at_most(hits, bound)) - 0.05) < 1e-11);
  }
  for (const std::uint64_t hits : {401ull, 402ull, 1000ull, 20000ull}) {  // the normal approximation: safe, and near
    CAPTURE(hits);
    const double bound = poisson_upper95(hits), exact = static_cast<double>(poisson_exact_upper(hits));
    CHECK(bound >= exact);
    CHECK(bound < exact + 1.0);
  }
  double before = 0.0;
  for (std::uint64_t hits = 0; hits < 1000; ++hits) {  // and it grows, also where the formulas meet
    CHECK(poisson_upper95(hits) > before);
    before = poisson_upper95(hits);
  }
}

TEST_CASE("FNV-1a gives its published answers") {
  CHECK(fnv1a(kFnvStart, "", 0) == 0xcbf29ce484222325ull);
  CHECK(fnv1a(kFnvStart, "a", 1) == 0xaf63dc4c8601ec8cull);
  CHECK(fnv1a(kFnvStart, "foobar", 6) == 0x85944171f73967e8ull);
  CHECK(fnv1a(fnv1a(kFnvStart, "foo", 3), "bar", 3) == 0x85944171f73967e8ull);
}

TEST_CASE("the first total's error: of a number its own, of a vector that along it") {
  const std::vector<double> x = numbers(16, 5), y = numbers(16, 6), z = numbers(16, 7);
  ErrorPoint point;
  largest_error({{{x}, 0.0}}, 1000.0, &point);
  CHECK(point.first_total == estimate_mean(x).value);
  CHECK(point.first_standard_error == doctest::Approx(estimate_mean(x).standard_error).epsilon(1e-14));
  CHECK(point.relative_standard_error == doctest::Approx(point.first_standard_error / point.first_total));

  // Each replicate's length along the mean direction, by hand.
  const double m[3] = {estimate_mean(x).value, estimate_mean(y).value, estimate_mean(z).value};
  const double length = std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  double square = 0.0;
  for (std::size_t r = 0; r < 16; ++r) {
    const double along = (x[r] * m[0] + y[r] * m[1] + z[r] * m[2]) / length;
    square += (along - length) * (along - length) / (16.0 * 15.0);
  }
  // A second target with a larger error decides the relative error, not the first total.
  const std::vector<double> coarse = {1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0};
  largest_error({{{x, y, z}, 0.0}, {{coarse}, 0.0}}, 1000.0, &point);
  CHECK(point.first_total == doctest::Approx(length).epsilon(1e-14));
  CHECK(point.first_standard_error == doctest::Approx(std::sqrt(square)).epsilon(1e-12));
  CHECK(point.relative_standard_error == doctest::Approx(0.5 * estimate_mean(coarse).standard_error));

  const std::vector<double> none(16, 0.0);
  largest_error({{{none, none, none}, 0.0}}, 1000.0, &point);
  CHECK(point.first_total == 0.0);
  CHECK(point.first_standard_error == 0.0);
  CHECK(std::isnan(point.relative_standard_error));
}

TEST_CASE("relative variance of the variance: normal samples, one outlier, the jackknife of a mean") {
  for (const int count : {4, 8, 16, 32, 64}) {
    // 4000 samples; the standard deviation of one is at most 0.67 of the mean's own size (count 8), so 0.67/sqrt(4000).
    double sum = 0.0;
    for (std::uint64_t k = 0; k < 4000; ++k)
      sum += estimate_mean(numbers(static_cast<std::size_t>(count), 1000 * k + 7)).relative_variance_of_variance / 4000;
    CHECK(sum == doctest::Approx(normal_variance_of_variance(count)).epsilon(0.05));
  }
  // One of R differs: deviations (R-1)/R and -1/R, by hand.
  std::vector<double> one(16, 0.0);
  one[5] = 3.0;
  const double p = 15.0 / 16.0, q = 1.0 / 16.0;
  const double second = p * p + 15 * q * q, fourth = std::pow(p, 4) + 15 * std::pow(q, 4);
  CHECK(estimate_mean(one).relative_variance_of_variance ==
        doctest::Approx(fourth / (second * second) - 1.0 / 16.0).epsilon(1e-14));
  // Leaving one out of a mean moves it by a multiple of that one's deviation: the same ratio.
  const std::vector<double> x = numbers(16, 99);
  double total = 0.0;
  for (const double value : x) total += value;
  std::vector<double> left_out;
  for (const double value : x) left_out.push_back((total - value) / 15.0);
  CHECK(estimate_jackknife(total / 16.0, left_out).relative_variance_of_variance ==
        doctest::Approx(estimate_mean(x).relative_variance_of_variance).epsilon(1e-9));
  CHECK(std::isnan(estimate_mean(std::vector<double>(16, 2.0)).relative_variance_of_variance));
}

TEST_CASE("replicates that agree leave open a share of one ray each, and of nothing else") {
  // 16 replicates without an event: 3/16 of one each, over t95 = 2.131 of 15 degrees of freedom.
  CHECK(error_of_agreement(16) == doctest::Approx(3.0 / 16.0 / 2.1314495).epsilon(1e-7));
  const Estimate e = estimate_total(std::vector<double>(16, -5.0), 1000.0);
  CHECK(e.value == -5.0);
  CHECK(e.standard_error == doctest::Approx(5.0 / 1000.0 * 0.0879683).epsilon(1e-5));
  CHECK(e.high - e.value == doctest::Approx(5.0 / 1000.0 * 3.0 / 16.0).epsilon(1e-6));
  CHECK(e.value - e.low == doctest::Approx(e.high - e.value).epsilon(1e-12));
  std::vector<double> rounded(16, 1.0);
  rounded[3] += 1e-12;
  CHECK(estimate_total(rounded, 1000.0).standard_error == doctest::Approx(0.0879683e-3).epsilon(1e-5));
  // One ray more in one replicate is a spread of its own: that ray over 16.
  rounded[3] = 1.0 + 1e-3;
  CHECK(estimate_total(rounded, 1000.0).standard_error == estimate_mean(rounded).standard_error);
  CHECK(estimate_total(rounded, 1000.0).standard_error == doctest::Approx(1e-3 / 16.0).epsilon(1e-9));
  const std::vector<double> zeros(16, 0.0);
  CHECK(estimate_total(zeros, 1000.0).standard_error == 0.0);
  // One ray of 1000 counts as what is solved, else as the most that it may bring.
  CHECK(estimate_total(zeros, 1000.0, 0.0, 5.0).standard_error == doctest::Approx(5.0 * 0.0879683e-3).epsilon(1e-5));
  CHECK(estimate_total(zeros, 1000.0, 2.0, 5.0).standard_error == doctest::Approx(2.0 * 0.0879683e-3).epsilon(1e-5));
  CHECK(estimate_total(std::vector<double>(16, 1.0), 1000.0, 0.0, 5.0).standard_error ==
        doctest::Approx(0.0879683e-3).epsilon(1e-5));
  CHECK(estimate_total(std::vector<double>(16, 2.0), 0.0).standard_error < 1e-15);
}
