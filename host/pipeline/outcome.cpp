// SPDX-License-Identifier: Apache-2.0
// See outcome.hpp. A detector's room (detector/) says what its sums mean. This file asks the rooms and puts the records
// in order.
#include "pipeline/outcome.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "clray/error.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/sums.hpp"
#include "pipeline/estimate.hpp"
#include "scene/spectrum.hpp"
#include "text/hash.hpp"

namespace clray {
namespace {

void add_counters(const Sums& sums, Result* out) {
  std::array<std::uint64_t, CLRAY_COUNTERS> n{};
  for (const auto& view : sums.events) std::transform(n.begin(), n.end(), view.begin(), n.begin(), std::plus<>());
  out->diagnostics.non_finite += n[CLRAY_COUNT_NON_FINITE];
  out->diagnostics.stack_overflow += n[CLRAY_COUNT_STACK];
  out->diagnostics.lost_rays += n[CLRAY_COUNT_LOST];
  out->diagnostics.accumulator_overflow += n[CLRAY_COUNT_OVERFLOW];
  out->paths.started += n[CLRAY_COUNT_STARTED];
  out->paths.escaped += n[CLRAY_COUNT_ESCAPED];
  out->paths.killed += n[CLRAY_COUNT_KILLED];
  out->paths.capped += n[CLRAY_COUNT_CAPPED];
}

/// The place of each name in the scene's order.
class Places {
 public:
  explicit Places(const Scene& scene) {
    for (const DetectorSpec& d : scene.detectors) detectors_.push_back(shown_name(d));
    for (const Observer& o : scene.observers) observers_.push_back(o.name);
    for (const Variant& v : scene.variants) variants_.push_back(v.name);
    for (const Lane& lane : lanes_of(scene)) bands_.push_back(lane.band_name);
  }
  std::array<std::size_t, 5> of(const ResultKey& k, bool by_detector) const {
    const std::size_t detector = place(detectors_, k.detector), observer = place(observers_, k.observer);
    const std::size_t variant = place(variants_, k.variant), band = place(bands_, k.band);
    if (by_detector) return {{detector, observer, k.orientation, variant, band}};
    return {{k.orientation, variant, band, observer, detector}};
  }

 private:
  static std::size_t place(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  std::vector<std::string> detectors_, observers_, variants_, bands_;
};

}  // namespace

void RoomResults::note(const ResultKey& key, bool found_light) const {
  lit.note(table("detector")[static_cast<std::size_t>(detector.row)], key, found_light);
}

void RoomResults::forget(std::uint32_t block, std::size_t v, std::size_t l) const {
  const SumRange range = read.of_lane(block, v, l);
  if (spent != nullptr) spent->values.forget(range.begin, range.end);
}

ResultKey RoomResults::key(std::size_t v, std::size_t l, std::size_t c) const {
  ResultKey k = key(v, l);
  const auto observer = static_cast<std::size_t>(plan.request.observers[c]);
  if (scene.observers.size() > 1 && !plan.request.grid) k.observer = scene.observers[observer].name;
  return k;
}

ResultKey RoomResults::key(std::size_t v, std::size_t l) const {
  ResultKey k;
  if (detector.index >= 0) k.detector = shown_name(spec());
  k.variant = plan.request.lanes[l].variant;
  k.band = plan.request.lanes[l].band_name;
  k.orientation = plan.request.first_orientation + v;
  return k;
}

Band RoomResults::band(std::size_t l) const {
  const std::vector<Band> own = bands_of(scene, table_row("detector", spec().kind));
  return own.size() == 1 ? own.front() : plan.request.lanes[l].band;
}

bool same_record(const ResultKey& a, const ResultKey& b) {
  return a.detector == b.detector && a.observer == b.observer && a.variant == b.variant && a.band == b.band &&
         a.orientation == b.orientation;
}

std::vector<Target> targets_of(const PassPlan& plan, const Geometry& geometry, const Sums& sums, std::size_t view) {
  std::vector<Target> targets;
  if (plan.request.paints()) return targets;
  const SumReader read(plan, sums);
  for (const PassDetector& detector : plan.detectors) {
    if (!detector.asked) continue;
    const auto add = room_of(detector).targets != nullptr ? room_of(detector).targets : sums_targets;
    add({plan, detector, read, geometry, view}, &targets);
  }
  return targets;
}

double picture_error(const PassPlan& plan, const Geometry& geometry, const Sums& sums, std::size_t view) {
  const SumReader read(plan, sums);
  for (const PassDetector& detector : plan.detectors) {
    if (const auto error = room_of(detector).picture_error) return error({plan, detector, read, geometry, view});
  }
  throw Error(ErrorCode::bug, "no detector of this pass paints", "picture_error");
}

void add_results(const Scene& scene, const PassPlan& plan, PassOutcome* outcome, Result* result, LitRecords* lit) {
  const PassRequest& request = plan.request;
  const std::size_t end = request.first_orientation + request.orientations.size();
  if (result->orientations.size() < end) result->orientations.resize(end);
  std::copy(request.orientations.begin(), request.orientations.end(),
            result->orientations.begin() + static_cast<std::ptrdiff_t>(request.first_orientation));
  const SumReader read(plan, outcome->sums);
  const bool alone = std::count_if(plan.detectors.begin(), plan.detectors.end(),
                                   [](const PassDetector& d) { return d.asked && d.index >= 0; }) == 1;
  for (const PassDetector& detector : plan.detectors) {
    if (!detector.asked) continue;
    const auto results = room_of(detector).results != nullptr ? room_of(detector).results : sums_results;
    results({scene, plan, detector, read, *result, *lit, alone ? &outcome->sums : nullptr});
  }
  add_counters(outcome->sums, result);
}

void order_results(const Scene& scene, Result* result) {
  const Places places(scene);
  const auto order = [&](auto& records, bool by_detector) {
    std::stable_sort(records.begin(), records.end(), [&](const auto& a, const auto& b) {
      return places.of(a.key, by_detector) < places.of(b.key, by_detector);
    });
  };
  order(result->delay, false);
  order(result->spectrometer, false);
  order(result->pressure, false);
  order(result->energy, true);
  order(result->image, true);
  order(result->table, false);
}

std::uint64_t digest_of(std::uint64_t state, const PassPlan& plan, const Sums& sums) {
  if (plan.first) state = digest_of(state, plan.first->plan, plan.first->sums);
  if (plan.request.exact()) state = fnv1a(state, "exact", 5);
  if (plan.request.tiles()) state = fnv1a(state, "tiles", 5);
  for (std::size_t v = 0; v < sums.points.size(); ++v) {
    const std::uint64_t head[3] = {static_cast<std::uint64_t>(plan.scales.views[v].weight_bits),
                                   plan.request.replicates, sums.points[v]};
    state = fnv1a(state, head, sizeof head);
  }
  // The generic program has more detectors than the scene asked for; those do not count.
  for (const PassDetector& d : plan.detectors) {
    if (d.asked) state = digest_values(state, plan.layout, sums, d.first_block, d.last_block);
  }
  for (const PassDetector& d : plan.detectors) {
    if (d.asked) state = digest_counts(state, plan.layout, sums, d.first_block, d.last_block);
  }
  return state;
}

}  // namespace clray
