// SPDX-License-Identifier: Apache-2.0
// See normal_points.hpp. The trend is a sum of Legendre polynomials over the session, found by normal equations, which
// are well conditioned for so few of them.
#include "slr/normal_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace clray::slr {

namespace {

constexpr std::size_t kMostDegree = 8;
constexpr std::size_t kPerTerm = 10;      // observations for each term of the trend
constexpr double kReject = 2.5;           // times the rms: of single photons (Sinclair 1997)
constexpr double kFirstWindow = 3.0;      // times the scatter about the median
constexpr double kScatterOfMad = 1.4826;  // of a normal distribution
constexpr double kLeast_ns = 1e-6;        // below it residuals are alike
constexpr int kMostRounds = 100;

using Terms = std::array<double, kMostDegree + 1>;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Legendre polynomials of x in [-1, 1] (Bonnet's recursion).
Terms legendre(double x) {
  Terms p{};
  p[0] = 1.0;
  p[1] = x;
  for (std::size_t n = 1; n < kMostDegree; ++n) {
    const auto k = static_cast<double>(n);
    p[n + 1] = ((2.0 * k + 1.0) * x * p[n] - k * p[n - 1]) / (k + 1.0);
  }
  return p;
}

/// Solves the normal equations by Cholesky's factors. Terms that the data do not tell apart from those before are zero.
Terms solve(std::array<Terms, kMostDegree + 1> a, Terms b, std::size_t terms) {
  std::array<bool, kMostDegree + 1> used{};
  for (std::size_t i = 0; i < terms; ++i) {
    const double before = a[i][i];
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = j < i ? (used[j] ? sum / a[j][j] : 0.0) : sum;
    }
    used[i] = a[i][i] > 1e-10 * before;
    a[i][i] = used[i] ? std::sqrt(a[i][i]) : 1.0;
  }
  Terms y{}, x{};
  for (std::size_t i = 0; i < terms; ++i) {
    double sum = b[i];
    for (std::size_t k = 0; k < i; ++k) sum -= a[i][k] * y[k];
    y[i] = used[i] ? sum / a[i][i] : 0.0;
  }
  for (std::size_t i = terms; i-- > 0;) {
    double sum = y[i];
    for (std::size_t k = i + 1; k < terms; ++k) sum -= a[k][i] * x[k];
    x[i] = used[i] ? sum / a[i][i] : 0.0;
  }
  return x;
}

/// Residuals with their times, and the trend that is taken from them.
class Screening {
 public:
  explicit Screening(const std::vector<Observation>& observations) : observations_(observations) {
    const Epoch& first = observations.front().epoch;
    const double half = 0.5 * seconds_between(first, observations.back().epoch);
    x_.reserve(observations.size());
    for (const Observation& o : observations)
      x_.push_back(half > 0.0 ? seconds_between(first, o.epoch) / half - 1.0 : 0.0);
    residual_ns_.resize(observations.size());
    open_first_window();
  }

  /// Fits and rejects until nothing changes.
  void run() {
    for (int round = 0; round < kMostRounds; ++round) {
      fit();
      const double limit = std::max(kReject * rms_ns(), kLeast_ns);
      bool changed = false;
      std::vector<char> next(accepted_.size());
      for (std::size_t i = 0; i < next.size(); ++i) {
        next[i] = std::fabs(residual_ns_[i]) <= limit;
        changed = changed || next[i] != accepted_[i];
      }
      if (!changed) return;
      accepted_ = std::move(next);
    }
    fit();
  }

  bool accepted(std::size_t i) const { return accepted_[i] != 0; }
  /// To the trend.
  double residual_ns(std::size_t i) const { return residual_ns_[i]; }

 private:
  void open_first_window() {
    std::vector<double> values;
    for (const Observation& o : observations_) values.push_back(o.residual_ns);
    const double middle = median(values);
    for (double& v : values) v = std::fabs(v - middle);
    const double window = kFirstWindow * kScatterOfMad * median(values);
    for (const double v : values) accepted_.push_back(v <= std::max(window, kLeast_ns));
  }

  void fit() {
    const auto count = static_cast<std::size_t>(std::count(accepted_.begin(), accepted_.end(), 1));
    const std::size_t terms = std::clamp<std::size_t>(count / kPerTerm, 1, kMostDegree + 1);
    std::array<Terms, kMostDegree + 1> a{};
    Terms b{};
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (!accepted_[i]) continue;
      const Terms p = legendre(x_[i]);
      for (std::size_t j = 0; j < terms; ++j) {
        for (std::size_t k = 0; k <= j; ++k) a[j][k] += p[j] * p[k];
        b[j] += p[j] * observations_[i].residual_ns;
      }
    }
    const Terms trend = solve(a, b, terms);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Terms p = legendre(x_[i]);
      double sum = 0.0;
      for (std::size_t j = 0; j < terms; ++j) sum += trend[j] * p[j];
      residual_ns_[i] = observations_[i].residual_ns - sum;
    }
  }

  double rms_ns() const {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < accepted_.size(); ++i) {
      if (!accepted_[i]) continue;
      sum += residual_ns_[i] * residual_ns_[i];
      count += 1.0;
    }
    return std::sqrt(sum / count);
  }

  const std::vector<Observation>& observations_;
  std::vector<double> x_, residual_ns_;
  std::vector<char> accepted_;
};

/// Moments of residuals about their mean, which is handed back.
ResidualStatistics statistics_of(const std::vector<double>& residuals_ns, double* mean_ns) {
  ResidualStatistics s;
  s.count = residuals_ns.size();
  const auto count = static_cast<double>(s.count);
  double mean = 0.0, second = 0.0, third = 0.0, fourth = 0.0;
  for (const double r : residuals_ns) mean += r / count;
  for (const double r : residuals_ns) {
    const double d = r - mean;
    second += d * d / count;
    third += d * d * d / count;
    fourth += d * d * d * d / count;
  }
  const double rms = std::sqrt(second);
  s.rms_ps = rms * 1e3;
  s.skewness = s.kurtosis = std::numeric_limits<double>::quiet_NaN();
  if (s.count > 2 && rms > 0.0) {
    s.skewness = third / (second * rms);
    s.kurtosis = fourth / (second * second) - 3.0;
  }
  *mean_ns = mean;
  return s;
}

/// One bin's accepted observations, by their places.
NormalPoint point_of(const std::vector<Observation>& observations, const Screening& screening,
                     const std::vector<std::size_t>& members) {
  std::vector<double> residuals;
  double mean_s = 0.0, mean_ns = 0.0;
  const Epoch& first = observations[members.front()].epoch;
  for (const std::size_t i : members) {
    residuals.push_back(screening.residual_ns(i));
    mean_s += seconds_between(first, observations[i].epoch) / static_cast<double>(members.size());
  }
  NormalPoint point;
  point.bin = statistics_of(residuals, &mean_ns);
  const auto distance = [&](std::size_t i) {
    return std::fabs(seconds_between(first, observations[i].epoch) - mean_s);
  };
  const std::size_t nearest = *std::min_element(
      members.begin(), members.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  point.shot = observations[nearest].shot;
  point.epoch = observations[nearest].epoch;
  point.flight_ps = observations[nearest].flight_ps + std::llround((mean_ns - screening.residual_ns(nearest)) * 1e3);
  return point;
}

/// The day and the bin of the day.
std::pair<std::int64_t, double> bin_of(const Epoch& epoch, double window_s) {
  return {epoch.mjd, std::floor(static_cast<double>(epoch.ps) / 1e12 / window_s)};
}

}  // namespace

NormalPoints normal_points(const std::vector<Observation>& observations, double window_s) {
  NormalPoints result;
  if (observations.empty()) return result;
  Screening screening(observations);
  screening.run();
  std::vector<double> all;
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!screening.accepted(i)) continue;
    if (!members.empty() &&
        bin_of(observations[members.front()].epoch, window_s) != bin_of(observations[i].epoch, window_s)) {
      result.points.push_back(point_of(observations, screening, members));
      members.clear();
    }
    members.push_back(i);
    all.push_back(screening.residual_ns(i));
  }
  if (!members.empty()) result.points.push_back(point_of(observations, screening, members));
  double mean_ns = 0.0;
  result.session = statistics_of(all, &mean_ns);
  return result;
}

}  // namespace clray::slr
