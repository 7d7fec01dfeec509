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

namespace clray {

namespace {

/// Whether a sun is given filters by name and nothing about its light. It is then the Sun that the filters' magnitudes
/// are known for.
bool is_photometric_sun(TomlTable& t, const Source& s) {
  if (s.kind != Source::Kind::sun || t.has("spectrum") || t.has("blackbody_K") || t.has("irradiance_W_m2"))
    return false;
  return std::any_of(s.bands.begin(), s.bands.end(), is_photometric);
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
  for (TomlTable& t : root.tables("observer")) {
    Observer o;
    read_keys(t, &o);
    if (o.monostatic) o.direction = scene->source.direction;
    if (const std::string fault = extinction_fault(*scene, o); !fault.empty()) t.fail("extinction_mag", fault);
    if (!taken.insert(o.name).second) {
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
  read_keys(*t, &m);
  if (m.attitudes.empty()) t->number("stop_s", {m.start_s, kInfinity, true, false});
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
  read_keys(*t, &s);
  scene->station = std::move(s);
  try {
    check_ranging(*scene);
  } catch (const Error& e) {
    const std::string own = t->key_path("");
    if (e.context().rfind(own, 0) != 0) throw;
    t->fail(e.context().substr(own.size()), e.message());
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
