// SPDX-License-Identifier: Apache-2.0
// From where an exact pass sees the body, and the histograms of what is seen.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/portable_faces.hpp"
#include "pipeline/plan.hpp"

namespace clray {

/// A direction from which a body is seen: that of the source, first, or of an observer elsewhere.
struct Sight {
  std::vector<std::size_t> connections;  ///< of the pass: observers there
  std::vector<ClrayBinning> binnings;    ///< the windows of its delay detectors

  std::size_t connection() const { return connections.front(); }
};

/// The source first, then every observer that is elsewhere.
std::vector<Sight> sights_of(const PassPlan& plan);

/// Lays the histograms of every sight out, one after the other; returns how many numbers they have.
std::uint64_t lay_out_bins(const PassPlan& plan, std::vector<Sight>* sights);

/// Adds to each histogram's block its rows, of a view, lane and connection.
void take_bins(const PassPlan& plan, const std::vector<Sight>& sights, const std::vector<i64>& bins, Sums* sums);

/// What the program of an exact pass is built with.
ExactNumbers exact_numbers(const PassPlan& plan);

}  // namespace clray
