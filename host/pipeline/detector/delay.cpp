// SPDX-License-Identifier: Apache-2.0
// The delay camera on the host: its window, moments of delay, bins with their errors and bounds (docs/physics.md,
// sections 1, 4 and 6).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "pipeline/detector/intensity.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"

namespace clray {
namespace {

constexpr double kMetresPerNs = constants::kLightSpeed_m_s / 1e9;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Its blocks, in the order of its row, and its settings (kernels/detector/delay.cl).
enum { kBins, kLargest, kHits };
enum { kSettingBins = 0, kSettingFirst = 1, kSettingPerMetre = 2, kSettingBin = 3, kSettingStride = 3 };

[[noreturn]] void refuse(const RoomContext& x, const char* key, const std::string& what) {
  throw Error(ErrorCode::input, what, member_of(x.scene, x.spec) + "." + key);
}

/// Bins, then first edge (m), bins per metre and width (m) of each connection. The automatic window holds all delays of
/// one bounce and a margin; it is the same for all orientations.
std::vector<double> delay_settings(const RoomContext& x) {
  double bins = detector_value(x.spec, "bins");
  const double asked_bins = bins;
  const double start_ns = detector_value(x.spec, "start_ns"), stop_ns = detector_value(x.spec, "stop_ns");
  const double bin_ps = detector_value(x.spec, "bin_ps");
  const double least = std::ldexp(2.0 * x.geometry.radius, -10);
  std::vector<double> settings{0.0};
  for (std::size_t c = 0; c < x.plan.paths.connections; ++c) {
    const auto [low, high] = x.plan.paths.connection(c);
    const double margin = std::max((high - low) / std::max(1.0, asked_bins - 2.0), least);
    const double first = std::isnan(start_ns) ? low - margin : start_ns * kMetresPerNs;
    const double last = std::isnan(stop_ns) ? high + margin : stop_ns * kMetresPerNs;
    if (!(last > first))
      refuse(x, std::isnan(stop_ns) ? "start_ns" : "stop_ns",
             fmt::format("the delay window is empty: it starts at {:.6g} ns and stops at {:.6g} ns",
                         first / kMetresPerNs, last / kMetresPerNs));
    double bin = (last - first) / asked_bins;
    if (!std::isnan(bin_ps)) {
      bin = bin_ps * 1e-3 * kMetresPerNs;
      const double count = std::ceil((last - first) / bin);
      if (!(count <= 1e7))
        refuse(x, "bin_ps", fmt::format("{} ps makes {:.3g} bins, at most 1e7 expected", bin_ps, count));
      bins = std::max(c == 0 ? 1.0 : bins, count);
    }
    settings.insert(settings.end(), {first, 1.0 / bin, bin});
  }
  settings[kSettingBins] = bins;
  return settings;
}

std::optional<PathBins> delay_path_bins(const std::vector<double>& settings) {
  return PathBins{settings[kSettingFirst], settings[kSettingBin]};
}

/// Mean and width of delay: ratios of pooled sums, errors by jackknife.
void delay_moments(const PassPlan& plan, const SumReader& read, std::size_t v, std::size_t l, std::size_t c,
                   DelayResult* out) {
  double pooled[3] = {};
  for (std::uint64_t k = 0; k < 3; ++k) {
    for (std::uint32_t r = 0; r < plan.request.replicates; ++r)
      pooled[k] += intensity_moment(plan, read, v, l, c, r, k);
  }
  const ViewScales& scales = plan.scales.views[v];
  const double to_s = scales.path_half_m / constants::kLightSpeed_m_s;
  const double middle_s = scales.path_middle_m / constants::kLightSpeed_m_s;
  const auto mean_of = [&](const double* s) { return middle_s + s[1] / s[0] * to_s; };
  const auto width_of = [&](const double* s) {
    const double mean = s[1] / s[0];
    return std::sqrt(std::max(0.0, s[2] / s[0] - mean * mean)) * to_s;
  };
  std::vector<double> means, widths;
  for (std::uint32_t r = 0; r < plan.request.replicates; ++r) {
    double rest[3];
    for (std::uint64_t k = 0; k < 3; ++k) rest[k] = pooled[k] - intensity_moment(plan, read, v, l, c, r, k);
    means.push_back(mean_of(rest));
    widths.push_back(width_of(rest));
  }
  out->mean_delay_s = estimate_jackknife(mean_of(pooled), means);
  out->rms_width_s = estimate_jackknife(width_of(pooled), widths);
  const Estimate& a = out->intensity_m2_per_sr;
  if (a.value == a.exact_part) {
    // Rays that brought no light show no spread. What they may have missed may come at any delay.
    for (Estimate* e : {&out->mean_delay_s, &out->rms_width_s})
      set_error(a.standard_error / a.value * to_s, plan.request.replicates, e);
  }
  if (!plan.request.exact()) return;
  // Moments of tau, within [-1, 1], are off by no more than A is: d(m1/m0) <= 2 dA/A, and the variance by three times
  // that.
  const double off = 2.0 * read.rounding(v, l, c) / pooled[0], width = out->rms_width_s.value / to_s;
  out->mean_delay_s.rounding_bound = off * to_s;
  out->rms_width_s.rounding_bound = std::min(std::sqrt(3.0 * off), 1.5 * off / std::max(width, 1e-300)) * to_s;
}

double largest_weight(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c) {
  float largest = 0.0f;
  for (std::uint32_t r = 0; r < x.plan.request.replicates; ++r) {
    const auto bits = static_cast<std::uint32_t>(x.read.count(x.detector.first_block + kLargest, v, l, c, r, 0));
    float value;
    std::memcpy(&value, &bits, sizeof value);
    largest = std::max(largest, value);
  }
  return largest;
}

/// What rays found in a bin.
struct BinSample {
  double mean = 0.0, spread = 0.0;  // of the replicates, m²/sr; the standard error that they show
  std::uint64_t hits = 0;
  std::uint32_t replicates_hit = 0;
};

BinSample bin_sample(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c, std::uint64_t b) {
  const std::uint32_t replicates = x.plan.request.replicates;
  const double count = replicates;
  const auto sum = [&](std::uint32_t r) { return x.read.value(x.detector.first_block + kBins, v, l, c, r, b); };
  BinSample s;
  double squares = 0.0;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    s.mean += sum(r);
    const std::uint64_t h = x.read.count(x.detector.first_block + kHits, v, l, c, r, b);
    s.hits += h;
    s.replicates_hit += h != 0;
  }
  s.mean /= count;
  if (x.plan.request.exact()) return s;
  for (std::uint32_t r = 0; r < replicates; ++r) squares += (sum(r) - s.mean) * (sum(r) - s.mean);
  s.spread = std::sqrt(squares / (count * (count - 1.0)));
  if (agree(s.mean, s.spread))
    s.spread = s.hits == 0 ? 0.0 : error_of_agreement(replicates) * s.mean * count / static_cast<double>(s.hits);
  return s;
}

/// What the hits of a record bring, m²/sr each: on average, and the most.
struct HitSizes {
  double mean = 0.0, largest = 0.0;
};

HitSizes hit_sizes(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c) {
  if (x.plan.request.exact()) return {};  // no hits, and all bins are known
  const double replicates = x.plan.request.replicates;
  const std::uint64_t hits = hits_of(x.plan, x.read, v, l, c);
  if (hits == 0 && x.read.adds_to(x.detector.first_block + kBins)) {
    // Rays found nothing beside the solved part: what they may have missed is taken for as bright as that.
    const double of_ray =
        solved_intensity(x.plan, x.read, v, l, c) / (static_cast<double>(x.read.points(v)) * replicates);
    return {of_ray, of_ray};
  }
  if (hits == 0) return {0.0, most_intensity(x.plan, v, l, c) / (rays_of(x.read, v) * replicates)};
  const double all = estimate_mean(intensities(x.plan, x.read, v, l, c)).value;
  return {all / static_cast<double>(hits), largest_weight(x, v, l, c) * (x.read.share(v) / replicates)};
}

/// A bin: what is solved, and what rays found beside it.
void add_bin(const RoomResults& x, double solved, const BinSample& s, const HitSizes& hit, DelayResult* out) {
  const std::uint32_t replicates = x.plan.request.replicates;
  const double value = s.mean + solved;
  double error = s.spread;
  bool resolved = x.plan.request.exact() || (s.hits >= 10 && 2 * s.replicates_hit >= replicates);
  const double most = resolved ? 0.0 : poisson_upper95(s.hits);
  if (!resolved && x.read.adds_to(x.detector.first_block + kBins)) {
    // Few hits show no error to be trusted. At 95 % no more than `most` were due, each of the mean size. A bin that is
    // known as well as ten hits know it, since most of it is solved, is resolved.
    const double missed = most - static_cast<double>(s.hits);
    error = std::max(error, missed * hit.mean / student_t95(static_cast<int>(replicates) - 1));
    resolved = error <= std::sqrt(0.1) * value;
  }
  out->bin_m2_per_sr.push_back(value);
  out->bin_standard_error.push_back(error);
  if (!x.plan.request.exact()) out->hits.push_back(s.hits);
  out->resolved.push_back(resolved);
  out->bin_upper_bound.push_back(resolved ? 0.0 : solved + hit.largest * most);
}

void delay_bins(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c, DelayResult* out) {
  const std::uint32_t block = x.detector.first_block + kBins;
  const std::uint64_t bins = x.plan.layout.blocks[block].width - 2;
  const auto solved = [&](std::uint64_t b) { return x.read.solved(block, v, l, c, b); };
  const HitSizes hit = hit_sizes(x, v, l, c);
  for (std::vector<double>* numbers : {&out->bin_m2_per_sr, &out->bin_standard_error, &out->bin_upper_bound})
    numbers->reserve(bins);
  out->hits.reserve(bins);
  out->resolved.reserve(bins);
  for (std::uint64_t b = 1; b <= bins; ++b) add_bin(x, solved(b), bin_sample(x, v, l, c, b), hit, out);
  out->below_m2_per_sr = bin_sample(x, v, l, c, 0).mean + solved(0);
  out->above_m2_per_sr = bin_sample(x, v, l, c, bins + 1).mean + solved(bins + 1);
}

void delay_record(const RoomResults& x, std::size_t v, std::size_t l, std::size_t c) {
  DelayResult d;
  d.key = x.key(v, l, c);
  d.intensity_m2_per_sr = intensity_estimate(x.plan, x.read, v, l, c);
  const double total = d.intensity_m2_per_sr.value;
  if (total > 0.0) {
    delay_moments(x.plan, x.read, v, l, c, &d);
  } else {
    for (Estimate* e : {&d.mean_delay_s, &d.rms_width_s})
      e->value = e->standard_error = e->relative_variance_of_variance = kNan;
  }
  d.first_bin_start_s = x.detector.settings[kSettingFirst + kSettingStride * c] / constants::kLightSpeed_m_s;
  d.bin_width_s = x.detector.settings[kSettingBin + kSettingStride * c] / constants::kLightSpeed_m_s;
  delay_bins(x, v, l, c, &d);
  if (total > 0.0) {
    Diagnostics& g = x.out.diagnostics;
    g.below_window_fraction = std::max(g.below_window_fraction, d.below_m2_per_sr / total);
    g.above_window_fraction = std::max(g.above_window_fraction, d.above_m2_per_sr / total);
  }
  x.note(d.key, total != 0.0);
  x.out.delay.push_back(std::move(d));
}

void delay_results(const RoomResults& x) {
  const SumShape& shape = x.plan.layout.shape;
  for (std::size_t v = 0; v < shape.views; ++v) {
    for (std::size_t l = 0; l < shape.lanes; ++l) {
      for (std::size_t c = 0; c < shape.connections; ++c) delay_record(x, v, l, c);
    }
  }
}

ClrayBinning delay_binning(const PassDetector& detector, std::size_t connection) {
  const double* settings = detector.settings.data() + kSettingStride * connection;
  return {settings[kSettingFirst], settings[kSettingPerMetre], 0,
          static_cast<std::uint64_t>(detector.settings[kSettingBins])};
}

/// A and its moments of delay, from the visible faces: path length is linear over each.
void intensity_solved(const SolvedContext& x, Sums* sums) {
  const SumShape& shape = x.plan.layout.shape;
  const SumBlock& block = x.plan.layout.blocks[x.detector.first_block];
  const ClrayView& view = x.plan.beams.views[x.solved.view];
  const double scale = view.weight_scale / x.plan.beams.area_m2[x.solved.view];
  sums->rounding.resize(shape.views * shape.lanes * shape.connections);
  for (std::size_t l = 0; l < shape.lanes; ++l) {
    Sum moments[3] = {};
    double rounding = 0.0;
    for (std::size_t f = 0; f < x.solved.beam.faces.size(); ++f) {
      const double w = x.solved.weights[f * shape.lanes + l];
      if (w == 0.0) continue;
      const VisibleFace& v = x.solved.visible[f];
      // tau = from + slope·path
      const double from = (x.solved.beam.faces[f].path_m - view.path_middle_m) * view.inv_path_per_m;
      const double slope = view.inv_path_per_m;
      const double first = std::fma(from, v.area_m2, slope * v.path_m3);
      const double second =
          std::fma(from, std::fma(from, v.area_m2, 2.0 * slope * v.path_m3), slope * slope * v.path2_m4);
      const double values[3] = {v.area_m2, first, second};
      for (int k = 0; k < 3; ++k) moments[k] += std::llrint(w * values[k] * scale);
      rounding += w * v.rounding_m2 + 1.0 / scale;
    }
    for (const std::size_t c : x.solved.connections) {
      const std::size_t row = (x.solved.view * shape.lanes + l) * shape.connections + c;
      for (std::uint64_t r = 0; r < shape.replicates; ++r) {
        for (std::size_t k = 0; k < 3; ++k)
          sums->values.add(block.offset + 3 * (row * shape.replicates + r) + k, moments[k] * x.solved.times);
      }
      sums->rounding[row] = rounding;
    }
  }
}

/// The totals of delay and spectrometer for a run's target: A of every connection.
void intensity_targets(const TargetContext& x, std::vector<Target>* targets) {
  const SumShape& shape = x.plan.layout.shape;
  for (std::size_t l = 0; l < shape.lanes; ++l) {
    for (std::size_t c = 0; c < shape.connections; ++c) {
      Target t;
      t.components.push_back(intensities(x.plan, x.read, x.view, l, c));
      t.solved.push_back(solved_intensity(x.plan, x.read, x.view, l, c));
      targets->push_back(std::move(t));
    }
  }
}

}  // namespace

const DetectorRoom kDelayRoom{"delay",       delay_settings, delay_path_bins, nullptr,
                              delay_results, nullptr,        nullptr,         delay_binning};
const DetectorRoom kIntensityRoom{"intensity", nullptr, nullptr, intensity_targets, nullptr, nullptr, intensity_solved};

}  // namespace clray
