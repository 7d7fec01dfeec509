// SPDX-License-Identifier: Apache-2.0
// What a pass ended with, and how its sums become results: each detector's room does that (detector/room.hpp).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "body/geometry.hpp"
#include "pipeline/lit_records.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// Why a pass ended, and what its result then was.
struct Ending {
  const char* by = "";                                           ///< see Result::stopped_by
  double half_width = std::numeric_limits<double>::quiet_NaN();  ///< 95 %, over the value, the largest over totals
  std::uint64_t rays = 0;                                        ///< per orientation
};

struct PassOutcome {
  Sums sums;
  bool partial = false;
  bool target_asked = false, target_reached = false;
  Ending ending;                 ///< of the view that missed the target by most, else of the one with the largest error
  std::uint64_t rays_total = 0;  ///< over all views and phases
  double seconds = 0.0;          ///< of tracing
  std::vector<ErrorPoint> errors;
};

/// One total that a run's target is about, per replicate; vectors have three.
struct Target {
  std::vector<std::vector<double>> components;  ///< [axis][replicate]
  double scale = 0.0;                           ///< what the half-width is compared with; 0: the value itself
  std::vector<double> solved = {};              ///< [axis] to add to every replicate, without error; empty: nothing

  double solved_of(std::size_t axis) const { return solved.empty() ? 0.0 : solved[axis]; }
};

/// Every total of a view, in result units.
std::vector<Target> targets_of(const PassPlan& plan, const Geometry& geometry, const Sums& sums, std::size_t view);

/// The relative standard error of a view's picture: root mean square over its pixels. NaN where all are black.
double picture_error(const PassPlan& plan, const Geometry& geometry, const Sums& sums, std::size_t view);

/// Largest relative standard error over the targets (NaN if all are zero), and the first target's value and error, from
/// `rays` of each replicate.
void largest_error(const std::vector<Target>& targets, double rays, ErrorPoint* point);

/// Appends what the pass found to the result's detectors, energy books and diagnostics, and notes which records are
/// lit. Of large sums nothing may be left afterwards.
void add_results(const Scene& scene, const PassPlan& plan, PassOutcome* outcome, Result* result, LitRecords* lit);

/// Puts the records of all passes in the order of the scene: orientation, variant, band, observer, detector (pictures
/// and books: detector and observer first).
void order_results(const Scene& scene, Result* result);

/// Digest of a pass's sums, continued from `state`.
std::uint64_t digest_of(std::uint64_t state, const PassPlan& plan, const Sums& sums);

}  // namespace clray
