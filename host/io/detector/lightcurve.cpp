// SPDX-License-Identifier: Apache-2.0
// Light curves from a result's records, their table and their entry in the summary; see lightcurve.hpp. The pictures
// are in lightcurve_picture.cpp.
#include "io/detector/lightcurve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "clray/constants.hpp"
#include "ephemeris/epoch.hpp"
#include "io/detector/lightcurve_picture.hpp"
#include "io/netcdf/records.hpp"
#include "text/text.hpp"

namespace clray::io {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kStandardRange_m = 1e6, kStandardPhase_deg = 90.0, kCell_deg = 5.0;

/// Records by band in order of first appearance, each in the order of its orientations.
std::vector<std::vector<const SpectrometerResult*>> by_band(const std::vector<const SpectrometerResult*>& group) {
  std::vector<std::vector<const SpectrometerResult*>> bands;
  std::map<std::string, std::size_t> place;
  for (const auto* record : group) {
    const auto [entry, is_new] = place.emplace(band_name(*record), bands.size());
    if (is_new) bands.emplace_back();
    bands[entry->second].push_back(record);
  }
  return bands;
}

/// The site from which an observer looks at an instant, or null: its own, or the station that shines.
const SiteSight* sight_of(const PassInstant& instant, const Scene& scene, std::size_t observer) {
  for (const SiteSight& sight : instant.sites) {
    if (sight.observer == static_cast<int>(observer)) return &sight;
    if (sight.observer < 0 && at_source(scene.observers[observer], scene.source)) return &sight;
  }
  return nullptr;
}

LightCurveRow row_of(const Writer& writer, const SpectrometerResult& record,
                     const std::vector<const PassInstant*>& instants) {
  LightCurveRow row;
  row.record = &record;
  const std::size_t o = record.key.orientation, observer = observer_of(writer.scene, record.key);
  if (o < instants.size()) row.instant = instants[o];
  if (row.instant != nullptr) row.sight = sight_of(*row.instant, writer.scene, observer);
  const std::vector<Orientation>& views = writer.result.orientations;
  const double range = o < views.size() && observer < views[o].ranges_m.size() ? views[o].ranges_m[observer] : 0.0;
  row.range_m = range > 0.0 ? range : kNan;
  row.standard_AB = record.magnitude_AB - record.extinction_mag - 5.0 * std::log10(row.range_m / kStandardRange_m);
  row.standard_90_AB = kNan;
  return row;
}

PhaseCurve phase_curve(const std::vector<LightCurveRow>& rows) {
  struct Cell {
    double phase = 0.0, magnitude = 0.0, variance = 0.0, count = 0.0;
  };
  std::map<int, Cell> cells;
  PhaseCurve curve;
  for (const LightCurveRow& row : rows) {
    if (!std::isfinite(row.standard_AB)) continue;
    const double phase = row.record->phase_angle_rad * constants::kDegrees;
    curve.least_deg = cells.empty() ? phase : std::min(curve.least_deg, phase);
    curve.most_deg = cells.empty() ? phase : std::max(curve.most_deg, phase);
    Cell& cell = cells[static_cast<int>(std::floor(phase / kCell_deg))];
    cell.phase += phase;
    cell.magnitude += row.standard_AB;
    cell.variance += row.record->magnitude_standard_error * row.record->magnitude_standard_error;
    cell.count += 1.0;
  }
  for (const auto& entry : cells) {
    const Cell& cell = entry.second;
    curve.phase_deg.push_back(cell.phase / cell.count);
    curve.magnitude_AB.push_back(cell.magnitude / cell.count);
    curve.standard_error.push_back(std::sqrt(cell.variance) / cell.count);
  }
  return curve;
}

/// The magnitude at 90 degrees, of the band and of each row, or why there is none.
void standardise(BandCurve* band) {
  const PhaseCurve& phases = band->phases = phase_curve(band->rows);
  band->at_90_AB = band->at_90_error = kNan;
  if (phases.phase_deg.empty()) {
    band->why_not = "no instant has a magnitude";
  } else if (!phases.covers(kStandardPhase_deg)) {
    band->why_not = fmt::format("the phase angles go from {:.4g} to {:.4g} deg", phases.least_deg, phases.most_deg);
  } else {
    band->at_90_AB = phases.at(kStandardPhase_deg, &band->at_90_error);
    for (LightCurveRow& row : band->rows) {
      const double phase = row.record->phase_angle_rad * constants::kDegrees;
      row.standard_90_AB = row.standard_AB - phases.at(phase) + band->at_90_AB;
    }
  }
}

const std::vector<std::string> kColumns{"orientation",
                                        "time_utc",
                                        "mjd",
                                        "time_s",
                                        "band",
                                        "magnitude_AB",
                                        "magnitude_Vega",
                                        "magnitude_error",
                                        "magnitude_1000km_AB",
                                        "magnitude_1000km_Vega",
                                        "magnitude_1000km_90deg_AB",
                                        "magnitude_1000km_90deg_Vega",
                                        "intensity_m2_per_sr",
                                        "intensity_error",
                                        "phase_angle_deg",
                                        "range_m",
                                        "elevation_deg",
                                        "azimuth_deg",
                                        "air_mass",
                                        "extinction_mag",
                                        "light_x",
                                        "light_y",
                                        "light_z",
                                        "observer_x",
                                        "observer_y",
                                        "observer_z",
                                        "sun_share",
                                        "lit_share"};

void table_row(TableFile& table, const Writer& writer, const BandCurve& band, const LightCurveRow& row) {
  const SpectrometerResult& s = *row.record;
  const std::size_t o = s.key.orientation;
  table.cell(std::uint64_t{o}).cell(row.instant != nullptr ? ephemeris::iso_text(row.instant->epoch) : "");
  if (row.instant != nullptr) {
    table.cell(fmt::format("{:.10f}", ephemeris::mjd_of(row.instant->epoch)));
  } else {
    table.cell(kNan);
  }
  table.cell(time_of(writer.result, s.key)).cell(std::string_view(band.name));
  table.cell(s.magnitude_AB).cell(s.magnitude_Vega).cell(s.magnitude_standard_error);
  for (const double magnitude : {row.standard_AB, row.standard_90_AB})
    table.cell(magnitude).cell(magnitude - band.AB_minus_Vega);
  table.cell(s.intensity_m2_per_sr.value).cell(s.intensity_m2_per_sr.standard_error);
  table.cell(s.phase_angle_rad * constants::kDegrees).cell(row.range_m);
  table.cell(row.sight != nullptr ? row.sight->elevation_rad * constants::kDegrees : kNan);
  table.cell(row.sight != nullptr ? row.sight->azimuth_rad * constants::kDegrees : kNan);
  table.cell(s.air_mass).cell(s.extinction_mag);
  const std::vector<Orientation>& views = writer.result.orientations;
  const std::size_t observer = observer_of(writer.scene, s.key);
  const bool placed = o < views.size() && observer < views[o].observers.size();
  table.cell(placed ? views[o].source : Vec3(kNan)).cell(placed ? views[o].observers[observer] : Vec3(kNan));
  table.cell(row.instant != nullptr ? row.instant->sun_share : kNan);
  table.cell(0.5 * (1.0 + std::cos(s.phase_angle_rad)));
  table.end_row();
}

}  // namespace

std::size_t observer_of(const Scene& scene, const ResultKey& key) {
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    if (scene.observers[i].name == key.observer) return i;
  }
  return 0;
}

std::string band_name(const SpectrometerResult& record) {
  const std::string& name = record.key.band.empty() ? record.band.name : record.key.band;
  return !name.empty() ? name : rounded(record.band.low_nm, 6) + "-" + rounded(record.band.high_nm, 6);
}

std::string band_label(const SpectrometerResult& record) {
  const std::string name = band_name(record);
  return name.find_first_not_of("0123456789.-") == std::string::npos ? name + " nm" : name;
}

double PhaseCurve::at(double deg, double* error) const {
  std::size_t i = 0;
  while (i + 2 < phase_deg.size() && phase_deg[i + 1] < deg) ++i;
  const std::size_t j = std::min(i + 1, phase_deg.size() - 1);
  const double t = j > i ? (deg - phase_deg[i]) / (phase_deg[j] - phase_deg[i]) : 0.0;
  if (error != nullptr)
    *error = j > i ? std::hypot((1.0 - t) * standard_error[i], t * standard_error[j]) : standard_error[i];
  return (1.0 - t) * magnitude_AB[i] + t * magnitude_AB[j];
}

bool PhaseCurve::covers(double deg) const {
  constexpr double kRounding_deg = 1e-6;
  return !phase_deg.empty() && least_deg <= deg + kRounding_deg && most_deg >= deg - kRounding_deg;
}

std::vector<LightCurve> light_curves(const Writer& writer) {
  const std::vector<const PassInstant*> instants = traced_instants(writer.result);
  std::vector<LightCurve> all;
  for (const auto& group : groups(writer.result.spectrometer)) {
    if (group.back()->key.orientation == group.front()->key.orientation) continue;
    LightCurve curve;
    curve.key = group.front()->key;
    for (const auto& records : by_band(group)) {
      BandCurve band;
      band.name = band_name(*records.front());
      band.AB_minus_Vega = kNan;
      for (const SpectrometerResult* record : records) {
        const double difference = record->magnitude_AB - record->magnitude_Vega;
        if (std::isfinite(difference)) band.AB_minus_Vega = difference;
        const LightCurveRow row = row_of(writer, *record, instants);
        if (row.sight == nullptr || row.sight->seen) band.rows.push_back(row);
      }
      standardise(&band);
      curve.bands.push_back(std::move(band));
    }
    all.push_back(std::move(curve));
  }
  return all;
}

void write_light_curve(Writer& writer, const LightCurve& curve) {
  const std::string stem = writer.stem("lightcurve", curve.key);
  TableFile table = writer.table(
      writer.add(stem, "csv"), "light curve of " + writer.title("spectrometer", curve.key),
      "time_s s; magnitude at the range of the instant, behind the extinction; magnitude_1000km above the atmosphere "
      "at 1000 km; magnitude_1000km_90deg also at the phase angle 90 deg by the band's own curve; *_error: one "
      "standard "
      "error; phase angle source - body - observer; light and observer: unit vectors away from the body, body frame; "
      "sun_share of the Sun's disk past the Earth; lit_share of a sphere's disk at the phase angle");
  for (const BandCurve& band : curve.bands) {
    if (!band.why_not.empty())
      table.comment("no magnitude_1000km_90deg of the band " + band.name + ": " + band.why_not);
  }
  table.columns(kColumns);
  std::size_t most = 0;
  for (const BandCurve& band : curve.bands) most = std::max(most, band.rows.size());
  for (std::size_t i = 0; i < most; ++i) {
    for (const BandCurve& band : curve.bands) {
      if (i < band.rows.size()) table_row(table, writer, band, band.rows[i]);
    }
  }
  table.close();
  if (writer.options.netcdf && most > 0) light_curve_netcdf(writer, curve, stem);
  if (writer.options.plots && most > 0) light_curve_picture(writer, curve, stem);
}

Json light_curves_entry(const Writer& writer) {
  Json list = Json::array();
  for (const LightCurve& curve : light_curves(writer)) {
    for (const BandCurve& band : curve.bands) {
      Json entry{{"detector", curve.key.detector},
                 {"observer", curve.key.observer},
                 {"variant", curve.key.variant},
                 {"band", band.name},
                 {"instants", band.rows.size()},
                 {"phase_angle_deg", {band.phases.least_deg, band.phases.most_deg}},
                 {"magnitude_1000km_90deg_AB", band.at_90_AB},
                 {"magnitude_1000km_90deg_Vega", band.at_90_AB - band.AB_minus_Vega},
                 {"standard_error", band.at_90_error}};
      if (!band.why_not.empty()) entry["why_not"] = band.why_not;
      list.push_back(std::move(entry));
    }
  }
  return list;
}

}  // namespace clray::io
