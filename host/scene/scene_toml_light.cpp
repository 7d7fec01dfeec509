// SPDX-License-Identifier: Apache-2.0
// The sections of a scene file about light and measurement: source, observers, motion, station, detectors, trace.
// Files carry the units of their key names; the structs are in SI.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "clray/error.hpp"
#include "scene/motion.hpp"
#include "scene/scene_csv.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

double radians(double degrees) {
  return degrees / 180.0 * CLRAY_PI;
}

constexpr Range kWavelength{0.0, 1e7, false, true};

/// A band from a filter's curve, called `name` or, if that is empty, like its file.
Band curve_band(TomlTable& t, const std::string& key, std::string name) {
  const std::string file = t.file(key);
  Spectrum curve = read_spectrum(file, 0.0, 1e300);
  const bool some = std::any_of(curve.value.begin(), curve.value.end(), [](double v) { return v > 0.0; });
  if (curve.value.size() < 2 || !some) {
    throw Error(ErrorCode::input, "expected a filter's curve: at least two rows, and some light passed", file);
  }
  if (name.empty()) name = std::filesystem::path(file).stem().string();
  return make_band(name, std::move(curve));
}

/// { name, low_nm, high_nm } or { name, file }.
Band table_band(TomlTable b) {
  b.know({"low_nm", "high_nm", "file"});
  const std::string given = b.name("name", "");
  Band band;
  if (b.has("file")) {
    for (const char* key : {"low_nm", "high_nm"}) {
      if (b.has(key)) b.fail(key, "given beside file; the curve has its own ends");
    }
    band = curve_band(b, "file", given);
  } else {
    const double low = b.number("low_nm", kWavelength), high = b.number("high_nm", kWavelength);
    if (!(low < high)) b.fail("high_nm", fmt::format("expected more than low_nm = {}, found {}", low, high));
    band = make_band(low, high);
    if (!given.empty()) band.name = given;
  }
  b.finish();
  return band;
}

/// One band: [low, high], "curve.csv", or a table.
Band read_band(TomlTable& t, const toml::node& node) {
  if (const toml::table* named = node.as_table()) return table_band(TomlTable(*named, "source.bands", t.scene_file()));
  if (node.is_string()) {
    // A table of one entry, so that files are found and faults told in one place.
    toml::table one;
    one.insert("bands", *node.as_string());
    TomlTable entry(one, "source", t.scene_file());
    try {
      return curve_band(entry, "bands", "");
    } catch (const Error& e) {
      if (e.message().rfind("source.bands: ", 0) != 0) throw;
      t.fail_at(node.source(), e.message());
    }
  }
  const toml::array* pair = node.as_array();
  if (pair == nullptr || pair->size() != 2) {
    t.fail_at(node.source(), "source.bands: expected [low_nm, high_nm] or the file of a curve, found " + found(node));
  }
  const double low = t.number_of(*pair->get(0), "bands", kWavelength);
  const double high = t.number_of(*pair->get(1), "bands", kWavelength);
  if (!(low < high)) {
    t.fail_at(pair->get(1)->source(), fmt::format("source.bands: expected more than {}, found {}", low, high));
  }
  return make_band(low, high);
}

/// { low_nm, high_nm, count }: so many bands of equal width side by side.
void read_even_bands(TomlTable t, Source* s) {
  const double low = t.number("low_nm", kWavelength), high = t.number("high_nm", kWavelength);
  if (!(low < high)) t.fail("high_nm", fmt::format("expected more than low_nm = {}, found {}", low, high));
  const std::uint64_t count = t.whole("count", 1, 4096, std::nullopt);
  t.finish();
  const double n = static_cast<double>(count);
  const auto edge = [&](std::uint64_t i) {
    const double share = static_cast<double>(i) / n;
    return i == count ? high : low + (high - low) * share;
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    s->bands.push_back(make_band(edge(i), edge(i + 1)));
    s->bands.back().name = fmt::format("{:.6g}-{:.6g}", edge(i), edge(i + 1));
    if (i > 0 && s->bands[i].name == s->bands[i - 1].name) t.fail("count", "the bands are too narrow to be told apart");
  }
}

void read_bands(TomlTable& t, Source* s) {
  const toml::node* value = t.node("bands");
  if (value == nullptr) return;
  if (value->is_table()) return read_even_bands(*t.table("bands"), s);
  const toml::array* array = value->as_array();
  if (array == nullptr || array->empty()) {
    t.fail("bands", "expected [[low_nm, high_nm], …] or { low_nm, high_nm, count }, found " + found(*value));
  }
  for (const toml::node& each : *array) {
    const Band band = read_band(t, each);
    for (const Band& other : s->bands) {
      if (other.name == band.name)
        t.fail_at(each.source(), "source.bands: a second band of the name \"" + band.name + "\"");
    }
    s->bands.push_back(band);
  }
}

/// At most one of these keys.
void at_most_one(TomlTable& t, const std::vector<std::string>& keys) {
  std::string first;
  for (const std::string& key : keys) {
    if (!t.has(key)) continue;
    if (!first.empty()) t.fail(key, "given beside " + first + "; expected only one of them");
    first = key;
  }
}

void read_range(TomlTable& t, Station* s) {
  at_most_one(t, {"range_m", "ranges", "cpf"});
  s->range_m = t.number("range_m", kPositive, s->range_m);
  if (t.has("ranges")) s->ranges = read_pairs(t.file("ranges"), {"time_s", "range_m"}, 1.0, 1e-3, 1e13);
  if (t.has("cpf")) {
    s->cpf_file = t.file("cpf");
    s->position_m = t.vector("position_m");
  } else {
    s->position_m = t.vector("position_m", s->position_m);
  }
  s->start_mjd = t.number("start_mjd", kNotNegative, s->start_mjd);
}

void read_pulse(TomlTable& t, Station* s) {
  at_most_one(t, {"pulse_fwhm_ps", "pulse"});
  s->pulse_energy_J = t.number("pulse_energy_J", kPositive, s->pulse_energy_J);
  s->pulse_fwhm_s = t.number("pulse_fwhm_ps", kNotNegative, 0.0) / 1e12;
  if (!t.has("pulse")) return;
  s->pulse = read_pairs(t.file("pulse"), {"time_ps", "power"}, 1e12, 0.0, 1e300);
  double sum = 0.0;
  for (const auto& [time, power] : s->pulse) sum += power;
  if (s->pulse.size() < 2 || !(sum > 0.0)) t.fail("pulse", "expected at least two rows and some power");
}

}  // namespace

void read_source(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("source");
  if (!t) return;
  Source& s = scene->source;
  s.kind = t->choice("kind", {"laser", "sun"}, "laser") == "sun" ? Source::Kind::sun : Source::Kind::laser;
  s.direction = t->direction("direction", s.direction);
  t->know({"wavelength_nm", "bands", "spectrum", "blackbody_K", "irradiance_W_m2"});
  if (s.kind == Source::Kind::laser) {
    for (const char* key : {"bands", "spectrum", "blackbody_K", "irradiance_W_m2"}) {
      if (t->has(key)) t->fail(key, "belongs to kind = \"sun\"; a laser has wavelength_nm");
    }
    s.wavelength_nm = t->number("wavelength_nm", {0.0, 1e7, false, true}, s.wavelength_nm);
  } else {
    if (t->has("wavelength_nm")) t->fail("wavelength_nm", "belongs to kind = \"laser\"; a sun has bands");
    at_most_one(*t, {"spectrum", "blackbody_K"});
    at_most_one(*t, {"spectrum", "irradiance_W_m2"});
    read_bands(*t, &s);
    if (t->has("spectrum")) s.spectrum = read_spectrum(t->file("spectrum"), 0.0, 1e300);
    if (t->has("blackbody_K")) s.blackbody_K = t->number("blackbody_K", {1.0, 1e8, true, true});
    s.irradiance_W_m2 = t->number("irradiance_W_m2", kPositive, s.irradiance_W_m2);
  }
  t->finish();
  const std::string fault = source_fault(s);
  if (!fault.empty()) t->fail(s.bands.empty() ? "spectrum" : "bands", fault);
}

void read_observers(TomlTable& root, Scene* scene) {
  for (TomlTable& t : root.tables("observer")) {
    Observer o;
    o.name = t.name("name", "");
    const toml::node* direction = t.node("direction");
    o.monostatic = direction == nullptr || direction->is_string();
    if (direction != nullptr && direction->is_string()) {
      t.choice("direction", {"source"});
    } else if (direction != nullptr) {
      if (!direction->is_array()) t.fail("direction", "expected \"source\" or [x, y, z], found " + found(*direction));
      o.direction = t.direction("direction");
    }
    if (o.monostatic) o.direction = scene->source.direction;
    o.acceptance_rad = t.number("acceptance_mrad", {0.0, 3141.592653589793, true, true}, 0.0) / 1e3;
    if (t.has("range_m")) o.range_m = t.number("range_m", kPositive);
    t.finish();
    for (const Observer& other : scene->observers) {
      if (other.name != o.name) continue;
      if (o.name.empty())
        throw Error(ErrorCode::input, "observer.name: missing; several observers must be named", t.place());
      t.fail("name", "a second observer of the name \"" + o.name + "\"");
    }
    scene->observers.push_back(std::move(o));
  }
}

void read_motion(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("motion");
  if (!t) return;
  Motion m;
  if (t->has("attitudes")) {
    for (const char* key : {"axis", "period_s", "phase_deg", "step_deg"}) {
      if (t->has(key)) t->fail(key, "belongs to a spin; attitudes come from the table");
    }
    m.attitudes = read_attitudes(t->file("attitudes"));
    const double first = m.attitudes.front().time_s, last = m.attitudes.back().time_s;
    m.start_s = t->number("start_s", {first, last, true, true}, first);
    m.stop_s = t->number("stop_s", {m.start_s, last, true, true}, last);
  } else {
    t->know({"attitudes"});
    m.axis = t->direction("axis");
    m.period_s = t->number("period_s", kPositive);
    m.phase_rad = radians(t->number("phase_deg", kAny, 0.0));
    m.start_s = t->number("start_s", kAny, 0.0);
    m.stop_s = t->number("stop_s", {m.start_s, kInfinity, true, false});
    m.step_rad = radians(t->number("step_deg", {0.0, 360.0, false, true}));
  }
  t->finish();
  try {
    orientation_count(m);
  } catch (const Error& e) {
    throw Error(ErrorCode::input, "motion: " + e.message(), t->place());
  }
  scene->motion = std::move(m);
}

void read_station(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("station");
  if (!t) return;
  Station s;
  s.name = t->name("name", s.name);
  read_range(*t, &s);
  read_pulse(*t, &s);
  s.rate_Hz = t->number("rate_Hz", kPositive, s.rate_Hz);
  s.aperture_m = t->number("aperture_m", kPositive, s.aperture_m);
  if (t->has("divergence_urad")) s.divergence_rad = t->number("divergence_urad", kPositive) / 1e6;
  s.pointing_rad = t->number("pointing_urad", kNotNegative, 0.0) / 1e6;
  s.eta_q = t->number("eta_q", kShare, s.eta_q);
  s.eta_t = t->number("eta_t", kShare, s.eta_t);
  s.eta_r = t->number("eta_r", kShare, s.eta_r);
  s.T_a = t->number("T_a", kShare, s.T_a);
  s.T_c = t->number("T_c", kShare, s.T_c);
  s.noise_per_ns = t->number("noise_per_ns", kNotNegative, s.noise_per_ns);
  s.dark_per_ns = t->number("dark_per_ns", kNotNegative, s.dark_per_ns);
  if (t->has("gate_ns")) s.gate_s = t->number("gate_ns", kPositive) / 1e9;
  s.jitter_fwhm_s = t->number("jitter_fwhm_ps", kNotNegative, 0.0) / 1e12;
  s.dead_time_s = t->number("dead_time_ns", kNotNegative, 0.0) / 1e9;
  s.flag_signal = t->boolean("flag_signal", s.flag_signal);
  t->finish();
  scene->station = std::move(s);
}

void read_detectors(TomlTable& root, Scene* scene) {
  for (TomlTable& t : root.tables("detector")) {
    DetectorSpec d;
    d.kind = t.choice("kind", row_names("detector"));
    d.name = t.name("name", d.kind);
    for (const TableKey& key : table_row("detector", d.kind).keys) {
      if (const std::optional<double> value = t.row_key(key)) d.parameters[key.name] = *value;
    }
    t.finish();
    const std::string fault = detector_fault(d);
    if (!fault.empty()) throw Error(ErrorCode::input, "detector." + fault, t.place());
    for (const DetectorSpec& other : scene->detectors) {
      if (other.name == d.name) {
        throw Error(ErrorCode::input, "detector.name: a second detector of the name \"" + d.name + "\"",
                    t.place("name"));
      }
    }
    scene->detectors.push_back(std::move(d));
  }
}

void read_trace(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("trace");
  if (!t) return;
  TraceOptions& o = scene->trace;
  constexpr std::uint64_t kRays = 1ull << 40;
  o.max_bounces = static_cast<int>(t->whole("max_bounces", 1, 64, static_cast<std::uint64_t>(o.max_bounces)));
  o.target_error_percent = t->number("target_error_percent", {0.0, 100.0, false, true}, o.target_error_percent);
  o.rays = t->whole("rays", 1, kRays, o.rays);
  o.time_limit_s = t->number("time_limit_s", kPositive, o.time_limit_s);
  o.max_rays = t->whole("max_rays", 1, kRays, o.max_rays);
  o.seed = t->whole("seed", 0, INT64_MAX, o.seed);
  o.replicates = static_cast<int>(t->whole("replicates", 2, 64, static_cast<std::uint64_t>(o.replicates)));
  o.sobol = t->choice("sampler", {"sobol", "random"}, "sobol") == "sobol";
  t->finish();
}

}  // namespace clray
