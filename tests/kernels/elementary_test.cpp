// SPDX-License-Identifier: Apache-2.0
// kernels/shared/elementary.h against the C library's long double functions (64-bit mantissa: 2^-11 ulp of fp64),
// over dense, random and edge arguments. Limits are in ulp of the exact value (of the smallest normal below it),
// as the header of elementary.h states them.
#include "shared/elementary.h"

#include <cfloat>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "doctest/doctest.h"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 4.9406564584124654e-324;

double ulp_error(double got, long double exact) {
  if (std::isnan(got) && std::isnan(exact)) return 0.0;
  if (std::isinf(static_cast<double>(exact))) {
    if (got == static_cast<double>(exact)) return 0.0;
    // An exact value that rounds to infinity: the largest finite number is one ulp away.
    return std::fabs(got) >= DBL_MAX && std::signbit(got) == std::signbit(static_cast<double>(exact)) ? 1.0 : kInf;
  }
  if (!std::isfinite(got)) return kInf;
  int exponent = 0;
  std::frexp(static_cast<double>(exact), &exponent);
  if (exact == 0.0L) exponent = -1021;
  const long double ulp = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::fabs((static_cast<long double>(got) - exact) / ulp));
}

std::vector<double> arguments(double low, double high, int dense) {
  std::vector<double> x;
  for (int i = 0; i <= dense; ++i) x.push_back(low + (high - low) * i / dense);
  std::mt19937_64 random(12345);
  std::uniform_real_distribution<double> uniform(low, high), exponent(-1074.0, 1024.0);
  for (int i = 0; i < dense; ++i) {
    x.push_back(uniform(random));
    const double magnitude = std::exp2(exponent(random));
    if (magnitude >= low && magnitude <= high) x.push_back(magnitude);
    if (-magnitude >= low && -magnitude <= high) x.push_back(-magnitude);
  }
  for (double edge : {0.0, kTiny, DBL_MIN, 1e-17, 5e-17, 1e-8, 0.25, 0.29, 0.34657359, 0.41, 0.5, 0.70710678118654757,
                      1.0, 1.4142135623730951, 2.0, 709.78271289338397, 745.13321910194111, 1e300, DBL_MAX}) {
    for (double e : {edge, -edge})
      for (double near : {e, std::nextafter(e, kInf), std::nextafter(e, -kInf)})
        if (near >= low && near <= high) x.push_back(near);
  }
  return x;
}

template <class Own, class Exact>
double worst(const std::vector<double>& arguments, Own own, Exact exact) {
  double worst_ulp = 0.0, at = 0.0;
  for (double x : arguments) {
    const double error = ulp_error(own(x), exact(static_cast<long double>(x)));
    if (error > worst_ulp) {
      worst_ulp = error;
      at = x;
    }
  }
  MESSAGE("worst " << worst_ulp << " ulp at " << at << " of " << arguments.size());
  return worst_ulp;
}

double own_sin(double x) {
  double s, c;
  el_sincos(x, &s, &c);
  return s;
}
double own_cos(double x) {
  double s, c;
  el_sincos(x, &s, &c);
  return c;
}

}  // namespace

TEST_CASE("exp and expm1") {
  CHECK(worst(arguments(-746.0, 710.0, 1000000), el_exp, [](long double x) { return std::exp(x); }) < 1.0);
  CHECK(worst(arguments(-1.0, 1.0, 1000000), el_exp, [](long double x) { return std::exp(x); }) < 1.0);
  CHECK(worst(arguments(-746.0, 710.0, 300000), el_expm1, [](long double x) { return std::expm1(x); }) < 2.0);
  CHECK(worst(arguments(-2.0, 2.0, 1000000), el_expm1, [](long double x) { return std::expm1(x); }) < 2.0);
  CHECK(el_exp(0.0) == 1.0);
  CHECK(el_exp(-kInf) == 0.0);
  CHECK(el_exp(kInf) == kInf);
  CHECK(el_exp(-1e308) == 0.0);
  CHECK(std::isnan(el_exp(kNan)));
  CHECK(el_expm1(-kInf) == -1.0);
  CHECK(el_expm1(kInf) == kInf);
  CHECK(std::isnan(el_expm1(kNan)));
  CHECK(std::signbit(el_expm1(-0.0)));
}

TEST_CASE("log and log1p") {
  CHECK(worst(arguments(0.0, DBL_MAX, 1000000), el_log, [](long double x) { return std::log(x); }) < 1.0);
  CHECK(worst(arguments(0.5, 2.0, 1000000), el_log, [](long double x) { return std::log(x); }) < 1.0);
  CHECK(worst(arguments(-1.0, DBL_MAX, 300000), el_log1p, [](long double x) { return std::log1p(x); }) < 2.0);
  CHECK(worst(arguments(-1.0, 2.0, 1000000), el_log1p, [](long double x) { return std::log1p(x); }) < 2.0);
  CHECK(el_log(1.0) == 0.0);
  CHECK(el_log(0.0) == -kInf);
  CHECK(el_log(kInf) == kInf);
  CHECK(std::isnan(el_log(-kTiny)));
  CHECK(std::isnan(el_log(-kInf)));
  CHECK(std::isnan(el_log(kNan)));
  CHECK(el_log1p(-1.0) == -kInf);
  CHECK(el_log1p(kInf) == kInf);
  CHECK(std::isnan(el_log1p(-1.5)));
  CHECK(std::isnan(el_log1p(-kInf)));
  CHECK(std::isnan(el_log1p(kNan)));
}

TEST_CASE("pow") {
  // The result is kept far from denormals: long double pow is exact to 2^-63 there.
  std::mt19937_64 random(777);
  std::uniform_real_distribution<double> log_x(-700.0, 700.0), log_result(-744.0, 709.7), near_one(-1e-3, 1e-3);
  double worst_ulp = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double x = i % 2 ? std::exp(log_x(random)) : 1.0 + near_one(random);
    const double y = log_result(random) / std::log(x);
    if (!std::isfinite(y)) continue;
    const long double exact = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    worst_ulp = std::max(worst_ulp, ulp_error(el_pow(x, y), exact));
  }
  MESSAGE("worst " << worst_ulp << " ulp");
  CHECK(worst_ulp < 2.0);
  CHECK(el_pow(0.0, 0.0) == 1.0);
  CHECK(el_pow(0.0, 2.0) == 0.0);
  CHECK(el_pow(0.0, -2.0) == kInf);
  CHECK(el_pow(kInf, 0.5) == kInf);
  CHECK(el_pow(kInf, -0.5) == 0.0);
  CHECK(el_pow(0.5, kInf) == 0.0);
  CHECK(el_pow(2.0, kInf) == kInf);
  CHECK(el_pow(0.5, -kInf) == kInf);
  CHECK(el_pow(1.0, kNan) == 1.0);
  CHECK(el_pow(3.0, 4.0) == 81.0);
  CHECK(el_pow(kTiny, 1.0) == kTiny);
  CHECK(el_pow(DBL_MAX, 1.0) == DBL_MAX);
  CHECK(std::isnan(el_pow(-1.0, 2.0)));
  CHECK(std::isnan(el_pow(kNan, 2.0)));
  CHECK(std::isnan(el_pow(2.0, kNan)));
}

TEST_CASE("sine and cosine") {
  const auto sin_l = [](long double x) { return std::sin(x); };
  const auto cos_l = [](long double x) { return std::cos(x); };
  for (double limit : {1.0, 10.0, 1048576.0}) {
    const std::vector<double> x = arguments(-limit, limit, 1000000);
    CHECK(worst(x, own_sin, sin_l) < 1.0);
    CHECK(worst(x, own_cos, cos_l) < 1.0);
  }
  // The doubles nearest to multiples of pi/2: cancellation is worst there.
  std::vector<double> near;
  for (int k = 1; k <= 667544; ++k) near.push_back(static_cast<double>(k * 1.57079632679489661923132169163975144L));
  CHECK(worst(near, own_sin, sin_l) < 1.0);
  CHECK(worst(near, own_cos, cos_l) < 1.0);
  for (double x : arguments(-1073741824.0, 1073741824.0, 100000)) {
    REQUIRE(std::fabs(own_sin(x) - std::sin(static_cast<long double>(x))) < 4e-16L);
    REQUIRE(std::fabs(own_cos(x) - std::cos(static_cast<long double>(x))) < 4e-16L);
  }
  CHECK(std::signbit(own_sin(-0.0)));
  CHECK(own_cos(0.0) == 1.0);
  for (double x : {kInf, -kInf, kNan, 1.1e9}) {
    CHECK(std::isnan(own_sin(x)));
    CHECK(std::isnan(own_cos(x)));
  }
}

TEST_CASE("atan2 and acos") {
  std::mt19937_64 random(99);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), exponent(-1074.0, 1024.0);
  double worst_ulp = 0.0;
  for (int i = 0; i < 2000000; ++i) {
    const double spread = i % 2 ? 1.0 : 0.0;
    const double y = uniform(random) * std::exp2(spread * exponent(random));
    const double x = uniform(random) * std::exp2(spread * exponent(random));
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    worst_ulp = std::max(worst_ulp, ulp_error(el_atan2(y, x), exact));
  }
  MESSAGE("atan2: worst " << worst_ulp << " ulp");
  CHECK(worst_ulp < 2.0);
  for (double y : {0.0, -0.0, kTiny, -kTiny, 1.0, -1.0, DBL_MAX, kInf, -kInf})
    for (double x : {0.0, -0.0, kTiny, -kTiny, 1.0, -1.0, -DBL_MAX, kInf, -kInf}) {
      CAPTURE(y);
      CAPTURE(x);
      const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
      CHECK(ulp_error(el_atan2(y, x), exact) < 2.0);
      CHECK(std::signbit(el_atan2(y, x)) == std::signbit(exact));
    }
  CHECK(std::isnan(el_atan2(kNan, 1.0)));
  CHECK(std::isnan(el_atan2(1.0, kNan)));

  std::vector<double> x = arguments(-1.0, 1.0, 1000000);
  for (int i = 1; i < 1000; ++i) {
    x.push_back(1.0 - i * 0x1p-53);
    x.push_back(-1.0 + i * 0x1p-53);
  }
  CHECK(worst(x, el_acos, [](long double v) { return std::acos(v); }) < 3.0);
  CHECK(std::isnan(el_acos(1.0000000000000002)));
  CHECK(std::isnan(el_acos(-kInf)));
  CHECK(std::isnan(el_acos(kNan)));
}

TEST_CASE("cosine-weighted directions have the mean cosine 2/3 and unit length") {
  // A midpoint grid of n x n points integrates sqrt(1 - u) to n^-3/2.
  const int n = 512;
  double sum = 0.0, sum_x2 = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const vec3 d = sample_cosine_hemisphere((i + 0.5) / n, (j + 0.5) / n);
      REQUIRE(std::fabs(v3_length(d) - 1.0) < 4e-16);
      REQUIRE(d.z > 0.0);
      sum += d.z;
      sum_x2 += d.x * d.x;
    }
  CHECK(std::fabs(sum / (n * n) - 2.0 / 3.0) < 1e-4);
  CHECK(std::fabs(sum_x2 / (n * n) - 0.25) < 1e-12);
}
