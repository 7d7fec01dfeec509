// SPDX-License-Identifier: Apache-2.0
// The sections of a scene file about light and measurement: source, observers, motion, station, detectors, trace. Their
// keys are the rows of keys.def. Rules about several keys of a section stand here.
#include <algorithm>
#include <set>
#include <string>

#include "clray/error.hpp"
#include "scene/file/keys.hpp"
#include "scene/motion.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "text/input_file.hpp"

namespace clray {

namespace {

/// Whether a sun is given filters by name and nothing about its light. It is then the Sun that the filters' magnitudes
/// are known for.
bool is_photometric_sun(TomlTable& t, const Source& s) {
  if (s.kind != Source::Kind::sun || t.has("spectrum") || t.has("blackbody_K") || t.has("irradiance_W_m2"))
    return false;
  return std::any_of(s.bands.begin(), s.bands.end(), is_photometric);
}

/// Of keys that stand for each other, those of the station file go where the scene gives another.
void drop_replaced(TomlTable& t, Station* s) {
  if (t.has("range_m") || t.has("ranges") || t.has("cpf")) {
    s->range_m = Station().range_m;
    s->ranges.clear();
    s->cpf_file.clear();
  }
  if (t.has("pulse") || t.has("pulse_fwhm_ps")) {
    s->pulse_fwhm_s = Station().pulse_fwhm_s;
    s->pulse.clear();
  }
}

}  // namespace

void read_source(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("source");
  if (!t) return;
  read_keys(*t, &scene->source);
  if (is_photometric_sun(*t, scene->source)) scene->source.spectrum = solar_spectrum();
  const std::string fault = source_fault(*scene);
  if (!fault.empty()) t->fail(scene->source.bands.empty() ? "spectrum" : "bands", fault);
}

void read_observers(TomlTable& root, Scene* scene) {
  std::set<std::string> taken;
  std::vector<TomlTable> tables = root.tables("observer");
  for (TomlTable& t : tables) {
    Observer o;
    read_keys(t, &o);
    if (o.monostatic) o.direction = scene->source.direction;
    if (const std::string fault = extinction_fault(*scene, o); !fault.empty()) t.fail("extinction_mag", fault);
    if (o.name.empty() && tables.size() > 1)
      throw Error(ErrorCode::input, "observer.name: missing; several observers must be named", t.place());
    if (!taken.insert(o.name).second) t.fail("name", "a second observer of the name \"" + o.name + "\"");
    scene->observers.push_back(std::move(o));
  }
}

void read_motion(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("motion");
  if (!t) return;
  Motion m;
  read_keys(*t, &m);
  if (m.attitudes.empty()) t->number("stop_s", {m.start_s, kInfinity, true, false});
  try {
    orientation_count(m);
  } catch (const Error& e) {
    throw Error(ErrorCode::input, "motion: " + e.message(), t->place());
  }
  scene->motion = std::move(m);
}

Station load_station(const std::string& path) {
  const toml::table parsed = parse_toml(text::read_input_file(path), path);
  TomlTable t(parsed, "station", path);
  if (t.has("file")) t.fail("file", "is a key of scenes; a station file names no other");
  Station s;
  read_keys(t, &s);
  return s;
}

/// `station = "file"` or [station], whose keys stand before those of its `file`.
void read_station(TomlTable& root, Scene* scene) {
  const toml::node* value = root.node("station");
  if (value == nullptr) return;
  Station s;
  if (value->is_string()) {
    const std::string file = root.file("station");
    s = load_station(file);
    s.file = file;
  } else {
    std::optional<TomlTable> t = root.table("station");
    if (t->has("file")) s = load_station(t->file("file"));
    drop_replaced(*t, &s);
    read_keys(*t, &s);
  }
  scene->station = std::move(s);
  try {
    check_ranging(*scene);
  } catch (const Error& e) {
    if (e.context().rfind("station.", 0) != 0) throw;
    if (std::optional<TomlTable> t = value->is_table() ? root.table("station") : std::nullopt)
      t->fail(e.context().substr(8), e.message());
    throw Error(ErrorCode::input, e.context() + ": " + e.message(), root.place("station"));
  }
}

void read_detectors(TomlTable& root, Scene* scene) {
  std::set<std::string> taken;
  for (TomlTable& t : root.tables("detector")) {
    DetectorSpec d;
    d.kind = t.choice("kind", row_names("detector"));
    d.name = t.name("name", d.kind);
    for (const TableKey& key : table_row("detector", d.kind).keys) {
      if (const std::optional<double> value = t.row_key(key)) d.parameters[key.name] = *value;
    }
    t.finish();
    const std::string fault = detector_fault(d);
    if (!fault.empty()) {
      const std::string key = fault.substr(0, fault.find(':'));
      throw Error(ErrorCode::input, "detector." + fault, t.has(key) ? t.place(key) : t.place());
    }
    if (!taken.insert(d.name).second) {
      throw Error(ErrorCode::input,
                  "detector.name: a second detector of the name \"" + d.name + "\"; several of a kind must be named",
                  t.place("name"));
    }
    scene->detectors.push_back(std::move(d));
  }
}

void read_trace(TomlTable& root, Scene* scene) {
  if (std::optional<TomlTable> t = root.table("trace")) read_keys(*t, &scene->trace);
}

}  // namespace clray
