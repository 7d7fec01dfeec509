// SPDX-License-Identifier: Apache-2.0
// A session: which delay results its shots are drawn from, and its shots, block by block, for the writer and for tests.
// Times are those of the scene's motion, or in s from the session's start.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "clray/session.hpp"
#include "clray/write.hpp"
#include "ephemeris/range.hpp"
#include "slr/gate.hpp"

namespace clray::slr {

using namespace ephemeris;

/// Whether a record is of an observer at the source.
bool seen_from_source(const Scene& scene, const ResultKey& key);

/// One fired shot with what it recorded.
struct Shot {
  std::uint64_t number = 0;
  Instant time;  ///< of fire
  double range_m = 0.0;
  double delay_ns = 0.0;   ///< flight time minus 2 range/c
  std::uint32_t kind = 0;  ///< CLRAY_PHOTON_*
};

/// Shots of a scene's station over its motion or pass.
class Session {
 public:
  /// Checks everything that can be checked before the first shot. Throws Error(input).
  Session(const Result& result, const Scene& scene, const SessionOptions& options);

  std::uint64_t shots() const { return shots_; }
  const RangeModel& ranges() const { return ranges_; }
  const ResultKey& key() const { return delays_.front()->key; }
  /// When a shot is fired: in the motion's time, and from the session's start.
  Instant time(std::uint64_t shot) const;
  double since_s(std::uint64_t shot) const { return seconds_between(start_, time(shot)); }
  /// The motion's time at `since_s` after the session's start.
  Instant at(double since_s) const;
  double last_since_s() const { return since_s(shots_ - 1); }  ///< of the last shot

  /// Delays between which signal is expected, ns, over all orientations; both 0 where there is none.
  std::pair<double, double> signal_window_ns() const;

  /// Mean cross-section over the shots, 4 pi A, m^2.
  double mean_cross_section_m2() const;

  /// Fires the shots that the options ask for, in order, and hands over those that recorded a photon.
  SessionSummary run(const std::function<void(const Shot&)>& on_photon);

 private:
  struct Block;
  void run_block(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block);
  void run_in_order(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block);
  void set_ranges(std::uint64_t first, std::uint32_t count, Block* block) const;
  std::uint64_t first_shot_at(double since_s) const;
  Gate gate_of(const DelayResult& delay) const;

  const Station& station_;
  SessionOptions options_;
  RangeModel ranges_;
  ShotSettings settings_;
  double start_range_m_ = 0.0, start_brightness_ = 0.0;  // photons per m^2/sr there; they go with range^-4
  Instant start_;
  std::uint64_t shots_ = 0;
  bool in_order_ = false;                   ///< the dead time may reach into the next shot's gate
  double recovers_s_ = -1e300;              ///< when the detector sees again, from the start
  std::vector<const DelayResult*> delays_;  ///< one per orientation
  std::vector<std::uint64_t> first_shots_;  ///< of each orientation
  std::vector<std::uint64_t> end_shots_;  ///< behind the last of each; between two orientations of a pass may be a gap
};

}  // namespace clray::slr
