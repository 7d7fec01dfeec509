// SPDX-License-Identifier: Apache-2.0
// The one-pixel spectrometer in files and on the terminal: spectrum.csv/.png (per band), and for several orientations
// light curves (lightcurve.hpp). Intensities in m²/sr, received flux in W/m², magnitudes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "clray/write.hpp"
#include "io/detector/lightcurve.hpp"
#include "io/detector/room.hpp"
#include "io/detector/words.hpp"
#include "io/netcdf/records.hpp"
#include "io/summary_entries.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Group = std::vector<const SpectrometerResult*>;

void spectrum_table(Writer& writer, const Group& group, const std::string& stem, bool moving) {
  auto table = writer.table(
      writer.add(stem, "csv"), "intensity per wavelength band of " + writer.title("spectrometer", group.front()->key),
      "wavelengths nm; intensity m^2/sr per unit irradiance in the band; source and received W/m^2 in the "
      "band; magnitude AB: 0 is what 3631 Jy at every frequency gives through the same band, in energy; magnitude "
      "Vega: Vega's own is 0.03 in B V R I, else 0");
  table.comment("received_W_m2 is 0 and magnitudes are nan where the scene states no range");
  std::vector<std::string> columns{"band",
                                   "low_nm",
                                   "high_nm",
                                   "intensity_m2_per_sr",
                                   "standard_error",
                                   "source_W_m2",
                                   "received_W_m2",
                                   "received_standard_error",
                                   "magnitude_AB",
                                   "magnitude_Vega",
                                   "magnitude_standard_error"};
  if (moving) columns.insert(columns.begin(), {"orientation", "time_s", "phase_angle_deg"});
  table.columns(columns);
  for (const auto* record : group) {
    if (moving) {
      table.cell(std::uint64_t{record->key.orientation}).cell(time_of(writer.result, record->key));
      table.cell(record->phase_angle_rad * constants::kDegrees);
    }
    table.cell(std::string_view(band_name(*record))).cell(record->band.low_nm).cell(record->band.high_nm);
    table.cell(record->intensity_m2_per_sr.value).cell(record->intensity_m2_per_sr.standard_error);
    table.cell(record->source_W_m2).cell(record->received_W_m2).cell(record->received_W_m2_standard_error);
    table.cell(record->magnitude_AB).cell(record->magnitude_Vega).cell(record->magnitude_standard_error);
    table.end_row();
  }
  table.close();
}

void spectrum_picture(Writer& writer, const Group& group, const std::string& stem) {
  const std::string name = writer.add(stem, "png");
  Plot plot(name);
  plot.begin_data("bands");
  double high = 0.0;
  for (const auto* record : group) {
    const double middle = 0.5 * (record->band.low_nm + record->band.high_nm);
    const auto& a = record->intensity_m2_per_sr;
    high = std::max(high, a.value + a.standard_error);
    plot.point({middle, a.value, record->band.low_nm, record->band.high_nm, a.value - a.standard_error,
                a.value + a.standard_error});
  }
  plot.end_data();
  plot.line("set title " + gnuplot_text(writer.title("spectrometer", group.front()->key) + ": intensity per band") +
            " font ',18'");
  plot.line("set xlabel 'wavelength (nm)'; set ylabel 'A  (m² sr⁻¹)'; set tmargin at screen 0.92; set bars small");
  plot.line("set yrange [0:" + number(high > 0.0 ? high * 1.15 : 1.0) + "]; set offsets graph 0.03, graph 0.03, 0, 0");
  plot.line(
      "plot $bands using 1:2:3:4:5:6 with xyerrorbars pointtype 7 pointsize 0.8 linecolor '#0b4f94' "
      "title 'band, ± 1 standard error'");
  writer.draw(plot, name);
}

void write_spectrometer(Writer& writer) {
  for (const auto& group : groups(writer.result.spectrometer)) {
    const ResultKey& key = group.front()->key;
    const bool moving = group.back()->key.orientation != key.orientation;
    const std::string spectrum = writer.stem("spectrum", key);
    spectrum_table(writer, group, spectrum, moving);
    if (writer.options.netcdf) spectrum_netcdf(writer, group, spectrum);
    if (!moving && writer.options.plots) spectrum_picture(writer, group, spectrum);
  }
  for (const LightCurve& curve : light_curves(writer)) write_light_curve(writer, curve);
}

Json spectrometer_entry(const SpectrometerResult& record) {
  Json entry = method_of(record.intensity_m2_per_sr);
  entry.update({{"low_nm", record.band.low_nm},
                {"high_nm", record.band.high_nm},
                {"intensity_m2_per_sr", record.intensity_m2_per_sr.value},
                {"standard_error", record.intensity_m2_per_sr.standard_error},
                {"confidence_95", {record.intensity_m2_per_sr.low, record.intensity_m2_per_sr.high}},
                {"relative_variance_of_variance", record.intensity_m2_per_sr.relative_variance_of_variance},
                {"source_W_m2", record.source_W_m2},
                {"received_W_m2", record.received_W_m2},
                {"received_standard_error", record.received_W_m2_standard_error},
                {"magnitude_AB", record.magnitude_AB},
                {"magnitude_Vega", record.magnitude_Vega},
                {"magnitude_standard_error", record.magnitude_standard_error},
                {"phase_angle_deg", record.phase_angle_rad * 180.0 / constants::kPi}});
  return entry;
}

void spectrometer_summary(SummaryEntries& entries) {
  entries.add(entries.writer.result.spectrometer, spectrometer_entry);
}

void spectrometer_totals(const Result& result, std::vector<Total>* all) {
  for (const auto& s : result.spectrometer)
    all->push_back({s.key, s.intensity_m2_per_sr.value, s.intensity_m2_per_sr.standard_error, "m2/sr"});
}

void show_spectrometer(const Result& result, ResultText* text) {
  if (result.spectrometer.empty()) return;
  Columns table;
  table.add({"spectrometer", "band", "A (m²/sr)", "received (W/m²)", "AB magnitude", "Vega", "phase angle (°)"});
  for (std::size_t i = 0; i < std::min(result.spectrometer.size(), kMostRows); ++i) {
    const auto& s = result.spectrometer[i];
    ResultKey key = s.key;
    key.band.clear();
    const std::string magnitude = format_with_error(s.magnitude_AB, s.magnitude_standard_error);
    const char* const nothing = s.intensity_m2_per_sr.value == 0.0 ? "n/a"
                                : std::isnan(s.extinction_mag)     ? "n/a (below the horizon)"
                                                                   : "n/a (no range)";
    table.add({record_name(key, result), band_label(s), scaled(s.intensity_m2_per_sr, 1.0),
               s.received_W_m2 > 0.0 ? format_with_error(s.received_W_m2, s.received_W_m2_standard_error) : nothing,
               magnitude, std::isfinite(s.magnitude_Vega) ? rounded(s.magnitude_Vega, 6) : "n/a",
               fmt::format("{:.4g}", s.phase_angle_rad * constants::kDegrees)});
  }
  text->tables += "\n" + table.text("  ") + more_rows(result.spectrometer.size());
  for (const auto& s : result.spectrometer)
    text->totals += record_name(s.key, result) + ": A = " + amount(s.intensity_m2_per_sr, 1.0, "m²/sr") + "\n";
}

}  // namespace

const RecordRoom kSpectrometerRecords{write_spectrometer, spectrometer_summary, spectrometer_totals, show_spectrometer};

}  // namespace clray::io
