// SPDX-License-Identifier: Apache-2.0
// A session in the making: which delay results it shoots at, its shots one block after another, for the writer and
// for tests. Times in s of the scene's motion.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "clray/session.hpp"
#include "slr/gate.hpp"
#include "slr/range.hpp"

namespace clray::slr {

/// One fired shot with what it recorded.
struct Shot {
  std::uint64_t number = 0;
  std::int64_t time_ps = 0;  ///< of fire, from session time 0
  double range_m = 0.0;
  double delay_ns = 0.0;   ///< flight time minus 2 range/c
  std::uint32_t kind = 0;  ///< CLRAY_PHOTON_*
};

/// Shots of a scene's station over its motion.
class Session {
 public:
  /// Checks everything that can be checked before the first shot. Throws Error(input).
  Session(const Result& result, const Scene& scene, const SessionOptions& options);

  std::uint64_t shots() const { return shots_; }
  const RangeModel& ranges() const { return ranges_; }
  const ResultKey& key() const { return delays_.front()->key; }
  double start_s() const { return start_s_; }
  double stop_s() const;  ///< of the last shot
  double time_s(std::uint64_t shot) const;
  std::int64_t time_ps(std::uint64_t shot) const;

  /// Delays between which signal is expected, ns, over all orientations; both 0 where there is none.
  std::pair<double, double> signal_window_ns() const;

  /// Mean cross-section over the orientations, 4 pi A, m^2.
  double mean_cross_section_m2() const;

  /// Fires the shots that the options ask for, in order, and hands over those that recorded a photon.
  SessionSummary run(const std::function<void(const Shot&)>& on_photon);

 private:
  struct Block;
  void run_block(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block);
  void run_in_order(const Gate& gate, std::uint64_t first, std::uint32_t count, Block* block);
  void set_ranges(std::uint64_t first, std::uint32_t count, Block* block) const;
  std::uint64_t first_shot_at(double time_s) const;
  Gate gate_of(const DelayResult& delay) const;

  const Station& station_;
  SessionOptions options_;
  double wavelength_nm_ = 532.0;
  RangeModel ranges_;
  ShotSettings settings_;
  double start_range_m_ = 0.0, start_brightness_ = 0.0;  // photons per m^2/sr there; they go with range^-4
  double start_s_ = 0.0;
  std::uint64_t shots_ = 0;
  bool in_order_ = false;                   ///< a dead time that reaches into the next shot's gate
  double recovers_s_ = -1e300;              ///< when the detector sees again
  std::vector<double> times_s_;             ///< of the orientations
  std::vector<const DelayResult*> delays_;  ///< one per orientation
};

}  // namespace clray::slr
