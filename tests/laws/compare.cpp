// SPDX-License-Identifier: Apache-2.0
// See compare.hpp.
#include "laws/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace clray_test {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9, kNoError = 1e-7;  // of a record's scale
constexpr double kDoubt = 4.0;  // of the normal variance of the variance: 1 of 2000 normal samples of 16 lies above
constexpr double kMostT = 6.0;  // a larger t enters χ² as this: heavy tails of t, and faults, which the tests name

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)) || a == b;
}

bool same_ends(const Record& a, const Record& b) {
  const double slack = 1e-6 * std::max(a.high - a.low, b.high - b.low);
  return std::fabs(a.low - b.low) <= slack && std::fabs(a.high - b.high) <= slack;
}

/// Whether the pair says anything at all.
bool comparable(const Record& a, const Record& b) {
  if (a.kind == "bin" && !same_ends(a, b)) return false;
  if (a.kind == "moment" || a.kind == "power") {
    if (std::isnan(a.value) || std::isnan(b.value)) return false;
  }
  return a.resolved && b.resolved;
}

double t_of(double difference, const Record& a, const Record& b) {
  if (!std::isfinite(difference)) return kInfinite;
  const double scale = std::max(std::fabs(a.scale), std::fabs(b.scale)), off = std::fabs(difference);
  if (a.error == 0.0 && b.error == 0.0) return off <= kNoError * scale ? 0.0 : kInfinite;
  const double rounding = kRounding * scale;
  return off / std::sqrt(a.error * a.error + b.error * b.error + rounding * rounding);
}

}  // namespace

double student_tail(double t) {
  // Abramowitz & Stegun 26.7.4 gives P(|T| < t); its complement loses what lies below 1e-15.
  if (!std::isfinite(t)) return 0.0;
  constexpr int kFreedom = 15;
  const double theta = std::atan(t / std::sqrt(kFreedom)), c = std::cos(theta), s = std::sin(theta);
  double term = c, sum = c;
  for (int k = 3; k <= kFreedom - 2; k += 2) {
    term *= c * c * (k - 1.0) / k;
    sum += term;
  }
  return std::max(0.0, 1.0 - 2.0 / 3.14159265358979323846 * (theta + s * sum));
}

double student_limit(double probability) {
  double low = 0.0, high = 100.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (student_tail(middle) > probability ? low : high) = middle;
  }
  return high;
}

std::vector<Comparison> compare_records(const Records& first, const Records& second) {
  std::vector<Comparison> all;
  for (const auto& [name, b] : second) {
    Comparison c;
    c.name = name;
    c.second = b;
    const auto there = first.find(name);
    if (there == first.end()) {
      if (b.kind == "bin") continue;
      c.first.value = c.first.error = std::numeric_limits<double>::quiet_NaN();
      c.t = kInfinite;
      all.push_back(c);
      continue;
    }
    c.first = there->second;
    if (!comparable(c.first, b)) continue;
    c.counts = c.first.doubt <= kDoubt && b.doubt <= kDoubt;
    if (b.kind == "balance") {
      const Record none{0.0, 0.0, b.scale, 0.0, true, b.kind, 0.0, 0.0};
      c.t = std::max(t_of(b.value, b, none), t_of(c.first.value, c.first, none));
    } else {
      c.t = t_of(c.first.value - b.value, c.first, b);
    }
    all.push_back(c);
  }
  return all;
}

std::vector<std::string> different_bits(const Records& first, const Records& second) {
  std::vector<std::string> names;
  for (const auto& [name, b] : second) {
    const auto a = first.find(name);
    if (a == first.end() || !same_bits(a->second.value, b.value) || !same_bits(a->second.error, b.error))
      names.push_back(name);
  }
  return names;
}

void ChiSquare::add_scene(const std::vector<Comparison>& comparisons) {
  std::map<std::string, std::pair<double, double>> here;
  for (const Comparison& c : comparisons) {
    const bool sampled = c.first.error > 0.0 && c.second.error > 0.0;
    if (!c.counts || !sampled || !std::isfinite(c.t) || c.second.kind == "balance" || c.second.kind == "cover")
      continue;
    const double t = std::min(c.t, kMostT);
    here[c.second.kind].first += t * t;
    here[c.second.kind].second += 1.0;
  }
  for (const auto& [kind, sum] : here) sums_[kind].push_back(sum);
}

std::map<std::string, ChiSquare::Mean> ChiSquare::means() const {
  std::map<std::string, Mean> all;
  for (const auto& [kind, scenes] : sums_) {
    Mean m;
    m.scenes = static_cast<int>(scenes.size());
    for (const auto& [sum, count] : scenes) m.mean += sum, m.records += count;
    m.mean /= m.records;
    // A ratio of sums over scenes: its error from the scenes' residuals.
    double squares = 0.0;
    for (const auto& [sum, count] : scenes) squares += std::pow(sum - m.mean * count, 2);
    m.error = m.scenes > 1 ? std::sqrt(squares * m.scenes / (m.scenes - 1.0)) / m.records : kInfinite;
    all[kind] = m;
  }
  return all;
}

}  // namespace clray_test
