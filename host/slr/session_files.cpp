// SPDX-License-Identifier: Apache-2.0
// The files of a session: observations.csv, .crd and .png, its entry in the summary, and what a person is told of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/write.hpp"
#include "shared/photon.h"
#include "slr/crd.hpp"
#include "slr/link.hpp"
#include "slr/normal_point_file.hpp"
#include "slr/scatter_plot.hpp"
#include "slr/session.hpp"
#include "text/columns.hpp"
#include "text/file_names.hpp"
#include "text/gnuplot.hpp"
#include "text/text.hpp"

namespace clray::slr {

namespace {

constexpr double kArcsecPerRad = 206264.80624709636;
constexpr double kSupplements_s = 60.0, kAngles_s = 10.0;  // between records
constexpr std::size_t kMostObservations = 20000000;        // that are kept for normal points, 40 bytes each

/// A name as the formats want it in a record: no blanks, at most ten characters.
std::string word(const std::string& name, std::size_t most = 10) {
  std::string text;
  for (const char c : name) text += c > ' ' && c < 127 ? c : '_';
  return text.empty() ? "na" : text.substr(0, most);
}

CrdHeader crd_header(const Session& session, const Scene& scene, std::uint64_t first, std::uint64_t last) {
  const Station& s = *scene.station;
  CrdHeader h;
  h.produced = production_epoch();
  h.start = session.ranges().epoch(session.time(first));
  h.stop = session.ranges().epoch(session.time(last));
  h.station = word(s.name);
  h.pad = fmt::format("{}", s.pad);
  h.system = fmt::format("{}", s.system);
  h.occupancy = fmt::format("{}", s.occupancy);
  h.network = word(s.network);
  h.pressure_hPa = s.pressure_hPa;
  h.temperature_K = s.temperature_K;
  h.humidity_percent = s.humidity_percent;
  h.target = word(scene.name);
  // Without a prediction the ranges are the scene's own, as of the session's start.
  const Date begin = date_of(h.start);
  h.prediction_year = fmt::format("{:02}", begin.year % 100);
  h.prediction_date = fmt::format("{:02}{:02}{:02}", begin.month, begin.day, begin.hour);
  h.prediction_source = "clray";
  h.prediction_sequence = "0";
  if (const Prediction* p = session.ranges().prediction()) {
    h.target = word(p->target);
    h.cospar = p->cospar;
    h.sic = p->sic;
    h.norad = p->norad;
    h.target_location = static_cast<int>(p->target_location);
    h.prediction_type = 1;
    h.prediction_year = fmt::format("{:02}", p->year % 100);
    h.prediction_date = fmt::format("{:02}{:02}{:02}", p->month, p->day, p->hour);
    h.prediction_source = p->source;
    h.prediction_sequence =
        p->version == 1 ? fmt::format("{:04}", p->sequence) : fmt::format("{:03}{:02}", p->sequence, p->sub_daily);
  }
  h.wavelength_nm = scene.source.wavelength_nm;
  h.rate_Hz = s.rate_Hz;
  h.pulse_energy_mJ = s.pulse_energy_J * 1e3;
  h.pulse_fwhm_ps = s.pulse.empty() ? s.pulse_fwhm_s * 1e12 : std::nan("");
  h.divergence_arcsec = 2.0 * s.divergence_rad * kArcsecPerRad;
  h.quantum_efficiency_percent = s.eta_q * 100.0;
  h.dark_kHz = s.dark_per_ns * 1e6;
  return h;
}

/// The rate of the range, by a central difference over 0.2 s, or less near the ends of the pass.
double range_rate(const Session& session, double since_s) {
  const double from = std::max(0.0, since_s - 0.1), to = std::min(session.last_since_s(), since_s + 0.1);
  if (!(to > from)) return 0.0;
  return (session.ranges().range_m(session.at(to)) - session.ranges().range_m(session.at(from))) / (to - from);
}

void csv_head(TextFile* csv, const Result& result, const Scene& scene, const Session& session) {
  const Epoch zero = session.ranges().zero();
  csv->text("# simulated laser ranging: one row for each shot that recorded a photon (clray " CLRAY_VERSION ")\n");
  csv->text("# epoch_s: time of fire, s after MJD ").text(std::to_string(zero.mjd)).text(" UTC + ");
  csv->decimal(zero.ps, 12).text(" s; flight_time_s: two-way; residual_ns: flight time minus 2 range/c\n");
  csv->text(fmt::format("# scene {}, seed {}, digest {:016x}, shots {} at {} Hz\n",
                        text::shown(scene.path.empty() ? scene.name : scene.path), result.seed, result.digest,
                        session.shots(), scene.station->rate_Hz));
  csv->text("epoch_s,flight_time_s,residual_ns,kind\n");
}

/// The picture of the shots from `start_s` to `stop_s` after the session's start.
ScatterPlot picture_of(const Session& session, const Station& station, double start_s, double stop_s) {
  const double half_gate = 0.5e9 * station.gate_s;
  auto [low, high] = session.signal_window_ns();
  const double margin = 0.6 * (high - low);
  low = std::max(low - margin, -half_gate);
  high = std::min(high + margin, half_gate);
  if (!(low < high)) {
    low = -half_gate;
    high = half_gate;
  }
  const double session_s = seconds_between({}, session.time(0));
  const text::TimeAxis axis = text::time_axis(session_s + start_s, session_s + stop_s);
  const double origin_s = seconds_between(instant_of(axis.zero_s), session.time(0));
  return ScatterPlot(start_s, stop_s, low, high, origin_s, axis.label);
}

}  // namespace

static SessionSummary write_files(Session& session, const Result& result, const Scene& scene, const std::string& folder,
                                  const SessionOptions& options) {
  const Station& station = *scene.station;
  const std::uint64_t first = std::min(options.first_shot, session.shots() - 1);
  const std::uint64_t wanted = options.shots == 0 ? session.shots() : options.shots;
  const std::uint64_t last = first + std::min(wanted, session.shots() - first) - 1;
  const std::string path = (folder.empty() ? std::string(".") : folder) + "/" + options.stem;
  TextFile csv(path + ".csv");
  csv_head(&csv, result, scene, session);
  const CrdHeader header = crd_header(session, scene, first, last);
  const auto supplement = [&](std::uint64_t shot) {
    return CrdSupplement{session.ranges().epoch(session.time(shot)).ps, range_rate(session, session.since_s(shot))};
  };
  CrdWriter crd(path + ".crd", header, supplement(first));
  ScatterPlot picture =
      picture_of(session, station, session.since_s(first), session.since_s(last) + 1.0 / station.rate_Hz);
  double next_supplement_s = session.since_s(first) + kSupplements_s, next_angles_s = session.since_s(first);
  std::vector<Observation> observations;
  const SessionSummary summary = session.run([&](const Shot& shot) {
    const bool signal = shot.kind == CLRAY_PHOTON_SIGNAL;
    const double flight_ps = 2.0 * shot.range_m / constants::kLightSpeed_m_s * 1e12 + shot.delay_ns * 1e3;
    const auto whole = static_cast<std::int64_t>(std::llround(flight_ps));
    csv.seconds(shot.time.s, shot.time.ps).text(",").decimal(whole, 12).text(",");
    csv.decimal(static_cast<std::int64_t>(std::llround(shot.delay_ns * 1e6)), 6);
    csv.text(signal ? ",signal" : ",noise").end_line();
    const double since_s = session.since_s(shot.number);
    if (since_s >= next_supplement_s) {
      crd.supplement(supplement(shot.number));
      next_supplement_s = since_s + kSupplements_s;
    }
    if (since_s >= next_angles_s) {
      if (const auto angles = angles_at(session, shot.number)) crd.angles(*angles);
      next_angles_s = since_s + kAngles_s;
    }
    if (station.normal_point_s > 0.0 && observations.size() <= kMostObservations)
      observations.push_back({shot.number, session.ranges().epoch(shot.time), whole, shot.delay_ns});
    crd.range({session.ranges().epoch(shot.time).ps, whole, station.flag_signal ? static_cast<int>(shot.kind) : 0});
    picture.add(since_s, shot.delay_ns, signal);
  });
  csv.close();
  if (observations.size() > kMostObservations) {
    if (options.warnings)
      options.warnings->push_back(fmt::format("there are no normal points of more than {} ranges", kMostObservations));
  } else if (station.normal_point_s > 0.0) {
    const NormalPoints points = normal_points(observations, station.normal_point_s);
    if (!points.points.empty()) crd.statistics(crd_statistics(points.session));
    write_normal_points(path + ".npt", header, supplement(first), session, station, points);
  }
  crd.close();
  if (options.plots) {
    const ResultKey& key = session.key();
    const std::string title =
        scene.name + (key.variant.empty() ? "" : ", " + key.variant) +
        fmt::format(": {} shots, {} signal, {} noise", summary.shots, summary.signal, summary.noise);
    const std::string fault = picture.draw(folder, options.stem + ".png", title);
    if (!fault.empty() && options.warnings) options.warnings->push_back(fault);
  }
  return summary;
}

namespace {

std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + "\"";
}

/// What is said of a session, in the summary and on the terminal alike.
struct Findings {
  SessionSummary counts;
  double range_m = 0.0, mean_cross_section_m2 = 0.0, start_mjd = 0.0;
  std::vector<LinkRow> link;
  double received = 0.0;  ///< photoelectrons per pulse from the mean cross-section, at the session's start
};

Findings findings_of(const Session& session, const SessionSummary& counts, const Scene& scene) {
  Findings f;
  f.counts = counts;
  f.range_m = session.ranges().range_m(session.time(0));
  f.mean_cross_section_m2 = session.mean_cross_section_m2();
  const Epoch zero = session.ranges().zero();
  f.start_mjd = static_cast<double>(zero.mjd) + static_cast<double>(zero.ps) / static_cast<double>(kPicosecondsPerDay);
  const double wavelength_nm = scene.source.wavelength_nm;
  f.link = link_rows(*scene.station, wavelength_nm, f.mean_cross_section_m2, {f.range_m, f.range_m});
  f.received = link_budget(*scene.station, wavelength_nm, f.range_m).photons_per_m2 * f.mean_cross_section_m2;
  return f;
}

std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null";
}

/// A default as keys.def words it: a number, or none.
std::string json_default(const std::string& text) {
  const bool number = !text.empty() && text.find_first_not_of("0123456789.e+-") == std::string::npos;
  return number ? text : "null";
}

std::string session_json(const Findings& f) {
  std::string link;
  for (const LinkRow& row : f.link) {
    const std::size_t begin = row.key.find_first_not_of(' ');
    if (!link.empty()) link += ", ";
    link += fmt::format("{}: {{\"value\": {}, \"unit\": {}, \"default\": {}, \"range\": {}}}",
                        json_text(row.key.substr(begin)), std::isnan(row.value) ? "\"table\"" : json_number(row.value),
                        json_text(row.unit), json_default(row.default_value), json_text(row.range));
  }
  return fmt::format(
      "{{\"shots\": {}, \"signal\": {}, \"noise\": {}, \"none\": {}, \"range_m\": {:.6f}, "
      "\"mean_cross_section_m2\": {}, \"start_mjd\": {:.9f}, \"link\": {{{}}}}}",
      f.counts.shots, f.counts.signal, f.counts.noise, f.counts.none, f.range_m, json_number(f.mean_cross_section_m2),
      f.start_mjd, link);
}

/// A row for each session, then the link budget of the first.
std::string sessions_text(const std::vector<std::pair<std::string, Findings>>& sessions) {
  text::Columns columns;
  columns.add(
      {"session", "shots", "signal", "noise", "none", "mean cross-section", "received per pulse at the start's range"});
  for (const auto& [name, f] : sessions) {
    columns.add({name, fmt::format("{}", f.counts.shots), fmt::format("{}", f.counts.signal),
                 fmt::format("{}", f.counts.noise), fmt::format("{}", f.counts.none),
                 fmt::format("{:.6g} m^2", f.mean_cross_section_m2), fmt::format("{:.6g}", f.received)});
  }
  const auto& [name, first] = sessions.front();
  return columns.text("") +
         fmt::format("\nLink budget{}, at the session's start, for the mean cross-section over its shots:\n",
                     sessions.size() > 1 ? " of " + name : "") +
         link_text(first.link);
}

/// One key for each session: the groups of delay results seen from the source.
std::vector<ResultKey> session_keys(const Result& result, const Scene& scene) {
  std::vector<ResultKey> keys;
  for (const DelayResult& d : result.delay) {
    const bool known = std::any_of(keys.begin(), keys.end(), [&](const ResultKey& k) {
      return k.detector == d.key.detector && k.observer == d.key.observer && k.variant == d.key.variant;
    });
    if (!known && seen_from_source(scene, d.key)) keys.push_back(d.key);
  }
  return keys;
}

/// The names in which sessions differ: detector, observer, variant.
std::vector<std::string> own_names(const std::vector<ResultKey>& keys, const ResultKey& key) {
  std::vector<std::string> names;
  for (const auto name : {&ResultKey::detector, &ResultKey::observer, &ResultKey::variant}) {
    const bool differs =
        std::any_of(keys.begin(), keys.end(), [&](const ResultKey& k) { return k.*name != key.*name; });
    if (differs && !(key.*name).empty()) names.push_back(key.*name);
  }
  return names;
}

}  // namespace

}  // namespace clray::slr

namespace clray {

bool has_session(const Scene& scene) {
  const bool seen =
      scene.observers.empty() || std::any_of(scene.observers.begin(), scene.observers.end(),
                                             [&](const Observer& o) { return at_source(o, scene.source); });
  return scene.station && (scene.motion || scene.pass) && scene.source.kind == Source::Kind::laser && seen;
}

SessionSummary write_session(const Result& result, const Scene& scene, const std::string& folder,
                             const SessionOptions& options) {
  check_scene(scene);
  check_result(result, scene);
  slr::Session session(result, scene, options);
  return slr::write_files(session, result, scene, folder, options);
}

MoreFiles session_files(const Result& result, const Scene& scene, const std::string& folder,
                        const SessionOptions& options) {
  check_scene(scene);
  check_result(result, scene);
  MoreFiles files;
  if (!has_session(scene) || result.delay.empty()) return files;
  const std::vector<ResultKey> keys = slr::session_keys(result, scene);
  if (keys.empty()) return files;
  text::FileNames names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder)) {
    names.reserve(entry.path().stem().string());
  }
  std::vector<std::pair<std::string, slr::Findings>> sessions;
  for (const ResultKey& key : keys) {
    SessionOptions one = options;
    one.detector = key.detector;
    one.observer = key.observer;
    one.variant = key.variant;
    const std::vector<std::string> own = slr::own_names(keys, key);
    std::vector<std::string> parts{options.stem};
    parts.insert(parts.end(), own.begin(), own.end());
    one.stem = names.stem(parts);
    slr::Session session(result, scene, one);
    const SessionSummary summary = slr::write_files(session, result, scene, folder, one);
    for (const char* end : {".csv", ".crd", ".npt", ".png"}) {
      const bool made = std::string(end) == ".png"   ? options.plots
                        : std::string(end) == ".npt" ? scene.station->normal_point_s > 0.0
                                                     : true;
      if (made) files.names.push_back(one.stem + end);
    }
    sessions.emplace_back(fmt::format("{}", fmt::join(own, "/")), slr::findings_of(session, summary, scene));
  }
  for (const auto& [name, findings] : sessions) {
    const std::string entry = slr::session_json(findings);
    files.summary_json +=
        sessions.size() == 1 ? entry : (files.summary_json.empty() ? "{" : ", ") + slr::json_text(name) + ": " + entry;
  }
  if (sessions.size() > 1) files.summary_json += "}";
  files.summary_key = "session";
  files.text = slr::sessions_text(sessions);
  return files;
}

}  // namespace clray
