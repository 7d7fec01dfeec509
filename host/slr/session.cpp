// SPDX-License-Identifier: Apache-2.0
// Shots over a pass; see session.hpp. Each block of shots lies within one orientation, that at its step's start.
#include "slr/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "clray/error.hpp"
#include "device/shots.hpp"
#include "shared/photon.h"
#include "slr/link.hpp"

namespace clray::slr {

namespace {

constexpr std::uint32_t kBlock = 1u << 17;
constexpr double kFwhmPerSigma = 2.3548200450309493;
constexpr double kMostShots = 1e12;

[[noreturn]] void refuse(const std::string& what, const std::string& key) {
  throw Error(ErrorCode::input, what, key);
}

bool from_source(const Scene& scene, const ResultKey& key) {
  if (scene.observers.empty()) return true;
  return std::any_of(scene.observers.begin(), scene.observers.end(), [&](const Observer& o) {
    return o.monostatic && (key.observer.empty() || o.name == key.observer);
  });
}

bool same_group(const ResultKey& a, const ResultKey& b) {
  return a.detector == b.detector && a.observer == b.observer && a.variant == b.variant && a.band == b.band;
}

const DelayResult* first_of_group(const Result& result, const Scene& scene, const SessionOptions& options) {
  for (const DelayResult& d : result.delay) {
    const auto fits = [](const std::string& wanted, const std::string& name) {
      return wanted.empty() || wanted == name;
    };
    if (fits(options.detector, d.key.detector) && fits(options.observer, d.key.observer) &&
        fits(options.variant, d.key.variant) && from_source(scene, d.key)) {
      return &d;
    }
  }
  refuse("a session needs a delay result seen from the source; there is none of that name", "station");
}

const Station& station_of(const Scene& scene) {
  if (!scene.station) refuse("a session needs a [station]", "station");
  if (!scene.motion) refuse("a session needs a [motion]", "motion");
  if (scene.source.kind != Source::Kind::laser) refuse("a session needs kind = \"laser\"", "source.kind");
  check_station(*scene.station, scene.source.wavelength_nm);
  return *scene.station;
}

std::uint64_t count_shots(double duration_s, double rate_Hz) {
  const double shots = duration_s * rate_Hz;
  if (!(shots < kMostShots))
    refuse(fmt::format("{:.3g} shots; expected fewer than {:.0e}", shots, kMostShots), "station");
  // A pass of 20 s at 2000 Hz has 40000 shots although 19.999999 would round down.
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::floor(shots + 1e-6)));
}

}  // namespace

/// Shots of a block: distances (one, where they are fixed) and results.
struct Session::Block {
  std::vector<double> range_m, brightness;
  Shots shots;

  double range(std::uint32_t i) const { return range_m.size() == 1 ? range_m[0] : range_m[i]; }
  double light(std::uint32_t i) const { return brightness.size() == 1 ? brightness[0] : brightness[i]; }
};

Session::Session(const Result& result, const Scene& scene, const SessionOptions& options)
    : station_(station_of(scene)), options_(options), wavelength_nm_(scene.source.wavelength_nm), ranges_(station_) {
  const DelayResult* first = first_of_group(result, scene, options);
  delays_.assign(std::max<std::size_t>(result.orientations.size(), 1), nullptr);
  for (const DelayResult& d : result.delay) {
    if (same_group(d.key, first->key) && d.key.orientation < delays_.size()) delays_[d.key.orientation] = &d;
  }
  for (std::size_t i = 0; i < delays_.size(); ++i) {
    if (!delays_[i]) refuse(fmt::format("orientation {} has no delay result", i), "motion");
    times_s_.push_back(result.orientations.empty() ? 0.0 : result.orientations[i].time_s);
  }
  start_s_ = times_s_.front();
  const double stop = scene.motion->stop_s > start_s_ ? scene.motion->stop_s : times_s_.back();
  shots_ = count_shots(stop - start_s_, station_.rate_Hz);
  settings_.noise_per_ns = station_.noise_per_ns + station_.dark_per_ns;
  settings_.jitter_ns = station_.jitter_fwhm_s / kFwhmPerSigma * 1e9;
  settings_.seed = result.seed;
  settings_.threads = options.threads;
  // A gate of a later shot may come earlier by the change of range: at most 1e-4 of a period below 15 km/s.
  in_order_ = station_.dead_time_s > 0.0 && station_.dead_time_s > (1.0 - 1e-4) / station_.rate_Hz - station_.gate_s;
  gate_of(*delays_.front());
  start_range_m_ = ranges_.range_m(start_s_);
  start_brightness_ = 4.0 * kPi * link_budget(station_, wavelength_nm_, start_range_m_).photons_per_m2;
  ranges_.range_m(stop_s());
}

double Session::time_s(std::uint64_t shot) const {
  return static_cast<double>(time_ps(shot)) * 1e-12;
}

std::int64_t Session::time_ps(std::uint64_t shot) const {
  const double k = static_cast<double>(shot), rate = station_.rate_Hz;
  const double seconds = std::floor(k / rate);
  const double rest = std::fma(-seconds, rate, k) / rate;
  const double start = std::floor(start_s_);
  return static_cast<std::int64_t>(start + seconds) * kPicosecondsPerSecond +
         static_cast<std::int64_t>(std::llround((start_s_ - start) * 1e12)) +
         static_cast<std::int64_t>(std::llround(rest * 1e12));
}

double Session::stop_s() const {
  return time_s(shots_ - 1);
}

/// The first shot fired at that time or later.
std::uint64_t Session::first_shot_at(double time) const {
  const double estimate = std::floor((time - start_s_) * station_.rate_Hz) - 2.0;
  auto shot = estimate > 0.0 ? static_cast<std::uint64_t>(estimate) : 0;
  while (shot < shots_ && time_s(shot) < time - 1e-12) ++shot;
  return shot;
}

Gate Session::gate_of(const DelayResult& delay) const {
  if (!(station_.gate_s >= delay.bin_width_s))
    make_gate({delay.first_bin_start_s, delay.bin_width_s, {}}, station_.gate_s);
  const Histogram histogram{delay.first_bin_start_s, delay.bin_width_s, delay.bin_m2_per_sr};
  return make_gate(convolve(histogram, pulse_kernel(station_, delay.bin_width_s)), station_.gate_s);
}

std::pair<double, double> Session::signal_window_ns() const {
  double low = 1e300, high = -1e300;
  for (const DelayResult* d : delays_) {
    for (std::size_t i = 0; i < d->bin_m2_per_sr.size(); ++i) {
      if (!(d->bin_m2_per_sr[i] > 0.0)) continue;
      low = std::min(low, d->first_bin_start_s + static_cast<double>(i) * d->bin_width_s);
      high = std::max(high, d->first_bin_start_s + static_cast<double>(i + 1) * d->bin_width_s);
    }
  }
  if (!(low < high)) return {0.0, 0.0};
  const PulseMoments pulse = pulse_moments(station_);
  const double spread = 3.0 * std::sqrt(pulse.variance_s2 + settings_.jitter_ns * settings_.jitter_ns * 1e-18);
  return {(low + pulse.mean_s - spread) * 1e9, (high + pulse.mean_s + spread) * 1e9};
}

double Session::mean_cross_section_m2() const {
  double sum = 0.0;
  for (const DelayResult* d : delays_) sum += 4.0 * kPi * d->intensity_m2_per_sr.value;
  return sum / static_cast<double>(delays_.size());
}

void Session::set_ranges(std::uint64_t first, std::uint32_t count, Block* block) const {
  const std::uint32_t size = ranges_.fixed() ? 1 : count;
  block->range_m.resize(size);
  block->brightness.resize(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    block->range_m[i] = ranges_.range_m(time_s(first + i));
    const double nearer = start_range_m_ / block->range_m[i], squared = nearer * nearer;
    block->brightness[i] = start_brightness_ * (squared * squared);
  }
}

/// Shots that depend on the ones before: a detector that has not recovered from its last photon misses the gate's
/// beginning, or all of it.
void Session::run_in_order(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block) {
  const auto key0 = static_cast<std::uint32_t>(settings_.seed), key1 = static_cast<std::uint32_t>(settings_.seed >> 32);
  block->shots.time_ns.resize(count);
  block->shots.kind.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double opens_s = time_s(first + i) + 2.0 * block->range(i) / kLightSpeed + gate.opens_s;
    const double blind = expected_until(gate, (recovers_s_ - opens_s) * 1e9, block->light(i), settings_.noise_per_ns);
    double& time_ns = block->shots.time_ns[i];
    block->shots.kind[i] = photon_shot(gate.table.data(), gate.edges(), block->light(i), settings_.noise_per_ns, blind,
                                       settings_.jitter_ns, key0, key1, first + i, &time_ns);
    if (block->shots.kind[i] != CLRAY_PHOTON_NONE) recovers_s_ = opens_s + time_ns * 1e-9 + station_.dead_time_s;
  }
}

void Session::run_block(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block) {
  set_ranges(first, count, block);
  if (in_order_) {
    run_in_order(gate, first, count, block);
  } else if (options_.device) {
    const DeviceShots request{
        gate.table, block->brightness, settings_.noise_per_ns, settings_.jitter_ns, settings_.seed, first, count};
    sample_shots_on(*options_.device, request, &block->shots.time_ns, &block->shots.kind);
  } else {
    sample_shots(gate, block->brightness, settings_, first, count, &block->shots);
  }
}

SessionSummary Session::run(const std::function<void(const Shot&)>& on_photon) {
  if (options_.first_shot >= shots_)
    refuse(fmt::format("first shot {}; the session has {}", options_.first_shot, shots_), "shots");
  const std::uint64_t wanted = options_.shots == 0 ? shots_ : options_.shots;
  const std::uint64_t begin = options_.first_shot, end = begin + std::min(wanted, shots_ - begin);
  recovers_s_ = -1e300;
  SessionSummary summary;
  Block block;
  std::uint64_t at = in_order_ ? 0 : begin;
  auto orientation = static_cast<std::size_t>(std::upper_bound(times_s_.begin(), times_s_.end(), time_s(at) + 1e-12) -
                                              times_s_.begin() - 1);
  for (; at < end; ++orientation) {
    const std::uint64_t next =
        orientation + 1 < times_s_.size() ? std::min(first_shot_at(times_s_[orientation + 1]), end) : end;
    if (next <= at) continue;
    const Gate gate = gate_of(*delays_[orientation]);
    for (; at < next;) {
      const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlock, next - at));
      run_block(gate, at, count, &block);
      for (std::uint32_t i = 0; i < count; ++i) {
        if (at + i < begin) continue;
        const std::uint32_t kind = block.shots.kind[i];
        ++summary.shots;
        ++(kind == CLRAY_PHOTON_SIGNAL ? summary.signal : kind == CLRAY_PHOTON_NOISE ? summary.noise : summary.none);
        if (kind == CLRAY_PHOTON_NONE) continue;
        on_photon({at + i, time_ps(at + i), block.range(i), gate.opens_s * 1e9 + block.shots.time_ns[i], kind});
      }
      at += count;
    }
  }
  return summary;
}

}  // namespace clray::slr
