// SPDX-License-Identifier: Apache-2.0
// pass.csv: every instant of a pass, traced or not, and its entry in the summary. Times in UTC, lengths in m, angles in
// degrees; azimuths from north over east.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "clray/constants.hpp"
#include "ephemeris/epoch.hpp"
#include "io/netcdf/records.hpp"
#include "io/summary_entries.hpp"
#include "io/writer.hpp"

namespace clray::io {

namespace {

/// As part of a column's name: the observer's name without blanks.
std::string column_of(std::string name) {
  for (char& c : name) {
    if (c == ' ' || c == ',' || c == '"' || static_cast<unsigned char>(c) < ' ') c = '_';
  }
  return name.empty() ? "" : "_" + name;
}

std::string site_column(const Scene& scene, int observer) {
  if (observer < 0) return "_station";
  return column_of(scene.observers[static_cast<std::size_t>(observer)].name);
}

std::vector<std::string> columns_of(const Scene& scene, const std::vector<int>& sites) {
  std::vector<std::string> names{"time_utc", "mjd", "time_s", "orientation", "reason", "sun_share"};
  for (const char* what :
       {"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "light_x", "light_y", "light_z", "sun_x", "sun_y", "sun_z"})
    names.push_back(what);
  for (const Observer& observer : scene.observers) {
    const std::string name = column_of(observer.name);
    for (const char* what : {"observer_x", "observer_y", "observer_z", "phase_deg"}) names.push_back(what + name);
  }
  for (const int site : sites) {
    const std::string name = site_column(scene, site);
    for (const char* what : {"range_m", "elevation_deg", "azimuth_deg", "seen", "sun_elevation_deg", "daylight"})
      names.push_back(what + name);
  }
  return names;
}

}  // namespace

std::vector<const PassInstant*> traced_instants(const Result& result) {
  std::vector<const PassInstant*> traced;
  if (!result.instants.empty()) traced.resize(result.orientations.size(), nullptr);
  for (const PassInstant& instant : result.instants) {
    if (instant.traced()) traced[instant.orientation] = &instant;
  }
  return traced;
}

std::vector<int> sites_of(const Result& result) {
  std::vector<int> sites;
  for (const PassInstant& instant : result.instants) {
    if (!instant.placed) continue;
    for (const SiteSight& sight : instant.sites) sites.push_back(sight.observer);
    break;
  }
  return sites;
}

double phase_rad(const Orientation& view, std::size_t observer) {
  const Vec3 &s = view.source, &o = view.observers[observer];
  return std::atan2(glm::length(glm::cross(s, o)), glm::dot(s, o));
}

void write_pass(Writer& writer) {
  const std::vector<PassInstant>& instants = writer.result.instants;
  if (instants.empty()) return;
  const std::vector<int> sites = sites_of(writer.result);
  TableFile table = writer.table(
      writer.add("pass", "csv"), "instants of a pass; without an orientation they are not traced, for the reason given",
      "time_s from the pass's start; x, y, z of the body and q (body to space, Hamilton) in gcrf; light, sun and "
      "observers: unit vectors away from the body, body frame; sun_share of the Sun's disk past the Earth; azimuth "
      "from "
      "north over east; no refraction; daylight: the Sun is above -0.833 deg");
  const std::vector<std::string> columns = columns_of(writer.scene, sites);
  table.columns(columns);
  for (const PassInstant& i : instants) {
    table.cell(ephemeris::iso_text(i.epoch)).cell(fmt::format("{:.10f}", ephemeris::mjd_of(i.epoch))).cell(i.time_s);
    table.cell(i.traced() ? fmt::format("{}", i.orientation) : "").cell(i.reason);
    if (!i.placed) {
      for (std::size_t c = 5; c < columns.size(); ++c) table.cell("");
      table.end_row();
      continue;
    }
    const Quaternion& q = i.view.body_to_space;
    table.cell(i.sun_share).cell(i.position_m).cell(q.w).cell(q.x).cell(q.y).cell(q.z);
    table.cell(i.view.source).cell(i.sun);
    for (std::size_t o = 0; o < i.view.observers.size(); ++o)
      table.cell(i.view.observers[o]).cell(phase_rad(i.view, o) * constants::kDegrees);
    for (const SiteSight& s : i.sites) {
      table.cell(s.range_m)
          .cell(s.elevation_rad * constants::kDegrees)
          .cell(s.azimuth_rad * constants::kDegrees)
          .cell(s.seen ? "1" : "0");
      table.cell(s.sun_elevation_rad * constants::kDegrees).cell(s.daylight ? "1" : "0");
    }
    table.end_row();
  }
  table.close();
  if (writer.options.netcdf) pass_netcdf(writer);
}

Json pass_entry(const Result& result) {
  const auto traced = std::count_if(result.instants.begin(), result.instants.end(),
                                    [](const PassInstant& instant) { return instant.traced(); });
  Json reasons = Json::object();
  for (const PassInstant& instant : result.instants) {
    if (instant.traced()) continue;
    reasons[instant.reason] = reasons.value(instant.reason, 0) + 1;
  }
  return {{"start", ephemeris::iso_text(result.instants.front().epoch)},
          {"stop", ephemeris::iso_text(result.instants.back().epoch)},
          {"instants", result.instants.size()},
          {"traced", traced},
          {"not_traced", reasons}};
}

}  // namespace clray::io
