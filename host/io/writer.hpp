// SPDX-License-Identifier: Apache-2.0
// What the writers of one result share. The files of each kind of record are written in its room (detector/room.hpp).
#pragma once

#include <string>
#include <vector>

#include "clray/result.hpp"
#include "clray/write.hpp"
#include "io/output_folder.hpp"
#include "io/table_file.hpp"
#include "text/file_names.hpp"
#include "text/gnuplot.hpp"

namespace clray::io {

using namespace text;

/// One result on its way to disk.
struct Writer {
  const Result& result;
  const Scene& scene;
  const WriteOptions& options;
  const OutputFolder& folder;
  const Reference* reference = nullptr;      ///< of --reference, or null
  std::vector<std::string> files, warnings;  ///< what was written; what went wrong without harm
  FileNames names;                           ///< those of the folder

  /// Registers a file "stem.extension" under a name not yet taken and returns the name.
  std::string add(const std::string& stem, const std::string& extension);
  /// Opens a table with its '#' lines.
  TableFile table(const std::string& name, const std::string& what, const std::string& units) const;
  /// Draws "stem.png" unless plots are off.
  void draw(const Plot& plot, const std::string& name);

  std::string scene_name() const;
  /// Stem of a record's files. It begins with `first`: the detector's kind, or what the files show ("spectrum"). If
  /// there are several detectors of the kind, the detector's name replaces the kind, or follows what is shown. Then
  /// come observer and variant, and, for files of one band, the band.
  std::string stem(const std::string& first, const ResultKey& key, bool of_band = false);
  /// Words for titles: scene, detector if named, observer, variant.
  std::string title(const std::string& kind, const ResultKey& key) const;
  /// The detector named in a key, or null.
  const DetectorSpec* detector_of(const ResultKey& key) const;
  /// Its kind.
  std::string kind_of(const ResultKey& key) const;
};

/// Records of one detector, observer and variant (and band where asked), in the order of their orientations.
template <class Record>
std::vector<std::vector<const Record*>> groups(const std::vector<Record>& records) {
  std::vector<std::vector<const Record*>> found;
  for (const auto& record : records) {
    const auto same = [&](const std::vector<const Record*>& group) {
      const ResultKey& key = group.front()->key;
      return key.detector == record.key.detector && key.observer == record.key.observer &&
             key.variant == record.key.variant;
    };
    // Records come in groups, so the last group nearly always fits.
    auto place = found.rbegin();
    while (place != found.rend() && !same(*place)) ++place;
    if (place == found.rend()) {
      found.push_back({&record});
    } else {
      place->push_back(&record);
    }
  }
  return found;
}

/// The same, with a group for each band, since bands are no orientations of one another.
template <class Record>
std::vector<std::vector<const Record*>> groups_by_band(const std::vector<Record>& records) {
  std::vector<std::vector<const Record*>> found;
  for (const auto& group : groups(records)) {
    const std::size_t first = found.size();
    for (const auto* record : group) {
      auto place = found.begin() + static_cast<std::ptrdiff_t>(first);
      while (place != found.end() && place->front()->key.band != record->key.band) ++place;
      if (place == found.end()) place = found.emplace(place);
      place->push_back(record);
    }
  }
  return found;
}

/// A factor that brings `seconds` to a readable unit, and the unit's name.
struct TimeUnit {
  double per_second;
  const char* name;
};
TimeUnit readable_time_unit(double seconds);

/// Time of a record's orientation, s; 0 where unknown.
double time_of(const Result& result, const ResultKey& key);

/// The instants of a pass that are traced, by their orientation; empty without a pass.
std::vector<const PassInstant*> traced_instants(const Result& result);
/// The places that instants of a pass have: indices into Scene::observers, -1 for the station.
std::vector<int> sites_of(const Result& result);
/// Angle at the body between the light and an observer.
double phase_rad(const Orientation& view, std::size_t observer);

/// One total of a result, as the summary lists them.
struct Total {
  ResultKey key;
  double value = 0.0, standard_error = 0.0;
  std::string unit;
  std::string sum = {};      ///< of a sum that is a result by itself: its name
  std::uint64_t number = 0;  ///< which of its numbers
};
/// "detector/observer/variant/band/orientation", or "…/sum/number": the key of Reference::totals.
std::string total_path(const Total& total);
/// All totals, in the order of the rooms.
std::vector<Total> totals(const Result& result);
/// What `reference` says of the result's first total; NaN if nothing.
double first_reference_total(const Result& result, const Reference& reference);

void write_error(Writer& writer);
void write_pass(Writer& writer);
void write_summary(Writer& writer, const std::vector<MoreFiles>& more);

}  // namespace clray::io
