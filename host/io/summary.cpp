// SPDX-License-Identifier: Apache-2.0
// summary.json: what ran, on what, how long, what was found with which error. NaN and infinities become null. Results
// are keyed by detector, then observer and variant where there are several; units are in the names.
#include <cerrno>
#include <cmath>
#include <set>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "io/detector/room.hpp"
#include "io/summary_entries.hpp"
#include "io/writer.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

/// Where a list too long for the summary is.
Json table_of(const std::string& file, std::size_t count) {
  return {{"file", file}, {"count", count}};
}

Json totals_table(Writer& writer, const std::vector<Total>& all) {
  const std::string name = writer.add("totals", "csv");
  auto table = writer.table(name, "totals of " + writer.scene_name(), "value and standard_error in the row's unit");
  table.columns(
      {"detector", "observer", "variant", "band", "orientation", "sum", "number", "value", "standard_error", "unit"});
  for (const Total& total : all) {
    const ResultKey& key = total.key;
    for (const std::string* word : {&key.detector, &key.observer, &key.variant, &key.band})
      table.cell(std::string_view(*word));
    table.cell(std::uint64_t{key.orientation}).cell(std::string_view(total.sum)).cell(total.number);
    table.cell(total.value).cell(total.standard_error).cell(std::string_view(total.unit)).end_row();
  }
  table.close();
  return table_of(name, all.size());
}

Json totals_of(Writer& writer) {
  const std::vector<Total> all = totals(writer.result);
  if (writer.result.orientations.size() > kMostListed) return totals_table(writer, all);
  Json list = Json::array();
  for (const auto& total : all) {
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
            {"rays", r.rays != 0 ? Json(r.rays) : Json()},
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

Json orientations_table(Writer& writer) {
  const auto& all = writer.result.orientations;
  const std::string name = writer.add("orientations", "csv");
  auto table = writer.table(name, "orientations of " + writer.scene_name(),
                            "time_s: s; qw to qz: attitude, body to space; source, observer: unit vectors, body frame");
  std::vector<std::string> columns{"orientation", "time_s", "qw", "qx", "qy", "qz", "source_x", "source_y", "source_z"};
  for (std::size_t i = 0; i < all.front().observers.size(); ++i) {
    for (const char* axis : {"_x", "_y", "_z"}) columns.push_back("observer" + std::to_string(i + 1) + axis);
  }
  table.columns(columns);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& q = all[i].body_to_space;
    table.cell(std::uint64_t{i}).cell(all[i].time_s).cell(q.w).cell(q.x).cell(q.y).cell(q.z).cell(all[i].source);
    for (const auto& observer : all[i].observers) table.cell(observer);
    table.end_row();
  }
  table.close();
  return table_of(name, all.size());
}

Json orientations_of(Writer& writer) {
  if (writer.result.orientations.size() > kMostListed) return orientations_table(writer);
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
    const double error = relative_true_error(r, *writer.reference);
    summary["relative_true_error"] = error;
    if (std::isnan(error))
      writer.warnings.push_back("there is no true error: " + writer.reference->file + " has none of these totals");
  }
  SummaryEntries entries(writer);
  for (const RecordRoom* room : record_rooms()) room->summary(entries);
  summary["detectors"] = entries.detectors;
  if (Json curves = light_curves_entry(writer); !curves.empty()) summary["light_curves"] = std::move(curves);
  summary["totals"] = totals_of(writer);
  for (const auto& part : more) {
    if (part.summary_key.empty()) continue;
    Json entry = Json::parse(part.summary_json, nullptr, false);
    if (entry.is_discarded())
      throw Error(ErrorCode::usage, "summary_json is not JSON", "MoreFiles." + part.summary_key);
    summary[part.summary_key] = std::move(entry);
  }
  if (!r.instants.empty()) summary["pass"] = pass_entry(r);
  summary["orientations"] = orientations_of(writer);
  const std::string name = writer.add("summary", "json");
  summary["warnings"] = warnings_of(writer);
  summary["files"] = writer.files;
  write_output_file(writer.folder.path(name),
                    shown_json(summary.dump(2, ' ', false, Json::error_handler_t::replace)) + '\n');
}

}  // namespace clray::io
