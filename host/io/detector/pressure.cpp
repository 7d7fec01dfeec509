// SPDX-License-Identifier: Apache-2.0
// Radiation pressure in files and on the terminal: pressure.csv (a row per Sun direction or orientation) and
// pressure.png (a map over azimuth and elevation where there are many directions, curves over time for a motion); files
// for each band where there are several. Coefficients C = F c / E in m², torques about the reference point in m³, body
// frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "clray/constants.hpp"
#include "clray/write.hpp"
#include "io/detector/room.hpp"
#include "io/detector/words.hpp"
#include "io/netcdf/records.hpp"
#include "io/summary_entries.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Group = std::vector<const PressureResult*>;

/// An angle of a grid as it was asked for: what a unit vector gives differs from it by rounding.
double of_grid(double angle, double first, double steps_per_turn) {
  const double exact = first + std::round((angle - first) * steps_per_turn / 360.0) * 360.0 / steps_per_turn;
  return steps_per_turn > 0.0 && std::fabs(angle - exact) < 1e-9 ? exact : angle;
}

double azimuth_deg(const Vec3& s) {
  return s.x == 0.0 && s.y == 0.0 ? 0.0 : std::atan2(s.y, s.x) * constants::kDegrees;
}
double elevation_deg(const Vec3& s) {
  return std::atan2(s.z, std::sqrt(s.x * s.x + s.y * s.y)) * constants::kDegrees;
}
double length(const Vec3& v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

std::string title_of(const Writer& writer, const ResultKey& key) {
  return writer.title("pressure", key) + (key.band.empty() ? "" : ", " + key.band + " nm");
}

struct GridSteps {
  double azimuths = 0.0, elevations = 0.0;
};

GridSteps grid_of(const Writer& writer, const ResultKey& key) {
  const DetectorSpec* detector = writer.detector_of(key);
  if (detector == nullptr) return {};
  const auto steps = [&](const char* name) {
    const auto given = detector->parameters.find(name);
    return given == detector->parameters.end() ? 0.0 : given->second;
  };
  return {steps("azimuth_steps"), steps("elevation_steps")};
}

void pressure_table(Writer& writer, const Group& group, const std::string& stem) {
  auto table = writer.table(
      writer.add(stem, "csv"), "radiation force and torque of " + title_of(writer, group.front()->key),
      "sun: unit vector toward the source, body frame; angles deg; C = F c / E m^2; T = torque c / E m^3 about the "
      "reference point; absorbed m^2; *_error: one standard error");
  const Band& band = group.front()->band;
  // In the Earth's penumbra the light of a pass changes.
  const bool varies = std::any_of(group.begin(), group.end(), [&](const PressureResult* record) {
    return record->source_W_m2 != group.front()->source_W_m2;
  });
  if (band.low_nm < band.high_nm) {
    table.comment("light of " + rounded(band.low_nm, 6) + "-" + rounded(band.high_nm, 6) + " nm, " +
                  (varies ? "source_W_m2" : rounded(group.front()->source_W_m2, 6) + " W/m^2") + " of the source");
  }
  table.comment("force in N = C * irradiance / 299792458 m/s, with the irradiance of this light");
  std::vector<std::string> columns{"orientation", "time_s", "sun_x", "sun_y", "sun_z", "azimuth_deg", "elevation_deg"};
  for (const char* vector : {"C", "T"}) {
    const std::string unit = vector[0] == 'C' ? "_m2" : "_m3";
    for (const char* axis : {"x", "y", "z"}) columns.push_back(vector + std::string(axis) + unit);
    for (const char* axis : {"x", "y", "z"}) columns.push_back(vector + std::string(axis) + "_error" + unit);
  }
  columns.insert(columns.end(), {"absorbed_m2", "absorbed_error_m2"});
  if (varies) columns.push_back("source_W_m2");
  table.columns(columns);
  const GridSteps grid = grid_of(writer, group.front()->key);
  for (const auto* record : group) {
    table.cell(std::uint64_t{record->key.orientation}).cell(time_of(writer.result, record->key));
    table.cell(record->sun).cell(of_grid(azimuth_deg(record->sun), 0.0, grid.azimuths));
    table.cell(of_grid(elevation_deg(record->sun), -90.0, 2.0 * (grid.elevations - 1.0)));
    table.cell(record->coefficient_m2.value).cell(record->coefficient_m2.standard_error);
    table.cell(record->torque_coefficient_m3.value).cell(record->torque_coefficient_m3.standard_error);
    table.cell(record->absorbed_m2.value).cell(record->absorbed_m2.standard_error);
    if (varies) table.cell(record->source_W_m2);
    table.end_row();
  }
  table.close();
}

/// A direction of the map and |C| there.
struct Spot {
  double azimuth, elevation, size;
};

long micro(double degrees) {
  return std::lround(degrees * 1e6);
}

/// The group's directions, by elevation, then azimuth. A pole has one azimuth, and its value fills the row.
std::vector<Spot> spots_of(const Group& group) {
  std::vector<Spot> spots;
  std::map<long, double> azimuths;
  const auto pole = [](double elevation) { return std::abs(micro(elevation)) == 90000000; };
  for (const auto* record : group) {
    spots.push_back({azimuth_deg(record->sun), elevation_deg(record->sun), length(record->coefficient_m2.value)});
    if (!pole(spots.back().elevation)) azimuths[micro(spots.back().azimuth)] = spots.back().azimuth;
  }
  std::vector<Spot> all;
  for (const Spot& spot : spots) {
    if (!pole(spot.elevation) || azimuths.empty()) {
      all.push_back(spot);
      continue;
    }
    for (const auto& each : azimuths) all.push_back({each.second, spot.elevation, spot.size});
  }
  std::stable_sort(all.begin(), all.end(), [](const Spot& a, const Spot& b) {
    return micro(a.elevation) != micro(b.elevation) ? a.elevation < b.elevation : a.azimuth < b.azimuth;
  });
  return all;
}

bool even_grid(const std::vector<Spot>& spots) {
  std::map<long, int> azimuths, elevations;
  for (const Spot& spot : spots) {
    ++azimuths[micro(spot.azimuth)];
    ++elevations[micro(spot.elevation)];
  }
  const std::size_t columns = azimuths.size(), rows = elevations.size();
  return columns > 1 && rows > 1 && columns * rows == spots.size();
}

/// A map of |C|: tiles for a grid that is regular in both angles, points for any other set of directions.
void map_picture(Writer& writer, const Group& group, const std::string& stem) {
  const std::vector<Spot> spots = spots_of(group);
  const bool tiles = even_grid(spots);
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  plot.begin_data("map");
  for (const Spot& spot : spots) plot.point({spot.azimuth, spot.elevation, spot.size});
  plot.end_data();
  plot.line("set title " +
            gnuplot_text(title_of(writer, group.front()->key) + ": radiation force by direction of the Sun") +
            " font ',18'");
  plot.line("set xlabel 'azimuth of the Sun in the body frame (°)'; set ylabel 'elevation (°)'");
  plot.line("set cblabel '|C| = |F| c / E  (m²)' offset 1,0; unset key; unset grid; set xtics 45; set ytics 30");
  plot.line("set autoscale xfix; set autoscale yfix; set rmargin at screen 0.84; set tmargin at screen 0.92");
  plot.line(
      tiles ? "plot $map using 1:2:3 with image"
            : "set xrange [-185:185]; set yrange [-93:93]; plot $map using 1:2:3 with points pointtype 7 pointsize 2 "
              "linecolor palette");
  writer.draw(plot, name);
}

void time_picture(Writer& writer, const Group& group, const std::string& stem) {
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  plot.begin_data("force");
  for (const auto* record : group) {
    const Vec3 c = record->coefficient_m2.value, e = record->coefficient_m2.standard_error;
    plot.point({time_of(writer.result, record->key), c.x, c.y, c.z, e.x, e.y, e.z});
  }
  plot.end_data();
  plot.legend_beside();
  plot.line("set title " + gnuplot_text(title_of(writer, group.front()->key) + ": radiation force, body frame") +
            " font ',18'");
  plot.line("set xlabel 'time (s)'; set ylabel 'C = F c / E  (m²)'; set autoscale xfix; set tmargin at screen 0.92");
  plot.line("set offsets 0, 0, graph 0.03, graph 0.03; set style fill transparent solid 0.25 noborder");
  std::string command = "plot ";
  const char* const colours[] = {"#c8511b", "#2b8a3e", "#0b4f94"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string value = "$" + std::to_string(axis + 2), error = "$" + std::to_string(axis + 5);
    const std::string colour = std::string(" linecolor '") + colours[axis] + "'";
    command += std::string(axis ? ", " : "") + "$force using 1:(" + value + "-" + error + "):(" + value + "+" + error +
               ") with filledcurves" + colour + " notitle, $force using 1:" + std::to_string(axis + 2) + " with lines" +
               colour + " title 'C_" + "xyz"[axis] + "'";
  }
  plot.line(command);
  writer.draw(plot, name);
}

/// Whether all records are of one time, as those of a grid of Sun directions are; those of a motion are not.
bool one_instant(const Writer& writer, const Group& group) {
  const double first = time_of(writer.result, group.front()->key);
  return std::all_of(group.begin(), group.end(),
                     [&](const auto* record) { return time_of(writer.result, record->key) == first; });
}

/// Whole grids are written by their angles.
void grid_netcdf(Writer& writer, const Group& group, const std::string& stem) {
  const GridSteps grid = grid_of(writer, group.front()->key);
  std::vector<double> azimuths, elevations;
  if (static_cast<double>(group.size()) == grid.azimuths * (grid.elevations - 2.0) + 2.0 && grid.azimuths > 0.0) {
    for (double a = 0.0; a < grid.azimuths; ++a) azimuths.push_back(360.0 * a / grid.azimuths);
    for (double e = 0.0; e < grid.elevations; ++e) elevations.push_back(-90.0 + 180.0 * e / (grid.elevations - 1.0));
  }
  pressure_netcdf(writer, group, stem, azimuths, elevations);
}

void write_pressure(Writer& writer) {
  for (const auto& group : groups_by_band(writer.result.pressure)) {
    const ResultKey& key = group.front()->key;
    const std::string stem = writer.stem("pressure", key, true);
    pressure_table(writer, group, stem);
    if (writer.options.netcdf) grid_netcdf(writer, group, stem);
    if (!writer.options.plots || group.size() < 2) continue;
    if (one_instant(writer, group)) {
      map_picture(writer, group, stem);
    } else {
      time_picture(writer, group, stem);
    }
  }
}

Json pressure_entry(const PressureResult& record, const Scene& scene) {
  const auto& c = record.coefficient_m2;
  const auto& t = record.torque_coefficient_m3;
  Json entry = method_of(c);
  entry.update(
      {{"sun", vector(record.sun)},
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
       {"absorbed_m2", value_and_error(record.absorbed_m2)}});
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

void pressure_summary(SummaryEntries& entries) {
  entries.add(entries.writer.result.pressure,
              [&](const PressureResult& record) { return pressure_entry(record, entries.writer.scene); });
}

void pressure_totals(const Result& result, std::vector<Total>* all) {
  for (const auto& pressure : result.pressure) {
    const Vec3 c = pressure.coefficient_m2.value, e = pressure.coefficient_m2.standard_error;
    const double size = length(c);
    // The correlation of the components is not known; the sum of their shares bounds the error of the length.
    const double error = size > 0.0 ? (std::fabs(c.x) * e.x + std::fabs(c.y) * e.y + std::fabs(c.z) * e.z) / size : 0.0;
    all->push_back({pressure.key, size, error, "m2"});
  }
}

/// Of many directions the range of |C| says more than the first rows.
std::string force_span(const Result& result) {
  double low = length(result.pressure.front().coefficient_m2.value), high = low;
  for (const auto& p : result.pressure) {
    low = std::min(low, length(p.coefficient_m2.value));
    high = std::max(high, length(p.coefficient_m2.value));
  }
  return fmt::format("\n  pressure  {} directions: |C| = |F| c / E from {:.6g} to {:.6g} m²\n", result.pressure.size(),
                     low, high);
}

std::string force_table(const Result& result) {
  Columns table;
  table.add({"pressure", "", "x", "y", "z"});
  const auto three = [&](const std::string& name, const char* what, const VectorEstimate& v, double scale) {
    table.add({name, what, scaled(v, 0, scale), scaled(v, 1, scale), scaled(v, 2, scale)});
  };
  for (const auto& p : result.pressure) {
    three(record_name(p.key, result), "force coefficient C (m²)", p.coefficient_m2, 1.0);
    three("", "torque coefficient (m³)", p.torque_coefficient_m3, 1.0);
    three("", "force at 1361 W/m² (N)", p.coefficient_m2, constants::kSolarConstant_W_m2 / constants::kLightSpeed_m_s);
  }
  return "\n" + table.text("  ");
}

void show_pressure(const Result& result, ResultText* text) {
  if (result.pressure.empty()) return;
  text->tables += result.pressure.size() > kMostRows / 3 ? force_span(result) : force_table(result);
  for (const auto& p : result.pressure) {
    const VectorEstimate& c = p.coefficient_m2;
    text->totals += fmt::format("{}: C = {}, {}, {} m²\n", record_name(p.key, result), scaled(c, 0, 1.0),
                                scaled(c, 1, 1.0), scaled(c, 2, 1.0));
  }
}

}  // namespace

const RecordRoom kPressureRecords{write_pressure, pressure_summary, pressure_totals, show_pressure};

}  // namespace clray::io
