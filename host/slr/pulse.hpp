// SPDX-License-Identifier: Apache-2.0
// The transmit pulse and its convolution with a delay histogram. A histogram is a density constant over each bin, so
// its variance is that of masses at bin centres plus width^2/12. Times in s.
#pragma once

#include <cstddef>
#include <vector>

#include "clray/scene.hpp"

namespace clray::slr {

inline constexpr double kFwhmPerSigma = 2.3548200450309493;  ///< of a Gaussian: 2 sqrt(2 ln 2)

/// Masses in bins of equal width, the first of which starts at first_s.
struct Histogram {
  double first_s = 0.0, width_s = 0.0;
  std::vector<double> mass;
};

/// A pulse sampled on the grid of a histogram whose bins are cut into `cuts` parts.
struct PulseKernel {
  int cuts = 1;
  long first = 0;              ///< shift of weight[0], in parts of a bin
  std::vector<double> weight;  ///< sums to 1; empty: a delta, nothing to do
};

/// The station's pulse (delta, Gaussian or table) on bins of that width. Sum 1 and mean are exact to rounding, and so
/// is the variance, except for a table narrower than 1/40 of a bin (then off by at most (width/128)^2).
/// Throws Error(input) for a table that is no pulse.
PulseKernel pulse_kernel(const Station& station, double width_s);

/// Mean and variance of the station's pulse, s and s^2.
struct PulseMoments {
  double mean_s = 0.0, variance_s2 = 0.0;
};
PulseMoments pulse_moments(const Station& station);

/// The histogram convolved with the pulse. Its bins are finer by kernel.cuts, and it is longer by whole old bins at
/// both ends. A delta changes no bit.
Histogram convolve(const Histogram& histogram, const PulseKernel& kernel);

/// The histogram convolved with the station's pulse. Where that would take more than 2^31 products, or a pulse of more
/// than 2^14 bins, neighbouring bins are merged first: the pulse then still spans hundreds of them.
Histogram smear(const Histogram& histogram, const Station& station);

/// Sum of a histogram's masses, compensated (Neumaier 1974).
double total(const std::vector<double>& mass);

}  // namespace clray::slr
