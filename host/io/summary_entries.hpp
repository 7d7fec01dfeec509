// SPDX-License-Identifier: Apache-2.0
// What the records of one kind add to "detectors" in summary.json: keyed by detector, then observer, variant and band
// where there are several; lists "orientations" where there are several of these.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

#include "io/writer.hpp"
#include "text/text.hpp"

namespace clray::io {

using Json = nlohmann::ordered_json;

/// Orientations that the summary lists and delay.csv holds. More of them stand in tables and FITS files alone, so that
/// results stay small.
constexpr std::size_t kMostListed = 100;

inline Json vector(const Vec3& v, double scale = 1.0) {
  return Json::array({v.x * scale, v.y * scale, v.z * scale});
}

/// A pass in short: its span, and how many instants are traced and why others are not.
Json pass_entry(const Result& result);

/// A row per light curve and band: its phases, and its magnitude at 1000 km and 90 degrees or why there is none.
Json light_curves_entry(const Writer& writer);

inline Json value_and_error(const Estimate& estimate) {
  return {{"value", estimate.value},
          {"standard_error", estimate.standard_error},
          {"confidence_95", {estimate.low, estimate.high}},
          {"relative_variance_of_variance", estimate.relative_variance_of_variance}};
}

/// How a number was found, and for an exact one the bound of its rounding.
inline Json method_of(double rounding_bound) {
  if (!(rounding_bound >= 0.0)) return {{"method", "points"}};
  return {{"method", "exact"}, {"rounding_bound", rounding_bound}};
}

/// The same of A, which tiles may have found, or whose first bounce alone may be exact.
inline Json method_of(const Estimate& intensity) {
  if (intensity.tiles) return {{"method", "tiles"}};
  if (!intensity.partly_exact()) return method_of(intensity.rounding_bound);
  return {{"method", "exact first bounce"},
          {"rounding_bound", intensity.rounding_bound},
          {"first_bounce_m2_per_sr", intensity.exact_part}};
}

/// The same of a force.
inline Json method_of(const VectorEstimate& coefficient) {
  if (!coefficient.partly_exact()) return method_of(coefficient.rounding_bound);
  return {{"method", "exact first bounce"},
          {"rounding_bound", coefficient.rounding_bound},
          {"first_bounce_coefficient_m2", vector(coefficient.exact_part)}};
}

class SummaryEntries {
 public:
  explicit SummaryEntries(const Writer& w) : writer(w) {}

  /// Adds what `entry` makes of each record. A single record stands by itself; records of several orientations form a
  /// list. What a place holds already stays.
  template <class Record, class Entry>
  void add(const std::vector<Record>& records, Entry entry) {
    for (const auto& group : groups(records)) add_group(group, entry);
  }

  const Writer& writer;
  Json detectors = Json::object();

 private:
  template <class Record, class Entry>
  void add_group(const std::vector<const Record*>& group, Entry entry) {
    Json& place = place_of(group.front()->key);
    std::set<std::size_t> orientations;
    for (const auto* record : group) orientations.insert(record->key.orientation);
    const bool several =
        orientations.size() > 1 || (group.size() > 1 && group.front()->key.band == group.back()->key.band);
    std::map<std::string, std::size_t> listed;  // records so far, by band
    for (const auto* record : group) {
      const ResultKey& key = record->key;
      if (orientations.size() > kMostListed) {
        // Their number alone: what was found is in the tables.
        (key.band.empty() ? place : place["bands"][shown(key.band)])["orientations"] = orientations.size();
      } else if (several) {
        Json& list = key.band.empty() ? place["orientations"] : place["bands"][shown(key.band)]["orientations"];
        Json& numbered = list[listed[key.band]++];
        put(numbered, {{"orientation", key.orientation}, {"time_s", time_of(writer.result, key)}});
        put(numbered, entry(*record));
      } else {
        put(key.band.empty() ? place : place["bands"][shown(key.band)], entry(*record));
      }
    }
  }

  Json& place_of(const ResultKey& key) {
    Json* place = &detectors[shown(key.detector)];
    if (!key.observer.empty()) place = &(*place)[shown(key.observer)];
    if (!key.variant.empty()) place = &(*place)[shown(key.variant)];
    return *place;
  }

  static void put(Json& place, Json entry) { place.is_null() ? void(place = std::move(entry)) : place.update(entry); }
};

}  // namespace clray::io
