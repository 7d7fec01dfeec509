// SPDX-License-Identifier: Apache-2.0
// The files of a session: observations.csv, .crd and .png, and its entry in the summary; expected photon rates.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "clray/error.hpp"
#include "shared/photon.h"
#include "slr/crd.hpp"
#include "slr/link.hpp"
#include "slr/scatter_plot.hpp"
#include "slr/session.hpp"
#include "text/file_names.hpp"

namespace clray::slr {

namespace {

constexpr double kArcsecPerRad = 206264.80624709636;

/// A name for a field of a record: no blanks, at most ten characters, as the formats say.
std::string word(const std::string& name, std::size_t most = 10) {
  std::string text;
  for (const char c : name) text += c > ' ' && c < 127 ? c : '_';
  return text.empty() ? "na" : text.substr(0, most);
}

Epoch after(const Epoch& zero, std::int64_t ps) {
  const std::int64_t days = ps / kPicosecondsPerDay;
  return normalised({zero.mjd + days, zero.ps + (ps - days * kPicosecondsPerDay)});
}

CrdHeader crd_header(const Session& session, const Scene& scene, std::uint64_t first, std::uint64_t last) {
  const Station& s = *scene.station;
  CrdHeader h;
  h.produced = production_epoch();
  h.start = after(session.ranges().zero(), session.time_ps(first));
  h.stop = after(session.ranges().zero(), session.time_ps(last));
  h.station = word(s.name);
  h.target = word(scene.name);
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
    h.prediction_sequence = fmt::format("{:03}{:02}", p->sequence, p->sub_daily);
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

/// How fast the range changes, by a central difference over 0.2 s (or what the pass allows).
double range_rate(const Session& session, double time_s) {
  const double from = std::max(session.start_s(), time_s - 0.1), to = std::min(session.stop_s(), time_s + 0.1);
  if (!(to > from)) return 0.0;
  return (session.ranges().range_m(to) - session.ranges().range_m(from)) / (to - from);
}

void csv_head(TextFile* csv, const Result& result, const Scene& scene, const Session& session) {
  const Epoch zero = session.ranges().zero();
  csv->text("# simulated laser ranging: one row for each shot that recorded a photon (clray " CLRAY_VERSION ")\n");
  csv->text("# epoch_s: time of fire, s after MJD ").text(std::to_string(zero.mjd)).text(" UTC + ");
  csv->decimal(zero.ps, 12).text(" s; flight_time_s: two-way; residual_ns: flight time minus 2 range/c\n");
  csv->text(fmt::format("# scene {}, seed {}, digest {:016x}, shots {} at {} Hz\n",
                        scene.path.empty() ? scene.name : scene.path, result.seed, result.digest, session.shots(),
                        scene.station->rate_Hz));
  csv->text("epoch_s,flight_time_s,residual_ns,kind\n");
}

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
  return ScatterPlot(start_s, stop_s, low, high);
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
    return CrdSupplement{after(session.ranges().zero(), session.time_ps(shot)).ps,
                         range_rate(session, session.time_s(shot))};
  };
  CrdWriter crd(path + ".crd", header, supplement(first));
  ScatterPlot picture =
      picture_of(session, station, session.time_s(first), session.time_s(last) + 1.0 / station.rate_Hz);
  std::int64_t next_supplement = session.time_ps(first) + 60 * kPicosecondsPerSecond;
  const SessionSummary summary = session.run([&](const Shot& shot) {
    const bool signal = shot.kind == CLRAY_PHOTON_SIGNAL;
    const double flight_ps = 2.0 * shot.range_m / kLightSpeed * 1e12 + shot.delay_ns * 1e3;
    const auto whole = static_cast<std::int64_t>(std::llround(flight_ps));
    csv.decimal(shot.time_ps, 12).text(",").decimal(whole, 12).text(",");
    csv.decimal(static_cast<std::int64_t>(std::llround(shot.delay_ns * 1e6)), 6);
    csv.text(signal ? ",signal" : ",noise").end_line();
    if (shot.time_ps >= next_supplement) {
      crd.supplement(supplement(shot.number));
      next_supplement = shot.time_ps + 60 * kPicosecondsPerSecond;
    }
    crd.range({after(session.ranges().zero(), shot.time_ps).ps, whole,
               station.flag_signal ? static_cast<int>(shot.kind) : 0});
    picture.add(static_cast<double>(shot.time_ps) * 1e-12, shot.delay_ns, signal);
  });
  csv.close();
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

std::string session_json(const Session& session, const SessionSummary& summary, const Scene& scene) {
  const double sigma = session.mean_cross_section_m2(), range = session.ranges().range_m(session.start_s());
  std::string link;
  for (const LinkRow& row : link_rows(*scene.station, scene.source.wavelength_nm, sigma, range)) {
    const std::size_t begin = row.key.find_first_not_of(' ');
    if (!link.empty()) link += ", ";
    link +=
        fmt::format("{}: {{\"value\": {}, \"unit\": {}, \"default\": {}, \"range\": {}}}",
                    json_text(row.key.substr(begin)), row.value == "table" ? "\"table\"" : row.value,
                    json_text(row.unit), row.default_value.empty() ? "null" : row.default_value, json_text(row.range));
  }
  return fmt::format(
      "{{\"shots\": {}, \"signal\": {}, \"noise\": {}, \"none\": {}, \"range_m\": {:.6f}, "
      "\"mean_cross_section_m2\": {:.9g}, \"start_mjd\": {:.9f}, \"link\": {{{}}}}}",
      summary.shots, summary.signal, summary.noise, summary.none, range, sigma,
      static_cast<double>(session.ranges().zero().mjd) +
          static_cast<double>(session.ranges().zero().ps) / static_cast<double>(kPicosecondsPerDay),
      link);
}

/// One key for each session: the groups of delay results seen from the source.
std::vector<ResultKey> session_keys(const Result& result, const Scene& scene) {
  std::vector<ResultKey> keys;
  for (const DelayResult& d : result.delay) {
    const bool known = std::any_of(keys.begin(), keys.end(), [&](const ResultKey& k) {
      return k.detector == d.key.detector && k.observer == d.key.observer && k.variant == d.key.variant;
    });
    const bool seen =
        scene.observers.empty() || std::any_of(scene.observers.begin(), scene.observers.end(), [&](const Observer& o) {
          return o.monostatic && (d.key.observer.empty() || o.name == d.key.observer);
        });
    if (!known && seen) keys.push_back(d.key);
  }
  return keys;
}

/// Those of a session's detector, observer and variant in which sessions differ.
std::vector<std::string> own_names(const std::vector<ResultKey>& keys, const ResultKey& key) {
  std::vector<std::string> names;
  for (const auto name : {&ResultKey::detector, &ResultKey::observer, &ResultKey::variant}) {
    const bool differs = std::any_of(keys.begin(), keys.end(), [&](const ResultKey& k) { return k.*name != key.*name; });
    if (differs && !(key.*name).empty()) names.push_back(key.*name);
  }
  return names;
}

}  // namespace

}  // namespace clray::slr

namespace clray {

bool has_session(const Scene& scene) {
  const bool seen = scene.observers.empty() || std::any_of(scene.observers.begin(), scene.observers.end(),
                                                           [](const Observer& o) { return o.monostatic; });
  return scene.station && scene.motion && scene.source.kind == Source::Kind::laser && seen;
}

SessionSummary write_session(const Result& result, const Scene& scene, const std::string& folder,
                             const SessionOptions& options) {
  slr::Session session(result, scene, options);
  return slr::write_files(session, result, scene, folder, options);
}

MoreFiles session_files(const Result& result, const Scene& scene, const std::string& folder,
                        const SessionOptions& options) {
  MoreFiles files;
  if (!has_session(scene) || result.delay.empty()) return files;
  const std::vector<ResultKey> keys = slr::session_keys(result, scene);
  text::FileNames names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder)) {
    names.reserve(entry.path().stem().string());
  }
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
    for (const char* end : {".csv", ".crd", ".png"}) {
      if (options.plots || std::string(end) != ".png") files.names.push_back(one.stem + end);
    }
    const std::string entry = slr::session_json(session, summary, scene);
    files.summary_json += keys.size() == 1 ? entry
                                           : (files.summary_json.empty() ? "{" : ", ") +
                                                 slr::json_text(fmt::format("{}", fmt::join(own, "/"))) + ": " + entry;
  }
  if (keys.size() > 1) files.summary_json += "}";
  files.summary_key = "session";
  return files;
}

std::vector<double> photons_per_ns(const DelayResult& delay, const Station& station, double range_m,
                                   double wavelength_nm) {
  const double photons = 4.0 * slr::kPi * slr::link_budget(station, wavelength_nm, range_m).photons_per_m2;
  const slr::Histogram bins{delay.first_bin_start_s, delay.bin_width_s, delay.bin_m2_per_sr};
  const slr::PulseKernel kernel = slr::pulse_kernel(station, delay.bin_width_s);
  const slr::Histogram smeared = slr::convolve(bins, kernel);
  const long shift = std::lround((delay.first_bin_start_s - smeared.first_s) / delay.bin_width_s);
  const double per_ns = photons / (delay.bin_width_s * 1e9);
  std::vector<double> rates(bins.mass.size(), 0.0);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    for (long cut = 0; cut < kernel.cuts; ++cut) {
      const long from = (static_cast<long>(i) + shift) * kernel.cuts + cut;
      if (from >= 0 && from < static_cast<long>(smeared.mass.size()))
        rates[i] += smeared.mass[static_cast<std::size_t>(from)];
    }
    rates[i] *= per_ns;
  }
  return rates;
}

double session_range_m(const Scene& scene) {
  if (!scene.station) throw Error(ErrorCode::input, "a range needs a [station]", "station");
  const slr::RangeModel ranges(*scene.station);
  return ranges.range_m(scene.motion ? scene.motion->start_s : 0.0);
}

}  // namespace clray
