// SPDX-License-Identifier: Apache-2.0
// Transmit pulse and convolution; see pulse.hpp.
#include "slr/pulse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "shared/elementary.h"

namespace clray::slr {

namespace {

constexpr int kMostCuts = 64;
constexpr double kMostPulseBins = 1 << 14;
constexpr double kMostProducts = 0x1p31;  // a few seconds
constexpr double kReach = 9.0;            // in sigma; 2e-19 of a Gaussian's energy lies beyond

/// A power that is linear between its points.
using Table = std::vector<std::pair<double, double>>;

void check_table(const Table& table) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::input, what, "station.pulse"); };
  if (table.size() < 2) fail("a table of fewer than two points; expected at least two");
  double area = 0.0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!std::isfinite(table[i].first) || !(table[i].second >= 0.0) || !std::isfinite(table[i].second)) {
      fail(fmt::format("point {}: expected a finite time and a power of 0 or more", i + 1));
    }
    if (i == 0) continue;
    if (!(table[i].first > table[i - 1].first)) fail(fmt::format("point {}: time does not increase", i + 1));
    area += 0.5 * (table[i].first - table[i - 1].first) * (table[i].second + table[i - 1].second);
  }
  if (!(area > 0.0)) fail("the pulse has no energy");
}

/// Area, first and second moment about `origin` (Simpson's rule is exact for cubics).
struct Moments {
  double area = 0.0, first = 0.0, second = 0.0;
};

Moments moments_about(const Table& table, double origin) {
  Moments m;
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double a = table[i - 1].first - origin, b = table[i].first - origin, h = (b - a) / 6.0, x = 0.5 * (a + b);
    const double pa = table[i - 1].second, pb = table[i].second, p = 0.5 * (pa + pb);
    m.area += h * (pa + 4.0 * p + pb);
    m.first += h * (pa * a + 4.0 * p * x + pb * b);
    m.second += h * (pa * a * a + 4.0 * p * x * x + pb * b * b);
  }
  return m;
}

PulseMoments table_moments(const Table& table) {
  const Moments rough = moments_about(table, table.front().first);
  PulseMoments result;
  result.mean_s = table.front().first + rough.first / rough.area;
  const Moments centred = moments_about(table, result.mean_s);
  const double shift = centred.first / centred.area;
  result.mean_s += shift;
  result.variance_s2 = centred.second / centred.area - shift * shift;
  return result;
}

void normalise(std::vector<double>* weight) {
  const double sum = total(*weight);
  for (double& w : *weight) w /= sum;
}

/// A Gaussian on a grid of step 1. With sigma >= 1.5 it is sampled: sum and variance then differ from the integrals by
/// exp(-2 pi^2 sigma^2) < 1e-19 (Poisson's summation formula). A very narrow one becomes three points of its variance.
PulseKernel gaussian_kernel(double sigma_bins) {
  PulseKernel kernel;
  if (sigma_bins <= 0.25) {
    const double side = 0.5 * sigma_bins * sigma_bins;
    kernel.first = -1;
    kernel.weight = {side, 1.0 - 2.0 * side, side};
    return kernel;
  }
  kernel.cuts = std::max(1, static_cast<int>(std::ceil(1.5 / sigma_bins)));
  const double sigma = sigma_bins * kernel.cuts;
  const long reach = static_cast<long>(std::ceil(kReach * sigma));
  kernel.first = -reach;
  for (long k = -reach; k <= reach; ++k) {
    const double x = static_cast<double>(k) / sigma;
    kernel.weight.push_back(el_exp(-0.5 * x * x));
  }
  normalise(&kernel.weight);
  return kernel;
}

/// The table's shares on a grid of step 1, after its times were drawn toward its mean by `squeeze`. Each instant is
/// split linearly between its two neighbours, which keeps sum and mean.
PulseKernel split_table(const Table& table, double step_s, double mean_s, double squeeze) {
  PulseKernel kernel;
  const auto place = [&](double t) { return (mean_s + squeeze * (t - mean_s)) / step_s; };
  kernel.first = static_cast<long>(std::floor(place(table.front().first)));
  kernel.weight.assign(static_cast<std::size_t>(std::floor(place(table.back().first)) - kernel.first) + 2, 0.0);
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double begin = place(table[i - 1].first), end = place(table[i].first), length = end - begin;
    for (double a = begin; a < end;) {
      const double cell = std::floor(a), b = std::min(end, cell + 1.0);
      const auto power = [&](double x) {
        return length > 0.0 ? table[i - 1].second + (table[i].second - table[i - 1].second) * ((x - begin) / length)
                            : table[i].second;
      };
      const double x = 0.5 * (a + b), h = (b - a) / 6.0;
      const double right = h * (power(a) * (a - cell) + 4.0 * power(x) * (x - cell) + power(b) * (b - cell));
      const double all = h * (power(a) + 4.0 * power(x) + power(b));
      const auto k = static_cast<std::size_t>(static_cast<long>(cell) - kernel.first);
      kernel.weight[k] += all - right;
      kernel.weight[k + 1] += right;
      a = b > a ? b : end;
    }
  }
  normalise(&kernel.weight);
  return kernel;
}

/// Variance of the weights about `mean`, in steps of the grid.
double variance_of(const PulseKernel& kernel, double mean) {
  std::vector<double> terms;
  for (std::size_t i = 0; i < kernel.weight.size(); ++i) {
    const double x = static_cast<double>(kernel.first + static_cast<long>(i)) - mean;
    terms.push_back(kernel.weight[i] * x * x);
  }
  return total(terms);
}

/// Splitting widens the pulse a little, so its times are drawn toward its mean until the variance is right.
PulseKernel table_kernel(const Table& table, double width_s) {
  const PulseMoments m = table_moments(table);
  const double sigma_s = std::sqrt(std::max(m.variance_s2, 0.0));
  const int cuts = std::clamp(static_cast<int>(std::ceil(1.5 * width_s / std::max(sigma_s, 1e-300))), 1, kMostCuts);
  const double step_s = width_s / cuts, mean = m.mean_s / step_s, wanted = m.variance_s2 / (step_s * step_s);
  double low = 1e-6, high = 1.0;
  if (variance_of(split_table(table, step_s, m.mean_s, low), mean) < wanted) {
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (variance_of(split_table(table, step_s, m.mean_s, middle), mean) < wanted ? low : high) = middle;
    }
  }
  PulseKernel kernel = split_table(table, step_s, m.mean_s, low);
  kernel.cuts = cuts;
  return kernel;
}

long floor_to(long value, long step) {
  return (value >= 0 ? value / step : -((-value + step - 1) / step)) * step;
}

}  // namespace

double total(const std::vector<double>& mass) {
  double sum = 0.0, lost = 0.0;
  for (const double x : mass) {
    const double next = sum + x;
    lost += std::fabs(sum) >= std::fabs(x) ? (sum - next) + x : (x - next) + sum;
    sum = next;
  }
  return sum + lost;
}

PulseMoments pulse_moments(const Station& station) {
  if (!station.pulse.empty()) {
    check_table(station.pulse);
    return table_moments(station.pulse);
  }
  const double sigma = station.pulse_fwhm_s / kFwhmPerSigma;
  return {0.0, sigma * sigma};
}

PulseKernel pulse_kernel(const Station& station, double width_s) {
  if (!station.pulse.empty()) {
    check_table(station.pulse);
    return table_kernel(station.pulse, width_s);
  }
  if (station.pulse_fwhm_s == 0.0) return {};
  return gaussian_kernel(station.pulse_fwhm_s / kFwhmPerSigma / width_s);
}

Histogram convolve(const Histogram& in, const PulseKernel& kernel) {
  if (kernel.weight.empty()) return in;
  const long cuts = kernel.cuts, bins = static_cast<long>(in.mass.size());
  const long first = floor_to(kernel.first, cuts);
  const long last = -floor_to(-(kernel.first + static_cast<long>(kernel.weight.size())), cuts);
  Histogram out;
  out.width_s = in.width_s / static_cast<double>(cuts);
  const long whole_bins = first / cuts;  // exact: floor_to made `first` a multiple of `cuts`
  out.first_s = in.first_s + static_cast<double>(whole_bins) * in.width_s;
  out.mass.assign(static_cast<std::size_t>(bins * cuts + last - first), 0.0);
  for (long bin = 0; bin < bins; ++bin) {
    const double part = in.mass[static_cast<std::size_t>(bin)] / static_cast<double>(cuts);
    if (part == 0.0) continue;
    for (long cut = 0; cut < cuts; ++cut) {
      double* target = out.mass.data() + (bin * cuts + cut + kernel.first - first);
      for (std::size_t k = 0; k < kernel.weight.size(); ++k) target[k] = std::fma(part, kernel.weight[k], target[k]);
    }
  }
  return out;
}

Histogram smear(const Histogram& in, const Station& station) {
  const double length_s = station.pulse.empty() ? 2.0 * kReach * station.pulse_fwhm_s / kFwhmPerSigma
                                                : station.pulse.back().first - station.pulse.front().first;
  const double bins = length_s / in.width_s;  // of the pulse
  const double products = bins * static_cast<double>(in.mass.size());
  const auto factor =
      static_cast<std::size_t>(std::ceil(std::max({1.0, bins / kMostPulseBins, std::sqrt(products / kMostProducts)})));
  if (factor == 1) return convolve(in, pulse_kernel(station, in.width_s));
  Histogram merged{in.first_s, in.width_s * static_cast<double>(factor), {}};
  merged.mass.assign((in.mass.size() + factor - 1) / factor, 0.0);
  for (std::size_t i = 0; i < in.mass.size(); ++i) merged.mass[i / factor] += in.mass[i];
  return convolve(merged, pulse_kernel(station, merged.width_s));
}

}  // namespace clray::slr
