// SPDX-License-Identifier: Apache-2.0
// What the host knows of a detector beyond the sums that its row states: settings for the device, bins that the beam's
// strata follow, totals that a run's target is about, and results that are more than a table of its numbers. Every
// function has a default; a detector that needs none of them has no file here.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "beam/strata.hpp"
#include "pipeline/outcome.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/solved_view.hpp"
#include "pipeline/sum_reader.hpp"

namespace clray {

/// Whether two keys name one record.
bool same_record(const ResultKey& a, const ResultKey& b);

/// What a room is asked with: the scene's words for the detector, and the plan as far as it is made.
struct RoomContext {
  const Scene& scene;
  const DetectorSpec& spec;
  const PassPlan& plan;
  const Geometry& geometry;
};

/// A view of a pass whose error is asked for.
struct TargetContext {
  const PassPlan& plan;
  const PassDetector& detector;
  const SumReader& read;
  const Geometry& geometry;
  std::size_t view;
};

/// A solved view of an exact pass, whose sums a detector makes.
struct SolvedContext {
  const PassPlan& plan;
  const PassDetector& detector;
  const Geometry& geometry;
  const SolvedView& solved;
};

/// One detector of a pass with all its sums.
struct RoomResults {
  const Scene& scene;
  const PassPlan& plan;
  const PassDetector& detector;
  const SumReader& read;
  Result& out;
  LitRecords& lit;
  Sums* spent = nullptr;  ///< what `read` reads, where no other detector of the scene asks for it

  /// Gives back memory of values that are not read any more: those of a view and lane in a block of lanes.
  void forget(std::uint32_t block, std::size_t v, std::size_t l) const;
  /// Notes whether a record found light; a record that found none in any orientation is warned of.
  void note(const ResultKey& key, bool found_light) const;
  const DetectorSpec& spec() const { return scene.detectors[static_cast<std::size_t>(detector.index)]; }
  /// The key of a record: observer c of the pass (names are empty where there is only one), view v and lane l.
  ResultKey key(std::size_t v, std::size_t l, std::size_t c) const;
  /// The same without an observer.
  ResultKey key(std::size_t v, std::size_t l) const;
  /// The band that this detector has of a lane: where surfaces know no wavelength, lanes stand for those of several.
  Band band(std::size_t l) const;
  /// The earlier record of this key to which `record`, part of a band, is added; null if `record` is the first, or a
  /// whole band.
  template <class Record>
  Record* known(std::vector<Record>& records, const ResultKey& key, const LaneRecord& record) const {
    if (!(plan.request.lanes[record.first].share < 1.0)) return nullptr;
    const auto found =
        std::find_if(records.begin(), records.end(), [&](const Record& r) { return same_record(r.key, key); });
    return found == records.end() ? nullptr : &*found;
  }
};

struct DetectorRoom {
  const char* id;
  std::vector<double> (*settings)(const RoomContext&) = nullptr;               ///< default: the keys of its row
  std::optional<PathBins> (*path_bins)(const std::vector<double>&) = nullptr;  ///< of its settings; default: none
  void (*targets)(const TargetContext&, std::vector<Target>*) = nullptr;  ///< of a view; default: numbers with a unit
  void (*results)(const RoomResults&) = nullptr;                          ///< default: a table of numbers with a unit
  double (*picture_error)(const TargetContext&) = nullptr;                ///< of a view's picture, over its mean
  // Of exact passes. A detector that has sums and neither of these two is measured with points.
  void (*solved)(const SolvedContext&, Sums*) = nullptr;  ///< adds a view's sums
  /// The window of a histogram over path length, block 0, of a connection.
  ClrayBinning (*binning)(const PassDetector&, std::size_t connection) = nullptr;
};

/// The room of a row of detector.def; one with every default where it has none.
const DetectorRoom& room_of(const std::string& id);
inline const DetectorRoom& room_of(const PassDetector& detector) {
  return room_of(table("detector")[static_cast<std::size_t>(detector.row)].id);
}

}  // namespace clray
