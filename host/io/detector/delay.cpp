// SPDX-License-Identifier: Apache-2.0
// The delay camera's records in files and on the terminal: delay.csv (one row per bin), delay.png (delay_pictures.hpp),
// and for several orientations delay-totals.csv and delay.fits (orientation x bin); with several bands, files for each.
// Delays in ns, densities in m²/sr per ns.
#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "clray/write.hpp"
#include "io/detector/delay_pictures.hpp"
#include "io/detector/room.hpp"
#include "io/detector/words.hpp"
#include "io/fits_file.hpp"
#include "io/netcdf/records.hpp"
#include "io/summary_entries.hpp"
#include "text/text.hpp"

namespace clray::io {

namespace {

using Group = std::vector<const DelayResult*>;

double at(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? values[i] : std::nan("");
}

void delay_row(TableFile& table, const DelayResult& delay, std::size_t bin, bool photons) {
  const double width_ns = delay.bin_width_s * 1e9;
  table.cell((delay.first_bin_start_s + (static_cast<double>(bin) + 0.5) * delay.bin_width_s) * 1e9);
  table.cell(delay.bin_m2_per_sr[bin] / width_ns).cell(at(delay.bin_standard_error, bin) / width_ns);
  if (bin < delay.hits.size()) {
    table.cell(delay.hits[bin]);
  } else {
    table.cell(std::string_view());  // an exact number needs no hits
  }
  const bool resolved = bin < delay.resolved.size() && delay.resolved[bin];
  table.cell(std::uint64_t{resolved});
  table.cell(resolved ? std::nan("") : at(delay.bin_upper_bound, bin) / width_ns);
  if (photons) table.cell(at(delay.photons_per_ns, bin));
  table.end_row();
}

void delay_table(Writer& writer, const Group& group, const std::string& stem) {
  const bool several = group.size() > 1, photons = !group.front()->photons_per_ns.empty();
  auto table =
      writer.table(writer.add(stem, "csv"), "delay histogram A(t) of " + delay_title(writer, group.front()->key),
                   "delay_ns: bin centres, ns after a path by way of the reference point; "
                   "intensity, standard_error and upper_bound: m^2/sr per ns" +
                       std::string(photons ? "; photons_per_ns: expected at the station" : ""));
  if (!several) {
    const auto& delay = *group.front();
    const Estimate& a = delay.intensity_m2_per_sr;
    table.comment("total_m2_per_sr: " + number(a.value) +
                  (a.exact() ? ", exact but for rounding below " + number(a.rounding_bound)
                             : " with standard error " + number(a.standard_error)) +
                  ", of which below the first bin " + number(delay.below_m2_per_sr) + " and above the last " +
                  number(delay.above_m2_per_sr));
    if (a.partly_exact()) {
      table.comment("first bounce: " + number(a.exact_part) + ", exact but for rounding below " +
                    number(a.rounding_bound) + "; standard_error and hits are of the light that rays found");
    }
  }
  table.comment("resolved: 0 where a bin was hit too seldom for its error to be trusted; it gets a 95 % upper_bound");
  std::vector<std::string> columns{"delay_ns",   "intensity_m2_per_sr_per_ns", "standard_error", "hits", "resolved",
                                   "upper_bound"};
  if (photons) columns.push_back("photons_per_ns");
  if (several) columns.insert(columns.begin(), {"orientation", "time_s"});
  table.columns(columns);
  for (const auto* delay : group) {
    for (std::size_t bin = 0; bin < delay->bin_m2_per_sr.size(); ++bin) {
      if (several) table.cell(std::uint64_t{delay->key.orientation}).cell(time_of(writer.result, delay->key));
      delay_row(table, *delay, bin, photons);
    }
  }
  table.close();
}

void totals_table(Writer& writer, const Group& group, const std::string& stem) {
  auto table = writer.table(
      writer.add(stem + "-totals", "csv"), "totals per orientation of " + delay_title(writer, group.front()->key),
      "time s; intensity m^2/sr; cross-section m^2; delays ns; low and high bound the 95 % interval");
  table.columns({"orientation", "time_s", "intensity_m2_per_sr", "standard_error", "low", "high", "cross_section_m2",
                 "mean_delay_ns", "mean_delay_standard_error_ns", "rms_width_ns", "rms_width_standard_error_ns"});
  for (const auto* delay : group) {
    const auto& a = delay->intensity_m2_per_sr;
    table.cell(std::uint64_t{delay->key.orientation}).cell(time_of(writer.result, delay->key));
    table.cell(a.value).cell(a.standard_error).cell(a.low).cell(a.high).cell(4.0 * constants::kPi * a.value);
    table.cell(delay->mean_delay_s.value * 1e9).cell(delay->mean_delay_s.standard_error * 1e9);
    table.cell(delay->rms_width_s.value * 1e9).cell(delay->rms_width_s.standard_error * 1e9);
    table.end_row();
  }
  table.close();
}

bool same_bins(const Group& group) {
  return std::all_of(group.begin(), group.end(), [&](const DelayResult* delay) {
    return delay->bin_m2_per_sr.size() == group.front()->bin_m2_per_sr.size() &&
           delay->first_bin_start_s == group.front()->first_bin_start_s &&
           delay->bin_width_s == group.front()->bin_width_s;
  });
}

void delay_fits(Writer& writer, const Group& group, const std::string& stem) {
  const auto& first = *group.front();
  const std::size_t bins = first.bin_m2_per_sr.size();
  const double width_ns = first.bin_width_s * 1e9;
  std::vector<double> values, errors, hits, photons;
  FitsColumn index{"ORIENTATION", "", {}, {}}, time{"TIME", "s", {}, {}}, total{"INTENSITY", "m2 sr-1", {}, {}},
      error{"STANDARD_ERROR", "m2 sr-1", {}, {}};
  for (const auto* delay : group) {
    for (std::size_t bin = 0; bin < bins; ++bin) {
      values.push_back(delay->bin_m2_per_sr[bin] / width_ns);
      errors.push_back(at(delay->bin_standard_error, bin) / width_ns);
      hits.push_back(bin < delay->hits.size() ? static_cast<double>(delay->hits[bin]) : 0.0);
      photons.push_back(at(delay->photons_per_ns, bin));
    }
    index.numbers.push_back(static_cast<double>(delay->key.orientation));
    time.numbers.push_back(time_of(writer.result, delay->key));
    total.numbers.push_back(delay->intensity_m2_per_sr.value);
    error.numbers.push_back(delay->intensity_m2_per_sr.standard_error);
  }
  const std::vector<FitsAxis> axes{{static_cast<long>(bins), "DELAY", "ns", 1.0,
                                    (first.first_bin_start_s + 0.5 * first.bin_width_s) * 1e9, width_ns},
                                   {static_cast<long>(group.size()), "ORIENTATION", "", 1.0, 0.0, 1.0}};
  FitsFile file(writer.folder.path(writer.add(stem, "fits")));
  file.image("DELAY", "m2 sr-1 ns-1", axes, values);
  file.history("clray " CLRAY_VERSION ": delay histograms A(t), one row per orientation");
  file.history("scene " + (writer.scene.path.empty() ? writer.scene.name : writer.scene.path));
  file.history("seed " + std::to_string(writer.result.seed) + ", digest " + hex16(writer.result.digest));
  file.image("STANDARD_ERROR", "m2 sr-1 ns-1", axes, errors);
  if (group.size() > kMostListed) {  // what delay.csv would say
    file.image("HITS", "", axes, hits);
    if (!first.photons_per_ns.empty()) file.image("PHOTONS_PER_NS", "ns-1", axes, photons);
  }
  file.table("ORIENTATIONS", {index, time, total, error});
  file.close();
}

void write_delay(Writer& writer) {
  for (const auto& group : groups_by_band(writer.result.delay)) {
    const ResultKey& key = group.front()->key;
    const std::string stem = writer.stem("delay", key, true);
    if (group.size() <= kMostListed || !same_bins(group)) delay_table(writer, group, stem);
    if (group.size() > 1) {
      totals_table(writer, group, stem);
      if (same_bins(group)) delay_fits(writer, group, stem);
    }
    if (writer.options.netcdf && same_bins(group)) delay_netcdf(writer, group, stem);
    if (!writer.options.plots) continue;
    if (group.size() > 1 && same_bins(group)) {
      delay_map_picture(writer, group, stem);
    } else {
      delay_pulse_picture(writer, *group.front(), stem);
    }
  }
}

Json delay_entry(const DelayResult& delay) {
  const auto& a = delay.intensity_m2_per_sr;
  std::size_t unresolved = 0;
  for (const auto resolved : delay.resolved) unresolved += !resolved;
  Json entry = method_of(a);
  entry.update({{"intensity_m2_per_sr", a.value},
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
                {"above_window_m2_per_sr", delay.above_m2_per_sr}});
  return entry;
}

void delay_summary(SummaryEntries& entries) {
  entries.add(entries.writer.result.delay, delay_entry);
}

void delay_totals(const Result& result, std::vector<Total>* all) {
  for (const auto& delay : result.delay)
    all->push_back({delay.key, delay.intensity_m2_per_sr.value, delay.intensity_m2_per_sr.standard_error, "m2/sr"});
}

void show_one(const DelayResult& delay, ResultText* text) {
  const auto& a = delay.intensity_m2_per_sr;
  text->rows.push_back({"A", amount_with_interval(a, "m²/sr")});
  text->rows.push_back({"cross-section", amount(a, 4.0 * constants::kPi, "m²")});
  text->rows.push_back({"mean delay", amount(delay.mean_delay_s, 1e9, "ns")});
  text->rows.push_back({"rms width", amount(delay.rms_width_s, 1e9, "ns")});
}

std::string table_of_all(const Result& result) {
  Columns table;
  table.add({"delay", "A (m²/sr)", "cross-section (m²)", "mean delay (ns)", "rms width (ns)"});
  for (std::size_t i = 0; i < std::min(result.delay.size(), kMostRows); ++i) {
    const auto& delay = result.delay[i];
    table.add({record_name(delay.key, result), scaled(delay.intensity_m2_per_sr, 1.0),
               scaled(delay.intensity_m2_per_sr, 4.0 * constants::kPi), scaled(delay.mean_delay_s, 1e9),
               scaled(delay.rms_width_s, 1e9)});
  }
  return "\n" + table.text("  ") + more_rows(result.delay.size());
}

void show_delay(const Result& result, ResultText* text) {
  if (result.delay.size() == 1) show_one(result.delay.front(), text);
  if (result.delay.size() > 1) text->tables += table_of_all(result);
  for (const auto& delay : result.delay)
    text->totals += record_name(delay.key, result) + ": A = " + amount(delay.intensity_m2_per_sr, 1.0, "m²/sr") + "\n";
}

}  // namespace

const RecordRoom kDelayRecords{write_delay, delay_summary, delay_totals, show_delay};

}  // namespace clray::io
