// SPDX-License-Identifier: Apache-2.0
// Shots over a motion or pass; see session.hpp. Each block of shots has one orientation: that at the start of its step.
#include "slr/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/write.hpp"
#include "device/shots.hpp"
#include "pass/instants.hpp"
#include "scene/motion.hpp"
#include "shared/photon.h"
#include "slr/link.hpp"
#include "slr/pulse.hpp"

namespace clray::slr {

namespace {

constexpr std::uint32_t kBlock = 1u << 17;
constexpr double kMostShots = 1e12;

[[noreturn]] void refuse(const std::string& what, const std::string& key) {
  throw Error(ErrorCode::input, what, key);
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
        fits(options.variant, d.key.variant) && seen_from_source(scene, d.key)) {
      return &d;
    }
  }
  refuse("a session needs a delay result seen from the source; there is none of that name", "station");
}

const Station& station_of(const Scene& scene) {
  if (!scene.station) refuse("a session needs a [station]", "station");
  if (!scene.motion && !scene.pass) refuse("a session needs a [motion] or a [pass]", "motion");
  if (scene.source.kind != Source::Kind::laser) refuse("a session needs kind = \"laser\"", "source.kind");
  check_station(*scene.station, scene.source.wavelength_nm);
  return *scene.station;
}

/// From when to when each orientation holds, in the time of motion or pass.
struct Hold {
  double from_s = 0.0, until_s = 0.0;
};

std::vector<Hold> holds_of(const Result& result, const Scene& scene) {
  std::vector<Hold> holds;
  if (scene.pass) {
    for (const PassInstant& instant : result.instants) {
      if (instant.traced()) holds.push_back({instant.time_s, instant.until_s});
    }
    return holds;
  }
  const std::size_t count = orientation_count(*scene.motion);
  const double stop_s = motion_span(*scene.motion).second;
  for (std::size_t i = 0; i < std::min(count, result.orientations.size()); ++i) {
    const double next =
        i + 1 < count && i + 1 < result.orientations.size() ? result.orientations[i + 1].time_s : stop_s;
    holds.push_back({result.orientations[i].time_s, next});
  }
  return holds;
}

std::uint64_t count_shots(double duration_s, double rate_Hz) {
  const double shots = duration_s * rate_Hz;
  if (!(shots < kMostShots))
    refuse(fmt::format("{:.3g} shots; expected fewer than {:.0e}", shots, kMostShots), "station");
  // A pass of 20 s at 2000 Hz has 40000 shots, even if rounding makes it 19.999999 s.
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::floor(shots + 1e-6)));
}

}  // namespace

bool seen_from_source(const Scene& scene, const ResultKey& key) {
  if (scene.observers.empty()) return true;
  return std::any_of(scene.observers.begin(), scene.observers.end(), [&](const Observer& o) {
    return at_source(o, scene.source) && (key.observer.empty() || o.name == key.observer);
  });
}

/// Shots of a block: their distances (a single one if the range is fixed) and results.
struct Session::Block {
  std::vector<double> range_m, brightness;
  Shots shots;

  double range(std::uint32_t i) const { return range_m.size() == 1 ? range_m[0] : range_m[i]; }
  double light(std::uint32_t i) const { return brightness.size() == 1 ? brightness[0] : brightness[i]; }
};

Session::Session(const Result& result, const Scene& scene, const SessionOptions& options)
    : station_(station_of(scene)), options_(options), ranges_(pass::range_model(scene)) {
  const DelayResult* first = first_of_group(result, scene, options);
  // The orientations of a grid of Sun directions come after those of the motion; they have no delay results.
  const std::vector<Hold> holds = holds_of(result, scene);
  if (holds.empty()) refuse("there is no orientation with a delay result", scene.pass ? "pass" : "motion");
  delays_.assign(holds.size(), nullptr);
  for (const DelayResult& d : result.delay) {
    if (same_group(d.key, first->key) && d.key.orientation < delays_.size()) delays_[d.key.orientation] = &d;
  }
  for (std::size_t i = 0; i < delays_.size(); ++i) {
    if (!delays_[i]) refuse(fmt::format("orientation {} has no delay result", i), scene.pass ? "pass" : "motion");
  }
  start_ = instant_of(holds.front().from_s);
  shots_ = count_shots(seconds_between(start_, instant_of(holds.back().until_s)), station_.rate_Hz);
  for (const Hold& hold : holds) {
    first_shots_.push_back(first_shot_at(seconds_between(start_, instant_of(hold.from_s))));
    end_shots_.push_back(first_shot_at(seconds_between(start_, instant_of(hold.until_s))));
  }
  if (shots_ > 0 && end_shots_.back() + 1 >= shots_) end_shots_.back() = shots_;  // a lone shot, or one on the end
  settings_.noise_per_ns = station_.noise_per_ns + station_.dark_per_ns;
  settings_.jitter_ns = station_.jitter_fwhm_s / kFwhmPerSigma * 1e9;
  settings_.seed = result.seed;
  settings_.threads = options.threads;
  // A gate of a later shot may come earlier by the change of range: at most 1e-4 of a period below 15 km/s.
  in_order_ = station_.dead_time_s > 0.0 && station_.dead_time_s > (1.0 - 1e-4) / station_.rate_Hz - station_.gate_s;
  if (station_.gate_s < first->bin_width_s && options_.warnings) {
    options_.warnings->push_back(
        fmt::format("the gate of {:.4g} ns is shorter than a bin of the delay histogram ({:.4g} ns), over which the "
                    "session spreads light evenly: use narrower bins",
                    station_.gate_s * 1e9, first->bin_width_s * 1e9));
  }
  start_range_m_ = ranges_.range_m(start_);
  start_brightness_ =
      4.0 * constants::kPi * link_budget(station_, scene.source.wavelength_nm, start_range_m_).photons_per_m2;
  ranges_.range_m(time(end_shots_.back() - 1));
}

Instant Session::time(std::uint64_t shot) const {
  const double k = static_cast<double>(shot), rate = station_.rate_Hz;
  const double seconds = std::floor(k / rate);
  const double rest = std::fma(-seconds, rate, k) / rate;
  return later(start_, static_cast<std::int64_t>(seconds), static_cast<std::int64_t>(std::llround(rest * 1e12)));
}

Instant Session::at(double since_s) const {
  const double whole = std::floor(since_s);
  return later(start_, static_cast<std::int64_t>(whole),
               static_cast<std::int64_t>(std::llround((since_s - whole) * 1e12)));
}

/// The first shot not before a time, to a picosecond.
std::uint64_t Session::first_shot_at(double since_s) const {
  const double estimate = std::floor(since_s * station_.rate_Hz) - 2.0;
  auto shot = estimate > 0.0 ? static_cast<std::uint64_t>(estimate) : 0;
  while (shot < shots_ && this->since_s(shot) < since_s - 1e-12) ++shot;
  return shot;
}

Gate Session::gate_of(const DelayResult& delay) const {
  const Histogram histogram{delay.first_bin_start_s, delay.bin_width_s, delay.bin_m2_per_sr};
  return make_gate(smear(histogram, station_), station_.gate_s);
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
  double sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < delays_.size(); ++i) {
    const auto shots = static_cast<double>(end_shots_[i] - first_shots_[i]);
    sum += shots * 4.0 * constants::kPi * delays_[i]->intensity_m2_per_sr.value;
    all += shots;
  }
  return sum / all;
}

void Session::set_ranges(std::uint64_t first, std::uint32_t count, Block* block) const {
  const std::uint32_t size = ranges_.fixed() ? 1 : count;
  block->range_m.resize(size);
  block->brightness.resize(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    block->range_m[i] = ranges_.range_m(time(first + i));
    const double nearer = start_range_m_ / block->range_m[i], squared = nearer * nearer;
    block->brightness[i] = start_brightness_ * (squared * squared);
  }
}

/// Shots that depend on those before: a detector that has not recovered from its last photon misses the beginning of
/// the gate, or all of it.
void Session::run_in_order(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block) {
  const auto key0 = static_cast<std::uint32_t>(settings_.seed), key1 = static_cast<std::uint32_t>(settings_.seed >> 32);
  block->shots.time_ns.resize(count);
  block->shots.kind.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double opens_s = since_s(first + i) + 2.0 * block->range(i) / constants::kLightSpeed_m_s + gate.opens_s;
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
  for (std::size_t orientation = 0; at < end && orientation < delays_.size(); ++orientation) {
    const std::uint64_t next = std::min(end_shots_[orientation], end);
    at = std::max(at, first_shots_[orientation]);
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
        on_photon({at + i, time(at + i), block.range(i), gate.opens_s * 1e9 + block.shots.time_ns[i], kind});
      }
      at += count;
    }
  }
  return summary;
}

}  // namespace clray::slr
