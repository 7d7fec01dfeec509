// SPDX-License-Identifier: Apache-2.0
// summary.json: what ran, on what, how long, what was found with which error. NaN and infinities become null. Results
// are keyed by detector, then observer and variant where there are several; units are in the names.
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "io/writer.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Json = nlohmann::ordered_json;

Json vector(const Vec3& v, double scale = 1.0) {
  return Json::array({v.x * scale, v.y * scale, v.z * scale});
}

Json value_and_error(const Estimate& estimate) {
  return {{"value", estimate.value},
          {"standard_error", estimate.standard_error},
          {"confidence_95", {estimate.low, estimate.high}},
          {"relative_variance_of_variance", estimate.relative_variance_of_variance}};
}

Json delay_entry(const DelayResult& delay) {
  const auto& a = delay.intensity_m2_per_sr;
  std::size_t unresolved = 0;
  for (const auto resolved : delay.resolved) unresolved += !resolved;
  return {{"intensity_m2_per_sr", a.value},
          {"standard_error", a.standard_error},
          {"confidence_95", {a.low, a.high}},
          {"relative_variance_of_variance", a.relative_variance_of_variance},
          {"cross_section_m2", 4.0 * constants::kPi * a.value},
          {"cross_section_standard_error", 4.0 * constants::kPi * a.standard_error},
          {"mean_delay_ns", delay.mean_delay_s.value * 1e9},
          {"mean_delay_standard_error_ns", delay.mean_delay_s.standard_error * 1e9},
          {"mean_delay_relative_variance_of_variance", delay.mean_delay_s.relative_variance_of_variance},
          {"rms_width_ns", delay.rms_width_s.value * 1e9},
          {"rms_width_standard_error_ns", delay.rms_width_s.standard_error * 1e9},
          {"rms_width_relative_variance_of_variance", delay.rms_width_s.relative_variance_of_variance},
          {"bins", delay.bin_m2_per_sr.size()},
          {"bin_ns", delay.bin_width_s * 1e9},
          {"first_bin_ns", delay.first_bin_start_s * 1e9},
          {"unresolved_bins", unresolved},
          {"below_window_m2_per_sr", delay.below_m2_per_sr},
          {"above_window_m2_per_sr", delay.above_m2_per_sr}};
}

Json spectrometer_entry(const SpectrometerResult& record) {
  return {{"low_nm", record.band.low_nm},
          {"high_nm", record.band.high_nm},
          {"intensity_m2_per_sr", record.intensity_m2_per_sr.value},
          {"standard_error", record.intensity_m2_per_sr.standard_error},
          {"confidence_95", {record.intensity_m2_per_sr.low, record.intensity_m2_per_sr.high}},
          {"relative_variance_of_variance", record.intensity_m2_per_sr.relative_variance_of_variance},
          {"source_W_m2", record.source_W_m2},
          {"received_W_m2", record.received_W_m2},
          {"received_standard_error", record.received_W_m2_standard_error},
          {"magnitude_AB", record.magnitude_AB},
          {"magnitude_standard_error", record.magnitude_standard_error},
          {"phase_angle_deg", record.phase_angle_rad * 180.0 / constants::kPi}};
}

Json pressure_entry(const PressureResult& record, const Scene& scene) {
  const auto& c = record.coefficient_m2;
  const auto& t = record.torque_coefficient_m3;
  Json entry{{"sun", vector(record.sun)},
             {"low_nm", record.band.low_nm},
             {"high_nm", record.band.high_nm},
             {"source_W_m2", record.source_W_m2},
             {"force_N_per_W_m2", vector(c.value, 1.0 / constants::kLightSpeed_m_s)},
             {"force_standard_error", vector(c.standard_error, 1.0 / constants::kLightSpeed_m_s)},
             {"torque_Nm_per_W_m2", vector(t.value, 1.0 / constants::kLightSpeed_m_s)},
             {"torque_standard_error", vector(t.standard_error, 1.0 / constants::kLightSpeed_m_s)},
             {"force_N_at_1361_W_m2", vector(c.value, constants::kSolarConstant_W_m2 / constants::kLightSpeed_m_s)},
             {"torque_Nm_at_1361_W_m2", vector(t.value, constants::kSolarConstant_W_m2 / constants::kLightSpeed_m_s)},
             {"coefficient_m2", vector(c.value)},
             {"coefficient_standard_error", vector(c.standard_error)},
             {"coefficient_relative_variance_of_variance", vector(c.relative_variance_of_variance)},
             {"torque_coefficient_m3", vector(t.value)},
             {"torque_coefficient_standard_error", vector(t.standard_error)},
             {"torque_coefficient_relative_variance_of_variance", vector(t.relative_variance_of_variance)},
             {"absorbed_m2", value_and_error(record.absorbed_m2)}};
  for (std::size_t i = 0; i < record.component_m2.size(); ++i) {
    Json share{{"name", i < scene.components.size() ? scene.components[i].name : ""},
               {"coefficient_m2", vector(record.component_m2[i].value)},
               {"coefficient_standard_error", vector(record.component_m2[i].standard_error)}};
    if (i < record.component_m3.size()) {
      share["torque_coefficient_m3"] = vector(record.component_m3[i].value);
      share["torque_coefficient_standard_error"] = vector(record.component_m3[i].standard_error);
    }
    entry["components"].push_back(share);
  }
  return entry;
}

Json image_entry(const ImageResult& image) {
  Json bands = Json::array();
  for (std::size_t b = 0; b < image.bands.size(); ++b) {
    bands.push_back(
        {{"name", image.bands[b].name}, {"low_nm", image.bands[b].low_nm}, {"high_nm", image.bands[b].high_nm}});
    if (b < image.band_source_W_m2.size()) bands.back()["source_W_m2"] = image.band_source_W_m2[b];
  }
  return {{"width", image.width},
          {"height", image.height},
          {"pixel_m", image.pixel_m},
          {"centre_right_m", image.centre_right_m},
          {"centre_up_m", image.centre_up_m},
          {"right", vector(image.right)},
          {"up", vector(image.up)},
          {"toward", vector(image.toward)},
          {"unseen_mirrors_m2", image.unseen_mirrors_m2},
          {"unseen_caustics_m2", image.unseen_caustics_m2},
          {"bands", bands}};
}

/// Where a record's entry goes: detectors → name → [observer →] [variant →].
Json& place_of(Json& detectors, const ResultKey& key) {
  Json* place = &detectors[one_line(key.detector)];
  if (!key.observer.empty()) place = &(*place)[one_line(key.observer)];
  if (!key.variant.empty()) place = &(*place)[one_line(key.variant)];
  return *place;
}

/// Adds a record's entries to those that its place has already.
void put(Json& place, Json entry) {
  place.is_null() ? void(place = std::move(entry)) : place.update(entry);
}

/// A single record stands by itself; those of several orientations form the list "orientations".
template <class Records, class Entry>
void add_entries(Json& detectors, const Writer& writer, const Records& records, Entry entry) {
  for (const auto& group : groups(records)) {
    Json& place = place_of(detectors, group.front()->key);
    std::map<std::string, std::size_t> listed;  // records so far, by band
    std::set<std::size_t> orientations;
    for (const auto* record : group) orientations.insert(record->key.orientation);
    const bool several =
        orientations.size() > 1 || (group.size() > 1 && group.front()->key.band == group.back()->key.band);
    for (const auto* record : group) {
      Json made = entry(*record);
      if (several) {
        Json& list = record->key.band.empty() ? place["orientations"]
                                              : place["bands"][one_line(record->key.band)]["orientations"];
        Json& numbered = list[listed[record->key.band]++];
        put(numbered, {{"orientation", record->key.orientation}, {"time_s", time_of(writer.result, record->key)}});
        put(numbered, std::move(made));
      } else {
        put(record->key.band.empty() ? place : place["bands"][one_line(record->key.band)], std::move(made));
      }
    }
  }
}

/// {sum: {unit, values}} of a sum that is a result by itself.
Json sum_entry(const TableResult& sum) {
  Json values = Json::array();
  for (const Estimate& e : sum.values) values.push_back(value_and_error(e));
  return {{sum.name, {{"unit", sum.unit}, {"values", values}}}};
}

/// The records of each sum, in the order in which they first occur.
std::vector<std::vector<TableResult>> by_sum(const std::vector<TableResult>& records) {
  std::vector<std::vector<TableResult>> sums;
  for (const TableResult& record : records) {
    const auto same = [&](const auto& sum) { return sum.front().name == record.name; };
    const auto found = std::find_if(sums.begin(), sums.end(), same);
    (found == sums.end() ? sums.emplace_back() : *found).push_back(record);
  }
  return sums;
}

Json detectors_of(const Writer& writer) {
  Json detectors = Json::object();
  add_entries(detectors, writer, writer.result.delay, delay_entry);
  add_entries(detectors, writer, writer.result.spectrometer, spectrometer_entry);
  add_entries(detectors, writer, writer.result.pressure,
              [&](const PressureResult& record) { return pressure_entry(record, writer.scene); });
  for (const auto& sum : by_sum(writer.result.table)) add_entries(detectors, writer, sum, sum_entry);
  add_entries(detectors, writer, writer.result.image, [&](const ImageResult& image) {
    Json entry = image_entry(image);
    if (writer.kind_of(image.key) == "rgb") {
      double ev = 0.0;
      for (const auto& detector : writer.scene.detectors) {
        const auto found = detector.parameters.find("exposure_ev");
        const bool same = (detector.name.empty() ? detector.kind : detector.name) == image.key.detector;
        if (same && found != detector.parameters.end()) ev = found->second;
      }
      entry["exposure"] = "a white Lambert plate square to the light has luminance 1, then exposure_ev stops";
      entry["exposure_ev"] = ev;
    }
    return entry;
  });
  return detectors;
}

Json totals_of(const Writer& writer) {
  Json list = Json::array();
  for (const auto& total : totals(writer.result)) {
    list.push_back({{"detector", total.key.detector},
                    {"observer", total.key.observer},
                    {"variant", total.key.variant},
                    {"band", total.key.band},
                    {"orientation", total.key.orientation},
                    {"value", total.value},
                    {"standard_error", total.standard_error},
                    {"unit", total.unit}});
    if (total.sum.empty()) continue;
    list.back()["sum"] = total.sum;
    list.back()["number"] = total.number;
  }
  return list;
}

/// A row per variant and band (and grid of Sun directions) whose paths scatter.
Json energy_of(const std::vector<EnergyBooks>& all) {
  Json list = Json::array();
  for (const EnergyBooks& books : all) {
    Json entry{{"incident_m2", value_and_error(books.incident_m2)},
               {"reflected_m2", value_and_error(books.reflected_m2)},
               {"absorbed_m2", value_and_error(books.absorbed_m2)},
               {"roulette_m2", value_and_error(books.roulette_m2)},
               {"truncated_m2", value_and_error(books.truncated_m2)},
               {"unconnected_specular_m2", value_and_error(books.unconnected_specular_m2)}};
    if (!books.key.detector.empty()) entry["detector"] = books.key.detector;
    if (!books.key.variant.empty()) entry["variant"] = books.key.variant;
    if (!books.key.band.empty()) entry["band"] = books.key.band;
    list.push_back(entry);
  }
  return list;
}

Json head_of(const Writer& writer) {
  const Result& r = writer.result;
  Json head{{"clray", CLRAY_VERSION},
            {"scene", writer.scene.path.empty() ? writer.scene.name : writer.scene.path},
            {"command", writer.options.command},
            {"seed", r.seed},
            {"rays", r.rays},
            {"rays_total", r.rays_total},
            {"replicates", r.replicates},
            {"precision", "fp64"},
            {"identical", true},
            {"digest", hex16(r.digest)}};
  if (r.partial) head["partial"] = true;
  if (r.target_asked) {
    head["target_percent"] = r.target_percent;
    head["target_reached"] = r.target_reached;
    head["reached_percent"] = r.reached_percent;
  }
  head["stopped_by"] = r.stopped_by;
  const auto& device = r.device;
  head["device"] = {
      {"name", device.name}, {"platform", device.platform}, {"type", device.type}, {"driver", device.driver}};
  const auto& s = r.seconds;
  head["seconds"] = {{"load", s.load}, {"bvh", s.bvh}, {"compile", s.compile}, {"trace", s.trace}, {"total", s.total}};
  head["extent_m"] = r.extent_m;
  const auto& mesh = r.mesh;
  head["mesh"] = {{"triangles", mesh.triangles},
                  {"area_m2", mesh.area_m2},
                  {"degenerate", mesh.degenerate},
                  {"non_manifold_edges", mesh.non_manifold_edges},
                  {"boundary_edges", mesh.boundary_edges}};
  return head;
}

Json warnings_of(const Writer& writer) {
  Json list = Json::array();
  std::set<std::string> seen;
  for (const auto* source : {&writer.scene.warnings, &writer.result.warnings, &writer.warnings}) {
    for (const auto& warning : *source) {
      if (seen.insert(warning).second) list.push_back(warning);
    }
  }
  return list;
}

Json orientations_of(const Writer& writer) {
  Json list = Json::array();
  for (const auto& o : writer.result.orientations) {
    const auto& q = o.body_to_space;
    Json observers = Json::array();
    for (const auto& observer : o.observers) observers.push_back(vector(observer));
    list.push_back({{"time_s", o.time_s},
                    {"body_to_space_wxyz", {q.w, q.x, q.y, q.z}},
                    {"source", vector(o.source)},
                    {"observers", observers}});
  }
  return list;
}

}  // namespace

void write_summary(Writer& writer, const std::vector<MoreFiles>& more) {
  const Result& r = writer.result;
  Json summary = head_of(writer);
  summary["left_out"] = r.left_out;
  summary["kept"] = r.kept;
  const auto& d = r.diagnostics;
  summary["diagnostics"] = {{"non_finite", d.non_finite},
                            {"stack_overflow", d.stack_overflow},
                            {"lost_rays", d.lost_rays},
                            {"accumulator_overflow", d.accumulator_overflow},
                            {"below_window", d.below_window_fraction},
                            {"above_window", d.above_window_fraction},
                            {"truncated_energy_fraction", d.truncated_energy_fraction}};
  summary["paths"] = {{"started", r.paths.started},
                      {"escaped", r.paths.escaped},
                      {"killed", r.paths.killed},
                      {"capped", r.paths.capped}};
  summary["energy"] = energy_of(r.energy);
  if (writer.reference) {
    summary["reference"] = writer.reference->file;
    summary["relative_true_error"] = relative_true_error(r, *writer.reference);
  }
  summary["detectors"] = detectors_of(writer);
  summary["totals"] = totals_of(writer);
  for (const auto& part : more) {
    if (part.summary_key.empty()) continue;
    Json entry = Json::parse(part.summary_json, nullptr, false);
    if (entry.is_discarded())
      throw Error(ErrorCode::usage, "summary_json is not JSON", "MoreFiles." + part.summary_key);
    summary[part.summary_key] = std::move(entry);
  }
  summary["orientations"] = orientations_of(writer);
  const std::string name = writer.add("summary", "json");
  summary["warnings"] = warnings_of(writer);
  summary["files"] = writer.files;
  errno = 0;
  std::ofstream file(writer.folder.path(name), std::ios::binary);
  file << summary.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  file.close();
  if (!file) fail_output("write", writer.folder.path(name), errno);
}

}  // namespace clray::io
